#!/usr/bin/python3
"""Runs the benchmarks and the peers alternately and prints ours / theirs / ratio.

usage: bench/run.py [GROUP...] [--row TEXT] [--rounds N]

A row of bench/<group>.json is run --rounds times, ours and theirs in turn, so that a busy machine slows both;
the ratio is theirs / ours of the two medians: above 1 we are faster (or smaller). The table goes to standard
output and is appended to out/bench/<group>.md, the numbers to out/bench/<group>.jsonl. See bench/README.md.
"""
import argparse
import glob
import json
import os
import re
import statistics
import subprocess
import sys
import time

import measure
import peers

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(HERE)
BUILD = os.environ.get('SFUMATO_BUILD') or os.path.join(ROOT, 'build/release')
BENCH = os.path.join(BUILD, 'bin/sfumato_bench')
OUT = os.path.join(ROOT, 'out/bench')
TIMEOUT_S = 240
CPU = 'ms of processor time'
# What Google Benchmark appends to a name.
SUFFIXES = r'(/(real_time|process_time|manual_time|[a-z_]+:[0-9.]+))*$'
REPORTS = measure.Reports()
TO_MS = {'ns': 1e-6, 'us': 1e-3, 'ms': 1.0, 's': 1e3}


def log(text):
    print(text, file=sys.stderr, flush=True)


def cloud_file(name):
    """(path, count) of tori_<count> or tori_m_<count> (Morton order), written when missing, or of a path."""
    match = re.fullmatch(r'tori_(m_)?(\d+)', name)
    if not match:
        return name, 0
    path = os.path.join(OUT, name + '.ply')
    if not os.path.exists(path):
        order = 'morton' if match.group(1) else 'random'
        subprocess.run([os.path.join(BUILD, 'bin/gen_tori'), match.group(2), path, order], check=True)
    return path, int(match.group(2))


def google_benchmark(name):
    """Milliseconds of each repetition of a benchmark, named without Google's suffixes. Empty: no such one."""
    if not os.path.exists(BENCH):
        return []
    pattern = '^' + re.escape(name) + SUFFIXES
    done = measure.process([BENCH, '--benchmark_filter=' + pattern, '--benchmark_format=json'], TIMEOUT_S)
    try:
        runs = json.loads(done.stdout)['benchmarks']
    except ValueError:
        if done.returncode == 0:
            return []
        raise RuntimeError('sfumato_bench: ' + (done.stderr.strip().splitlines() or ['failed'])[-1]) from None
    failed = [run['error_message'] for run in runs if run.get('error_occurred')]
    if failed:
        raise RuntimeError(failed[0])
    return [run['real_time'] * TO_MS[run['time_unit']] for run in runs if run['run_type'] == 'iteration']


def command(words, cloud):
    """A whole process, as measure.Done."""
    places = {'cloud': cloud, 'sfumato': os.path.join(BUILD, 'bin/sfumato'), 'scratch': measure.scratch(),
              'python': peers.PYTHON, 'peers': peers.SCRIPTS, 'bench': HERE, 'bin': os.path.join(BUILD, 'bin')}
    os.environ['PYTHONPATH'] = os.path.join(BUILD, 'python')
    done = measure.process([word.format(**places) for word in words], TIMEOUT_S)
    if done.returncode:
        raise RuntimeError((done.stderr.strip().splitlines() or ['exit code %d' % done.returncode])[-1])
    return done


def fields_of(words, cloud):
    """What a command prints as JSON, with its peak memory."""
    done = command(words, cloud)
    return {**json.loads(done.stdout.splitlines()[-1]), 'peak_mb': done.peak_mb}


def run_ours(row, cloud):
    """(values, peak megabytes of the process or nothing)"""
    if isinstance(row['ours'], list):
        if row['field']:
            run = REPORTS.of((cloud, *row['ours']), row['field'], lambda: fields_of(row['ours'], cloud))
            return [float(run[row['field']])], run['peak_mb']
        done = command(row['ours'], cloud)
        return [{'MB': done.peak_mb, CPU: done.cpu_ms}.get(row['unit'], done.wall_ms)], done.peak_mb
    return google_benchmark(row['ours']), None


def run_theirs(row, cloud, count):
    """(values, version)"""
    theirs = row['theirs']
    if theirs.startswith('ours '):  # a comparison within sfumato: one thread, another technique
        return google_benchmark(theirs[5:]), 'sfumato'
    value, version = peers.run(theirs, cloud, count, BUILD, TIMEOUT_S)
    return [value], version


