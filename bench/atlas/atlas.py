#!/usr/bin/python3
"""Renders labelled public scans with no option and measures the first pictures.

usage: bench/atlas/atlas.py [--half develop|closed|all] [--atlas FOLDER] [--only FILE] [--out FOLDER]

FOLDER holds atlas.json, a list of scans with their labels, and files/. Written to --out: one picture a scan,
sheet.png (cells numbered as in the table, framed green where up axis and cutaway are right, else red), index.html
(the same with words), figures.json and the table that is printed. Without FOLDER it says so and ends with 0.

A rule is judged on scans that nobody tuned it to. So the atlas has two halves: by kind, then sha256, every second
scan from the first is in `develop`, which is what --half takes unless told, and the others in `closed`, which is
opened to judge what is finished.
"""
import argparse
import html
import json
import os
import re
import resource
import struct
import subprocess
import sys
import zlib

import numpy

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BIN = os.path.join(ROOT, 'build/release/bin')
WIDTH, HEIGHT, COLUMNS = 640, 360, 4
TIMEOUT_S = 300
# The share of covered pixels far from any point (eval_evidence.cpp), where it is built.
EVIDENCE = os.path.join(BIN, 'eval_evidence')
# 3 x 5 pixels a digit, row by row.
DIGITS = ('111101101101111', '010110010010111', '111001111100111', '111001111001111', '101101111001001',
          '111100111001111', '111100111101111', '111001001001001', '111101111101111', '111101111001111')


def half_of(scans, half):
    ordered = sorted(scans, key=lambda scan: (scan['kind'], scan['sha256']))
    return {'develop': ordered[0::2], 'closed': ordered[1::2], 'all': ordered}[half]


def run(command):
    """(exit status, standard output, standard error, seconds of processor time)"""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    try:
        done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=TIMEOUT_S)
        status, out, err = done.returncode, done.stdout, done.stderr
    except subprocess.TimeoutExpired:
        status, out, err = -1, '', f'no picture within {TIMEOUT_S} s\n'
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return status, out, err, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def invented_share(sfumato, scan, picture, report):
    """The share of the covered pixels that are far from every point, from the same camera; None where not measured."""
    if not os.path.exists(EVIDENCE) or not os.path.exists(picture + '.npy'):
        return None
    points = picture + '.points.npy'
    status, _, _, _ = run([sfumato, scan, '-t', 'points', '--camera', picture + '.json', '--up', report['up'],
                           '--size-mode', 'pixels', '--point-size', '1', '--edl', 'off', '-o', picture + '.points.png',
                           '--output-depth', points])
    measured = run([EVIDENCE, picture + '.npy', points]) if status == 0 else None
    return json.loads(measured[1])['invented_share'] if measured and measured[0] == 0 else None


def render(sfumato, folder, out, number, scan):
    path = os.path.join(folder, 'files', scan['name'])
    picture = os.path.join(out, f'{number:02d}.png')
    for left in (picture, picture + '.npy', picture + '.json'):
        if os.path.exists(left):
            os.remove(left)
    command = [sfumato, path, '-o', picture, '--resolution', f'{WIDTH}x{HEIGHT}', '--json',
               '--output-camera', picture + '.json']
    if os.path.exists(EVIDENCE):
        command += ['--output-depth', picture + '.npy']
    status, output, errors, seconds = run(command)
    report = json.loads(output) if status == 0 else {}
    labels = scan['labels']
    row = {'number': number, 'name': scan['name'], 'kind': scan['kind'], 'status': status, 'stderr': errors,
           'cpu_s': seconds, 'labelled_up': labels['up'], 'up_sure': labels['up_sure'],
           'expected_colour': labels['expected_colour'], 'good_sides': labels['good_sides']}
    row['lines'] = len(errors.splitlines())
    if status != 0:
        return row
    camera = report['camera']
    way = numpy.subtract(camera['position'], camera['target'])
    row.update(up=report['up'], up_reason=report['up_reason'], cutaway=report['cutaway'], technique=report['technique'],
               color_by=report['color_by'], camera_from=list(way / numpy.linalg.norm(way)),
               invented=invented_share(sfumato, path, picture, report))
    if labels['up'] not in (None, 'none'):
        row['up_right'] = report['up'] == labels['up']
    row['wrong_cutaway'] = report['cutaway'] and not labels['interior_cutaway']
    if labels['interior_cutaway']:
        row['interior_right'] = report['cutaway']
    sides = re.findall('[+-][XYZ]', labels['good_sides'] or '')
    if sides:  # from within 60 degrees of one of them
        axes = [numpy.eye(3)['XYZ'.index(side[1])] * (1 if side[0] == '+' else -1) for side in sides]
        row['side_right'] = max(float(numpy.dot(axis, row['camera_from'])) for axis in axes) >= 0.5
    if labels['from_above'] in ('yes', 'no'):  # from 30 degrees or more
        height = row['camera_from']['XYZ'.index(report['up'][1])] * (1 if report['up'][0] == '+' else -1)
        row['elevation_right'] = bool(height >= 0.5) == (labels['from_above'] == 'yes')
    row['page'] = page_used(picture, report['background_color'])
    return row


