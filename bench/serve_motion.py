#!/usr/bin/python3
"""A page of `sfumato serve` in motion, as the server's other end sees it: no browser, so neither decoding nor painting is in it.

usage: serve_motion.py SFUMATO CLOUD TECHNIQUE [--line MS,MBIT] [OPTION...]

Turns the view with 60 messages a second for some seconds, then by single messages at rest. Prints as JSON: pictures_a_second and
kb_a_second of the motion, its JPEG's mean_kb, photon_ms (median, from a message to the first picture made after it, complete at the
page), converge_ms (from letting go to the exact picture). --line puts a proxy between: MS there and back, MBIT a second each way.
"""
import json
import os
import socket
import statistics
import sys
import threading
import time

SFUMATO, CLOUD, TECHNIQUE = sys.argv[1:4]
os.environ['SFUMATO_COMMAND'] = SFUMATO
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '../tests/serve'))
from line import Line, listen  # noqa: E402
from server import Server, Socket  # noqa: E402

MOTION_S, SINGLE, LONGEST_S = 8, 12, 60
SIZE = {'width': 1280, 'height': 720}


class Slow:
    """A server behind a line."""

    def __init__(self, server, ms, mbit):
        self.host, self.token, self.port = server.host, server.token, listen(Line(ms, mbit), server.connect)

    def connect(self):
        return socket.create_connection((self.host, self.port), timeout=60)


def main():
    words = sys.argv[4:]
    line = None
    if words[:1] == ['--line']:
        line = [float(number) for number in words[1].split(',')]
        words = words[2:]
    with Server(CLOUD, '-t', TECHNIQUE, '--quiet', *words) as server:
        server.wait_ready()
        page = Socket(Slow(server, *line) if line else server)
        page.send(do='size', **SIZE)
        page.listen(Socket.is_exact, 240)
        page.send(do='grab', kind='rotate', x=640, y=360)
        moving = True

        def hand():
            while moving:
                page.send(do='drag', dx=2, dy=0.3)
                time.sleep(1 / 60)

        # The first second of a motion finds out what line and machine carry.
        mover = threading.Thread(target=hand)
        mover.start()
        began = time.monotonic()
        page.listen(lambda _: time.monotonic() > began + 1)
        first, began = len(page.pictures), time.monotonic()
        page.listen(lambda _: time.monotonic() > began + MOTION_S)
        took = time.monotonic() - began
        seen = page.pictures[first:]
        moving = False
        mover.join()
        let_go = time.monotonic()
        page.listen(Socket.is_exact, 240)
        converge = time.monotonic() - let_go
        waits, singles = [], time.monotonic()
        for _ in range(SINGLE):
            time.sleep(0.3)
            page.listen(Socket.is_exact, 240)
            before = page.pictures[-1][0]['camera']
            sent = time.monotonic()
            page.send(do='drag', dx=15, dy=0)
            page.listen(lambda s: s.pictures[-1][0]['camera'] != before)
            waits.append(time.monotonic() - sent)
            page.listen(Socket.is_exact, 240)
            if time.monotonic() - singles > LONGEST_S:
                break
        size = sum(len(body) + header.get('depth', {}).get('bytes', 0) for header, body in seen)
        print(json.dumps({'technique': TECHNIQUE, 'pictures_a_second': round(len(seen) / took, 1), 'kb_a_second': round(size / took / 1000),
                          'mean_kb': round(size / 1000 / max(1, len(seen)), 1), 'photon_ms': round(1000 * statistics.median(waits)),
                          'converge_ms': round(1000 * converge)}))


main()
