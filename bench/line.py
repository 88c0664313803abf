"""A line of a latency and a rate each way, between a client and a server of this machine."""
import queue
import socket
import threading
import time


class Line:
    """`ms` there and back, `mbit` a second each way."""

    def __init__(self, ms, mbit):
        self.delay, self.rate = ms / 2000, mbit * 1e6 / 8

    def join(self, near, far):
        for end in (near, far):
            end.settimeout(None)
            end.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        for one, other in ((near, far), (far, near)):
            sent = queue.Queue(16)  # as a router's: what does not fit waits at its sender
            threading.Thread(target=self._take, args=(one, sent), daemon=True).start()
            threading.Thread(target=self._give, args=(other, sent), daemon=True).start()

    def _take(self, source, sent):
        free = 0.0
        try:
            while data := source.recv(4096):
                free = max(free, time.monotonic()) + len(data) / self.rate
                sent.put((free + self.delay, data))
                time.sleep(max(0, free - time.monotonic()))
        except OSError:
            pass
        sent.put((0, b''))

    def _give(self, target, sent):
        try:
            while True:
                due, data = sent.get()
                if not data:
                    return target.shutdown(socket.SHUT_WR)
                time.sleep(max(0, due - time.monotonic()))
                target.sendall(data)
        except OSError:
            return None


def listen(line, connect):
    """The port at which each that connects is joined by `line` to what `connect` returns."""
    listener = socket.create_server(('127.0.0.1', 0))

    def accept():
        while True:
            near, _ = listener.accept()
            line.join(near, connect())

    threading.Thread(target=accept, daemon=True).start()
    return listener.getsockname()[1]