def page_used(picture, background):
    """The share of the cells of 32 x 18 that differ from the background anywhere."""
    image = read_png(picture)[:HEIGHT // 18 * 18, :WIDTH // 32 * 32, :3].astype(int)
    differs = numpy.abs(image - numpy.round(255 * numpy.asarray(background))).max(axis=2) > 8
    return float(differs.reshape(18, image.shape[0] // 18, 32, image.shape[1] // 32).any(axis=(1, 3)).mean())


def read_png(path):
    """Rows x columns x 3 or 4 bytes; what the program writes: 8 bits, not interlaced (PNG, 9.2: filters)."""
    with open(path, 'rb') as file:
        data = file.read()
    at, packed = 8, b''
    while at < len(data):
        length, kind = struct.unpack('>I4s', data[at:at + 8])
        if kind == b'IHDR':
            width, height, _, colour = struct.unpack('>IIBB', data[at + 8:at + 18])
        elif kind == b'IDAT':
            packed += data[at + 8:at + 8 + length]
        at += 12 + length
    channels = {0: 1, 2: 3, 6: 4}[colour]
    rows = numpy.frombuffer(zlib.decompress(packed), numpy.uint8).reshape(height, 1 + width * channels)
    image = numpy.zeros((height, width, channels), numpy.uint8)
    above = numpy.zeros((width, channels), numpy.uint8)
    for y in range(height):
        line = rows[y, 1:].reshape(width, channels)
        if rows[y, 0] == 1:
            above = numpy.cumsum(line, axis=0, dtype=numpy.uint8)
        elif rows[y, 0] == 2:
            above = line + above
        elif rows[y, 0] > 2:
            above = unfiltered(int(rows[y, 0]), line.astype(int), above.astype(int))
        else:
            above = line
        image[y] = above
    return image


def unfiltered(kind, line, above):
    """Of the filters that need the pixel before: average (3) and Paeth (4)."""
    done = numpy.zeros_like(line)
    left = corner = numpy.zeros(line.shape[1], int)
    for x in range(len(line)):
        up = above[x]
        if kind == 3:
            guess = (left + up) // 2
        else:
            a, b, c = abs(up - corner), abs(left - corner), abs(left + up - 2 * corner)
            guess = numpy.where((a <= b) & (a <= c), left, numpy.where(b <= c, up, corner))
        left, corner = (line[x] + guess) % 256, up
        done[x] = left
    return done.astype(numpy.uint8)


def write_png(path, image):
    height, width, _ = image.shape
    lines = numpy.concatenate([numpy.zeros((height, 1), numpy.uint8), image.reshape(height, -1)], axis=1)

    def chunk(kind, data):
        return struct.pack('>I', len(data)) + kind + data + struct.pack('>I', zlib.crc32(kind + data))

    with open(path, 'wb') as file:
        file.write(b'\x89PNG\r\n\x1a\n' + chunk(b'IHDR', struct.pack('>IIBBBBB', width, height, 8, 2, 0, 0, 0)) +
                   chunk(b'IDAT', zlib.compress(lines.tobytes(), 6)) + chunk(b'IEND', b''))


def is_good(row):
    return row['status'] == 0 and row.get('up_right', True) and not row['wrong_cutaway'] and \
        row.get('interior_right', True)


def sheet(out, rows):
    cell_height, cell_width, frame = HEIGHT // 2, WIDTH // 2, 4
    lines = (len(rows) + COLUMNS - 1) // COLUMNS
    page = numpy.full((lines * (cell_height + 2 * frame), COLUMNS * (cell_width + 2 * frame), 3), 255, numpy.uint8)
    for k, row in enumerate(rows):
        y, x = k // COLUMNS * (cell_height + 2 * frame), k % COLUMNS * (cell_width + 2 * frame)
        cell = page[y:y + cell_height + 2 * frame, x:x + cell_width + 2 * frame]
        cell[:] = (40, 160, 70) if is_good(row) else (210, 40, 40)
        inside = cell[frame:-frame, frame:-frame]
        inside[:] = 200
        picture = os.path.join(out, f'{row["number"]:02d}.png')
        if row['status'] == 0 and os.path.exists(picture):
            image = read_png(picture)
            image = image[..., :3] if image.shape[2] >= 3 else numpy.repeat(image, 3, axis=2)
            # A report may hold a panorama, which is of another shape.
            half = image[:image.shape[0] // 2 * 2, :image.shape[1] // 2 * 2].astype(int)
            half = (half[0::2, 0::2] + half[1::2, 0::2] + half[0::2, 1::2] + half[1::2, 1::2]) // 4
            half = half[:cell_height, :cell_width]
            inside[:half.shape[0], :half.shape[1]] = half
        for place, digit in enumerate(f'{row["number"]:02d}'):
            bits = numpy.array([int(bit) for bit in DIGITS[int(digit)]], bool).reshape(5, 3).repeat(3, 0).repeat(3, 1)
            box = inside[2:2 + 19, 2 + 11 * place:2 + 11 * place + 13]
            box[:] = 255
            box[2:17, 2:11][bits] = 0
    write_png(os.path.join(out, 'sheet.png'), page)


def share(rows, key):
    told = [row[key] for row in rows if row.get(key) is not None]
    return f'{sum(told)} of {len(told)}' + (f' ({100 * sum(told) / len(told):.0f} %)' if told else '')


def figures(rows):
    drawn = [row for row in rows if row['status'] == 0]
    invented = [row['invented'] for row in drawn if row['invented'] is not None]
    guessed = sum('guess' in row['up_reason'] for row in drawn)
    return [('scans, drawn', f'{len(rows)}, {len(drawn)}'),
            ('up axis right', share(drawn, 'up_right')),
            ('up axis right where the label is sure (>= 0.8)',
             share([row for row in drawn if row['up_sure'] >= 0.8], 'up_right')),
            ('up axis guessed and said so', str(guessed)),
            ('wrong cutaways', str(sum(row['wrong_cutaway'] for row in drawn))),
            ('interiors cut open', share(drawn, 'interior_right')),
            ('seen from a side labelled good', share(drawn, 'side_right')),
            ('seen from above as labelled', share(drawn, 'elevation_right')),
            ('page used, mean', f'{sum(row["page"] for row in drawn) / max(1, len(drawn)):.3f}'),
            ('most lines on standard error', str(max((row['lines'] for row in drawn), default=0))),
            ('pictures with more than two', str(sum(row['lines'] > 2 for row in drawn))),
            ('invented area, most and mean', f'{max(invented):.3f}, {sum(invented) / len(invented):.4f}'
             if invented else 'not measured (eval_evidence is not built)'),
            ('processor time, all', f'{sum(row["cpu_s"] for row in rows):.1f} s')]


def cells_of(row):
    if row['status'] != 0:
        return [row['number'], row['name'], row['kind'], f'exit {row["status"]}', '', '', '', '', '', '', '']
    up = row['up'] + ('' if row.get('up_right', True) else f' (is {row["labelled_up"]})')
    cut = ('WRONG' if row['wrong_cutaway'] else 'yes') if row['cutaway'] else \
        '' if row.get('interior_right', True) else 'MISSING'
    side = {True: 'good', False: 'OTHER', None: ''}[row.get('side_right')]
    invented = '' if row['invented'] is None else f'{100 * row["invented"]:.1f} %'
    return [row['number'], row['name'], row['kind'], up, cut, side, row['technique'], row['color_by'], invented,
            row['lines'], f'{row["cpu_s"]:.1f}']


HEADS = ['', 'scan', 'kind', 'up', 'cut', 'side', 'technique', 'colours', 'invented', 'notes', 'cpu s']


def table(rows):
    lines = [HEADS] + [[str(cell) for cell in cells_of(row)] for row in rows]
    for line in lines[1:]:
        line[1] = line[1] if len(line[1]) <= 34 else line[1][:16] + '..' + line[1][-16:]
    widths = [max(len(line[k]) for line in lines) for k in range(len(HEADS))]
    return '\n'.join('  '.join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip() for line in lines)


def write_page(out, rows, totals):
    with open(os.path.join(out, 'index.html'), 'w', encoding='utf-8') as page:
        page.write('<!doctype html><meta charset="utf-8"><title>atlas</title>'
                   '<style>body{font:14px sans-serif}figure{display:inline-block;width:480px;margin:6px;'
                   'vertical-align:top;border:4px solid #2a4}figure.wrong{border-color:#d22}img{width:100%}'
                   'pre{white-space:pre-wrap}</style>\n<table>')
        for name, value in totals:
            page.write(f'<tr><td>{html.escape(name)}<td>{html.escape(value)}\n')
        page.write('</table>\n')
        for row in rows:
            words = ', '.join(f'{head} {cell}' for head, cell in zip(HEADS[3:], cells_of(row)[3:]) if cell != '')
            page.write(f'<figure class="{"" if is_good(row) else "wrong"}"><img src="{row["number"]:02d}.png">'
                       f'<figcaption><b>{row["number"]:02d} {html.escape(row["name"])}</b> ({row["kind"]})<br>'
                       f'{html.escape(words)}<br>expected: up {row["labelled_up"]}, side {row["good_sides"]}, colour '
                       f'{row["expected_colour"]}<pre>{html.escape(row["stderr"])}</pre></figcaption></figure>\n')


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--half', choices=('develop', 'closed', 'all'), default='develop')
    parser.add_argument('--atlas', default=os.path.join(ROOT, '../shared/atlas'), help='folder with atlas.json')
    parser.add_argument('--only', help='a file with the names of the scans to render, one a line')
    parser.add_argument('--out', default=os.path.join(ROOT, 'out/atlas'))
    parser.add_argument('--sfumato', default=os.path.join(BIN, 'sfumato'), help='the command to judge')
    options = parser.parse_args()
    index = os.path.join(options.atlas, 'atlas.json')
    if not os.path.exists(index):
        print(f'skipped: {index} is not there; --atlas names the folder')
        return 0
    with open(index, encoding='utf-8') as file:
        scans = half_of(json.load(file), options.half)
    if options.only:
        with open(options.only, encoding='utf-8') as file:
            wanted = {line.strip() for line in file}
        scans = [scan for scan in scans if scan['name'] in wanted]
    os.makedirs(options.out, exist_ok=True)
    rows = []
    for number, scan in enumerate(scans, 1):
        print(f'{number} of {len(scans)}: {scan["name"]}', file=sys.stderr, flush=True)
        rows.append(render(options.sfumato, options.atlas, options.out, number, scan))
    totals = figures(rows)
    sheet(options.out, rows)
    write_page(options.out, rows, totals)
    with open(os.path.join(options.out, 'figures.json'), 'w', encoding='utf-8') as file:
        json.dump({'half': options.half, 'totals': dict(totals), 'scans': rows}, file, indent=1)
    print(table(rows))
    print()
    for name, value in totals:
        print(f'{name}: {value}')
    print(f'{options.out}/sheet.png and index.html show them')
    return 0


if __name__ == '__main__':
    sys.exit(main())
