#!/usr/bin/env python3
"""Building and first pictures of clouds larger than memory should hold.

    bench/scale.py SCAN.laz TILES FOLDER [BUILD_DIR]

Makes TILES copies of a LAZ or LAS file side by side in FOLDER (only the offsets in their headers differ), builds one COPC
file of them, renders it from three places and moves it in a window. Prints a line of JSON for each step: wall and processor
seconds, peak memory, size, and the load of the machine before it, without which the seconds say little. Processor seconds are
those of the program without its decoders, which outlive it. Results: docs/large_scans.md.
"""
import json
import math
import os
import resource
import shutil
import struct
import subprocess
import sys

import measure


def make_tile(source, column, row, target):
    """A copy moved by whole extents of the scan, so that steps stay steps."""
    data = bytearray(source)
    scale = struct.unpack_from('<3d', data, 131)
    offset = list(struct.unpack_from('<3d', data, 155))
    box = list(struct.unpack_from('<6d', data, 179))  # max x, min x, max y, ...
    for axis, count in ((0, column), (1, row)):
        extent = box[2 * axis] - box[2 * axis + 1]
        shift = count * math.ceil(extent / scale[axis]) * scale[axis]
        offset[axis] += shift
        box[2 * axis] += shift
        box[2 * axis + 1] += shift
    struct.pack_into('<3d', data, 155, *offset)
    struct.pack_into('<6d', data, 179, *box)
    with open(target, 'wb') as file:
        file.write(data)


def measured(name, command):
    load = os.getloadavg()[0]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = measure.process(command, 24 * 3600)
    if done.returncode:
        sys.exit(done.stderr)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return {'step': name, 'seconds': round(done.wall_ms / 1000, 2),
            'cpu_seconds': round(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, 2),
            'peak_mb': round(done.peak_mb), 'load': round(load, 1)}, done.stdout


def main():
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    scan, tiles, folder = sys.argv[1], int(sys.argv[2]), sys.argv[3]
    build = sys.argv[4] if len(sys.argv) > 4 else 'build/release'
    sfumato = os.path.join(build, 'bin', 'sfumato')
    os.makedirs(folder, exist_ok=True)
    with open(scan, 'rb') as file:
        source = file.read()
    columns = math.ceil(math.sqrt(tiles))
    names = [os.path.join(folder, 'tile_%03d%s' % (i, os.path.splitext(scan)[1])) for i in range(tiles)]
    for i, name in enumerate(names):
        make_tile(source, i % columns, i // columns, name)
    city = os.path.join(folder, 'city.copc.laz')
    row, _ = measured('build', [sfumato, 'build', '--quiet', '-o', city] + names)
    info = json.loads(subprocess.run([sfumato, 'info', city, '--json'], stdout=subprocess.PIPE, check=True).stdout)
    row.update(points=info['points'], nodes=sum(level['nodes'] for level in info['levels']), levels=len(info['levels']),
               input_mb=round(sum(map(os.path.getsize, names)) / 1e6, 1), output_mb=round(os.path.getsize(city) / 1e6, 1),
               million_points_per_second=round(info['points'] / 1e6 / row['seconds'], 2))
    print(json.dumps(row), flush=True)
    for name in names:
        os.unlink(name)
    for view, options in (('overview', []), ('near', ['--zoom', '12']), ('detail', ['--zoom', '80'])):
        picture = os.path.join(folder, view + '.png')
        row, out = measured(view, [sfumato, city, '-t', 'points', '--resolution', '1920x1080', '--json', '--quiet', '-o', picture] + options)
        report = json.loads(out)
        row.update(levels=report.get('levels'), stages_ms={k: round(v) for k, v in report['stages_ms'].items()})
        print(json.dumps(row), flush=True)
    # The window at 1280x720: the first picture, the picture of everything, and the next view.
    motion = os.path.join(build, 'bin', 'viewer_motion')
    if os.path.exists(motion) and shutil.which('xvfb-run'):
        row, out = measured('window', ['xvfb-run', '-a', '-s', '-screen 0 1280x720x24', motion, city, 'points', '2'])
        row.update(json.loads(out.splitlines()[-1]))
        print(json.dumps(row), flush=True)


if __name__ == '__main__':
    main()
