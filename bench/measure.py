"""Running a process and measuring it from outside.

usage: measure.py COMMAND...   prints {"wall_ms": ..., "cpu_ms": ..., "peak_mb": ...} after what the command printed
"""
import collections
import json
import os
import subprocess
import sys
import tempfile
import time

Done = collections.namedtuple('Done', 'wall_ms cpu_ms peak_mb stdout stderr returncode')

_scratch = None


def scratch():
    """A folder for files that nobody keeps; gone at exit."""
    global _scratch
    if _scratch is None:
        _scratch = tempfile.TemporaryDirectory(prefix='sfumato-bench-')
    return _scratch.name


def process(command, timeout):
    """Runs it to its end. Raises subprocess.TimeoutExpired, after ending it and what it started."""
    with tempfile.TemporaryFile('w+') as out, tempfile.TemporaryFile('w+') as err:
        start = time.perf_counter()
        child = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=out, stderr=err,
                                 start_new_session=True)
        deadline = start + timeout
        while True:
            # wait4 and not communicate(): time and peak memory of this child, and what it waited for, come with it.
            pid, status, usage = os.wait4(child.pid, os.WNOHANG)
            if pid:
                break
            if time.perf_counter() > deadline:
                os.killpg(child.pid, 15)
                os.wait4(child.pid, 0)
                raise subprocess.TimeoutExpired(command, timeout)
            time.sleep(0.002)
        wall_ms = 1e3 * (time.perf_counter() - start)
        child.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0)
        err.seek(0)
        cpu_ms = 1e3 * (usage.ru_utime + usage.ru_stime)
        return Done(wall_ms, cpu_ms, usage.ru_maxrss / 1024, out.read(), err.read(), child.returncode)


class Reports:
    """What a long run reports, for rows that ask for one field each: none gets the same number of the same run twice."""

    def __init__(self):
        self._left = {}

    def of(self, key, field, run):
        """The report of the latest run of `key` whose `field` is not taken yet, else of a new one."""
        report, taken = self._left.get(key, ({}, set()))
        if not report or field in taken:
            report, taken = self._left[key] = (run(), set())
        taken.add(field)
        return report


if __name__ == '__main__':
    measured = process(sys.argv[1:], 600)
    print(measured.stdout)
    print(json.dumps({'wall_ms': measured.wall_ms, 'cpu_ms': measured.cpu_ms, 'peak_mb': measured.peak_mb}))
    sys.exit(measured.returncode)