def run_row(row, rounds):
    """Fills a row with ours, theirs, ratio and notes."""
    row = {'unit': 'ms', 'theirs': None, 'goal': None, 'limit': None, 'field': None, 'cloud': '', 'rounds': rounds, **row}
    cloud, count = cloud_file(row['cloud'])
    ours, theirs, notes, version, peak_mb = [], [], [], '', None
    row['load'] = round(os.getloadavg()[0], 1)
    for _ in range(row['rounds']):
        try:
            if not any(note.startswith('ours') for note in notes):
                values, peak_mb = run_ours(row, cloud)
                ours += values
        except (RuntimeError, OSError, subprocess.TimeoutExpired) as error:
            notes.append('ours: %s' % error)
        try:
            if row['theirs'] and not any(note.startswith('theirs') for note in notes):
                values, version = run_theirs(row, cloud, count)
                theirs += values
        except peers.Missing as missing:
            notes.append('theirs: %s' % missing)
        except (RuntimeError, OSError, subprocess.TimeoutExpired) as error:
            notes.append('theirs: %s' % error)
    if not ours and not notes:
        notes.append('ours: no benchmark of that name')
    if peak_mb and row['unit'] != 'MB':
        notes.append('our peak memory %.0f MB' % peak_mb)
    row['ours_value'] = statistics.median(ours) if ours else None
    row['theirs_value'] = statistics.median(theirs) if theirs else None
    row['ratio'] = row['theirs_value'] / row['ours_value'] if ours and theirs else None
    if row['ratio'] and row['unit'] == '/s':  # more is better
        row['ratio'] = 1 / row['ratio']
    row['peer'], row['notes'] = version, notes
    return row


def number(value):
    return '%.0f' % value if value >= 100 else '%.3g' % value


def verdict(row):
    """Goal and whether it is met: a least ratio, or a most in the row's unit."""
    if row['goal'] is not None:
        met = '' if row['ratio'] is None else ' met' if row['ratio'] >= row['goal'] else ' **missed**'
        return '>= %gx%s' % (row['goal'], met)
    if row['limit'] is not None:
        value = row['ours_value']
        met = '' if value is None else ' met' if value <= row['limit'] else ' **missed**'
        return '<= %g %s%s' % (row['limit'], row['unit'], met)
    return ''


HEADER = '| what | cloud | ours | theirs | ratio | goal | peer |\n|---|---|---|---|---|---|---|'


def line(row):
    ratio = '' if row['ratio'] is None else '%.2fx' % row['ratio']
    ours, theirs = ('' if row[key] is None else number(row[key]) + ' ' + row['unit']
                    for key in ('ours_value', 'theirs_value'))
    peer = '; '.join([row['peer'] or row['theirs'] or ''] + row['notes']).strip('; ')
    return '| ' + ' | '.join([row['row'], row['cloud'], ours, theirs, ratio, verdict(row), peer]) + ' |'


def rows_of(group):
    """The rows of the group's table, then its benchmarks that no row names."""
    rows = []
    table = os.path.join(HERE, group + '.json')
    if os.path.exists(table):
        with open(table, encoding='utf-8') as file:
            rows = json.load(file)
    named = {row['ours'] for row in rows if isinstance(row['ours'], str)}
    named |= {row['theirs'][5:] for row in rows if (row.get('theirs') or '').startswith('ours ')}
    if os.path.exists(BENCH):
        listed = subprocess.run([BENCH, '--benchmark_list_tests', '--benchmark_filter=^%s/' % group],
                                stdout=subprocess.PIPE, text=True, check=True).stdout
        for name in listed.split():
            name = re.sub(SUFFIXES, '', name)
            if name.startswith(group + '/') and name not in named:
                named.add(name)
                rows.append({'row': name[len(group) + 1:], 'ours': name})
    return rows


def groups():
    names = glob.glob(os.path.join(HERE, '*_bench.cpp')) + glob.glob(os.path.join(HERE, '*.json'))
    return sorted({re.sub(r'(_bench\.cpp|\.json)$', '', os.path.basename(name)) for name in names})


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('groups', nargs='*', metavar='GROUP', help='of: ' + ' '.join(groups()))
    parser.add_argument('--row', default='', help='only rows whose name holds this')
    parser.add_argument('--rounds', type=int, default=3)
    arguments = parser.parse_args()
    unknown = [group for group in arguments.groups if group not in groups()]
    if unknown:
        parser.error('no group %s; there are: %s' % (unknown[0], ' '.join(groups())))
    os.makedirs(OUT, exist_ok=True)
    os.environ['SFUMATO_BENCH_DATA'] = OUT
    # The peers' X server has no GPU, so both sides draw on the CPU unless told otherwise.
    os.environ.setdefault('LIBGL_ALWAYS_SOFTWARE', '1')
    for group in arguments.groups or groups():
        head = '%s, %s, %d cores, load at the start %.1f; %d alternating rounds; ratio = theirs / ours' % (
            group, time.strftime('%Y-%m-%d %H:%M'), os.cpu_count(), os.getloadavg()[0], arguments.rounds)
        table = [head, '', HEADER]
        print('\n'.join(table), flush=True)
        for row in rows_of(group):
            if arguments.row in row['row']:
                log('... ' + row['row'])
                done = run_row(row, arguments.rounds)
                table.append(line(done))
                print(table[-1], flush=True)
                with open(os.path.join(OUT, group + '.jsonl'), 'a', encoding='utf-8') as file:
                    file.write(json.dumps({'time': time.time(), **done}) + '\n')
        with open(os.path.join(OUT, group + '.md'), 'a', encoding='utf-8') as file:
            file.write('\n'.join(table) + '\n\n')


if __name__ == '__main__':
    main()
