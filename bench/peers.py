"""The other programs that benchmarks are compared with: how to run each, what it reports, why it is missing.

A row names a peer as "<program> <what>", such as "vtk edl" or "open3d load"; "vtk process" is its whole script.
"""
import json
import os
import shutil
import subprocess

import measure

PYTHON = '/usr/bin/python3'  # Debian's: another python3 on the PATH does not see Debian's modules
SCRIPTS = os.path.join(os.path.dirname(os.path.abspath(__file__)), 'peers')
XVFB = ['xvfb-run', '-a', '-s', '-screen 0 1024x1024x24']
TIMER = [PYTHON, os.path.join(os.path.dirname(SCRIPTS), 'measure.py')]
THREADS = str(os.cpu_count())
NEIGHBORS = '24'
FRAMES = {128000: '7', 1000000: '5', 6000000: '3'}
FIELDS = {'load': 'load_ms', 'normals': 'normals_ms', 'points': 'frame_ms', 'array': 'array_ms', 'views': 'view_ms'}


class Missing(Exception):
    """The peer cannot run here; says why."""


def _need_module(module, package):
    probe = 'import importlib.util, sys; sys.exit(not importlib.util.find_spec(%r))' % module
    if subprocess.run([PYTHON, '-c', probe], check=False).returncode:
        raise Missing(package + ' is not installed')


def _need_xvfb():
    if not shutil.which('xvfb-run'):
        raise Missing('xvfb is not installed')


def _need_binary(build, name, package):
    path = os.path.join(build, 'bin', name)
    if not os.path.exists(path):
        raise Missing(package + ' is not installed')
    return path


def _report(command, field, timeout):
    """Runs a peer that prints one JSON line; (value, version)."""
    done = measure.process(command, timeout)
    lines = [line for line in done.stdout.splitlines() if line.startswith('{')]
    if not lines:
        raise Missing('printed no result: ' + (done.stderr.strip().splitlines() or ['(silent)'])[-1])
    result = json.loads(lines[-1])
    return float(result[field]), result.get('peer', '')


def _vtk(what, cloud, count, build, timeout):
    _need_module('vtk', 'python3-vtk9')
    _need_xvfb()
    script = [PYTHON, os.path.join(SCRIPTS, 'peer_vtk.py'), cloud]
    if what == 'process':  # start, load with numpy, two frames, a PNG, exit; timed inside the X server
        png = ['env', 'PNG_DIR=' + measure.scratch()]
        value, _ = _report(png + XVFB + TIMER + script + ['points', '0'], 'wall_ms', timeout)
        return value, 'vtk script'
    if what == 'script':
        return _report(XVFB + TIMER + script + ['array'], 'wall_ms', timeout)[0], 'vtk script'
    if what in ('interactor', 'first'):  # a window, points of 1 px as VTK draws them by default
        return _report(XVFB + script + ['interactor'], 'motion_ms' if what == 'interactor' else 'first_ms', timeout)
    return _report(XVFB + script + [what, FRAMES.get(count, '5')], FIELDS.get(what, 'frame_ms'), timeout)


def _f3d(what, cloud, count, build, timeout):
    """Its points of 2 px in the colours of the file, 1280x720; `what`: a field of measure.py."""
    if not shutil.which('f3d'):
        raise Missing('f3d is not installed')
    _need_xvfb()
    picture = ['--output=' + os.path.join(measure.scratch(), 'f3d.png'), '--resolution=1280,720']
    looks = ['--scalars=RGBA', '--comp=-2', '--point-size=2']
    return _report(['xvfb-run', '-a', '-s', '-screen 0 1280x1024x24'] + TIMER + ['f3d', cloud] + picture + looks, what,
                   timeout)[0], 'f3d'


def _open3d(what, cloud, count, build, timeout):
    _need_module('open3d', 'python3-open3d')
    draws = what in ('points', 'views', 'array', 'script')
    if draws:
        _need_xvfb()
    command = [PYTHON, os.path.join(SCRIPTS, 'peer_open3d.py'), cloud, 'array' if what == 'script' else what]
    if what == 'script':  # start, import, read, picture, exit; timed inside the X server
        return _report(XVFB + TIMER + command, 'wall_ms', timeout)[0], 'open3d script'
    return _report((XVFB if draws else []) + command, FIELDS[what], timeout)


def _pcl(what, cloud, count, build, timeout):
    if what == 'clusters':  # five median spacings of that scan, thresholds of PCL's tutorial
        binary = _need_binary(build, 'peer_pcl_clusters', 'libpcl-dev')
        data = os.environ.get('SFUMATO_TEST_DATA', '../shared/data')
        labels = os.path.join(os.environ['SFUMATO_BENCH_DATA'], 'pcl_clusters.u32')
        return _report([binary, os.path.join(data, 'Guanyin.ply'), '0.0168', '6', '5', '100', '30', labels],
                       'clusters_ms', timeout)
    binary = _need_binary(build, 'peer_pcl', 'libpcl-dev')
    neighbors = NEIGHBORS if what == 'normals' else '0'
    return _report([binary, cloud, neighbors, THREADS], FIELDS[what], timeout)


def _nanoflann(what, cloud, count, build, timeout):
    binary = _need_binary(build, 'peer_nanoflann', 'libnanoflann-dev')
    return _report([binary, cloud, NEIGHBORS, THREADS], FIELDS[what], timeout)


def _pvserver(what, cloud, count, build, timeout):
    """`what`: a field, with "@MS,MBIT" behind it over such a line."""
    if not shutil.which('pvserver') or not shutil.which('pvpython'):
        raise Missing('paraview and python3-paraview are not installed')
    _need_xvfb()
    field, _, line = what.partition('@')
    command = XVFB + [PYTHON, os.path.join(SCRIPTS, 'peer_pvserver.py'), cloud] + (['--line', line] if line else [])

    def run():
        for _ in range(2):  # a client sometimes fails to connect
            lines = measure.process(command, 2.5 * timeout).stdout.splitlines()  # to load 10.6M takes minutes
            if lines and lines[-1].startswith('{"'):
                return json.loads(lines[-1])
        return {}

    result = _REPORTS.of((cloud, line), field, run)
    if field not in result:
        raise Missing('pvserver printed no result')
    return float(result[field]), result.get('peer', '')


_REPORTS = measure.Reports()
PROGRAMS = {'pvserver': _pvserver, 'f3d': _f3d, 'vtk': _vtk, 'open3d': _open3d, 'pcl': _pcl, 'nanoflann': _nanoflann}


def run(peer, cloud, count, build, timeout):
    """(milliseconds, version) of one run. Raises Missing."""
    program, what = peer.split()
    return PROGRAMS[program](what, cloud, count, build, timeout)
