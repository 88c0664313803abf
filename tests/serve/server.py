"""A server under test, and WebSockets by hand: the standard library alone."""
import base64
import json
import os
import re
import signal
import socket
import struct
import subprocess
import tempfile
import time
import urllib.request

COMMAND = os.environ["SFUMATO_COMMAND"]
failures = []  #: what `check` found wrong


def check(what, holds, detail=""):
    print(("ok    " if holds else "WRONG ") + what + ("" if holds else f": {detail!r}"), flush=True)
    if not holds:
        failures.append(what)


def make_scan(folder, points=20000):
    """A synthetic scan and the truth of it: the PLY itself, read by nobody but the tests."""
    file = os.path.join(folder, "scan.ply")
    subprocess.run([COMMAND, "synth", "spheres", "--points", str(points), "-o", file, "--quiet"], check=True)
    return file


def points_of(file):
    """Coordinates of a PLY by its own words, without a line of ours."""
    with open(file, "rb") as data:
        head, body = data.read().split(b"end_header\n", 1)
    size = {b"float": ("f", 4), b"double": ("d", 8), b"uchar": ("B", 1), b"ushort": ("H", 2), b"int": ("i", 4), b"uint": ("I", 4),
            b"short": ("h", 2), b"char": ("b", 1), b"float32": ("f", 4), b"uint8": ("B", 1), b"float64": ("d", 8)}
    fields, count, of_vertex = [], 0, False
    for line in head.splitlines():
        words = line.split()
        if words[:1] == [b"element"]:
            of_vertex = words[1] == b"vertex"
            count = int(words[2]) if of_vertex else count
        elif words[:1] == [b"property"] and of_vertex:
            fields.append((words[2].decode(), size[words[1]][0]))
    row = struct.Struct("<" + "".join(code for _, code in fields))
    names = [name for name, _ in fields]
    return [dict(zip(names, values)) for values in row.iter_unpack(body[:row.size * count])]


def free_port():
    with socket.socket() as line:
        line.bind(("127.0.0.1", 0))
        return line.getsockname()[1]


class Server:
    def __init__(self, *words):
        self.errors = tempfile.TemporaryFile()
        self.process = subprocess.Popen([COMMAND, "serve", *words, "--port", "0"], stdout=subprocess.PIPE,
                                        stderr=self.errors, text=True)
        self.address = self.process.stdout.readline().strip()
        found = re.fullmatch(r"http://([0-9.]+):(\d+)/([0-9a-f]{32})/", self.address)
        if not found:
            self.process.wait(60)
            raise AssertionError(f"no address but {self.address!r}: {self.said()}")
        self.host, self.port, self.token = found[1], int(found[2]), found[3]

    def said(self):
        self.errors.seek(0)
        return self.errors.read().decode()

    def get(self, path, headers=None, token=True, seconds=240):
        """Status, headers and body."""
        base = self.address if token else f"http://{self.host}:{self.port}/"
        request = urllib.request.Request(base + path, headers=headers or {})
        try:
            with urllib.request.urlopen(request, timeout=seconds) as answer:
                return answer.status, answer.headers, answer.read()
        except urllib.error.HTTPError as error:
            return error.code, error.headers, error.read()

    def wait_ready(self, seconds=120):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if self.get("info")[0] == 200:
                return
            time.sleep(0.2)
        raise AssertionError("the server did not read its files: " + self.said())

    def info(self):
        return json.loads(self.get("info")[2])

    def connect(self):
        return socket.create_connection((self.host, self.port), timeout=60)

    def raw(self, data, seconds=20):
        """What comes back for bytes as they are; empty: the server hung up."""
        with self.connect() as line:
            line.settimeout(seconds)
            try:
                line.sendall(data)
                return line.recv(65536)
            except (ConnectionError, BrokenPipeError):
                return b""

    def peak(self):
        """Resident bytes at most so far."""
        with open(f"/proc/{self.process.pid}/status") as status:
            return 1024 * int(re.search(r"VmHWM:\s+(\d+)", status.read())[1])

    def stop(self, how=signal.SIGINT):
        """Exit code and seconds that it took."""
        began = time.monotonic()
        self.process.send_signal(how)
        code = self.process.wait(60)
        self.process.stdout.close()
        return code, time.monotonic() - began

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.stop(signal.SIGKILL)


class Socket:
    """The page's end of a WebSocket."""

    def __init__(self, server, token=None, headers=(), path="socket"):
        self.line = server.connect()
        key = base64.b64encode(os.urandom(16)).decode()
        lines = [f"GET /{token or server.token}/{path} HTTP/1.1", f"Host: {server.host}:{server.port}",
                 "Upgrade: websocket", "Connection: Upgrade", f"Sec-WebSocket-Key: {key}",
                 "Sec-WebSocket-Version: 13", *headers]
        self.line.sendall(("\r\n".join(lines) + "\r\n\r\n").encode())
        answer = b""
        while b"\r\n\r\n" not in answer:
            more = self.line.recv(4096)
            if not more:
                break
            answer += more
        self.status = int(answer.split()[1]) if answer else 0
        self.rest = answer.partition(b"\r\n\r\n")[2]
        self.state, self.says, self.pictures, self.shots, self.commands = {}, [], [], [], []
        self.closed = None

    def send(self, **message):
        self.frame(1, json.dumps(message).encode())

    def frame(self, kind, data, final=True, masked=True):
        size = len(data)
        head = bytes([kind | (128 if final else 0)])
        bit = 128 if masked else 0
        if size < 126:
            head += bytes([bit | size])
        elif size < 65536:
            head += bytes([bit | 126]) + struct.pack(">H", size)
        else:
            head += bytes([bit | 127]) + struct.pack(">Q", size)
        mask = os.urandom(4) if masked else b""
        body = bytes(b ^ mask[i % 4] for i, b in enumerate(data)) if masked else data
        self.line.sendall(head + mask + body)

    def _take(self, count):
        while len(self.rest) < count:
            more = self.line.recv(65536)
            if not more:
                raise ConnectionError("closed")
            self.rest += more
        taken, self.rest = self.rest[:count], self.rest[count:]
        return taken

    def listen(self, until, seconds=120, confirms=True):
        """Takes what comes until `until(self)` holds."""
        end = time.monotonic() + seconds
        while not until(self):
            if self.closed is not None or time.monotonic() > end:
                raise AssertionError(f"it did not come: closed {self.closed}, said {self.says}, state {list(self.state)}")
            self.line.settimeout(max(0.01, end - time.monotonic()))
            try:
                kind, data = self.receive()
            except ConnectionError:
                self.closed = (0, "gone")
                continue
            if kind == 1:
                said = json.loads(data)
                self.state.update(said.get("state", {}))
                if "say" in said:
                    self.says.append(said["say"])
                if "command" in said:
                    self.commands.append(said["command"])
            elif kind == 2:
                size = struct.unpack("<I", data[:4])[0]
                header = json.loads(data[4:4 + size])
                body = data[4 + size + header.get("depth", {}).get("bytes", 0):]
                if header["kind"] == "shot":
                    self.shots.append((header, body))
                else:
                    self.pictures.append((header, body))
                    if confirms:
                        self.send(do="got", id=header["id"])
            elif kind == 8:
                self.closed = (struct.unpack(">H", data[:2])[0] if data else 0, data[2:].decode())
            elif kind == 9:
                self.frame(10, data)
        return self

    def receive(self):
        kind, size = self._take(2)
        if size == 126:
            size = struct.unpack(">H", self._take(2))[0]
        elif size == 127:
            size = struct.unpack(">Q", self._take(8))[0]
        return kind & 15, self._take(size)

    def is_exact(self):
        return bool(self.pictures) and self.pictures[-1][0]["exact"]

    def close(self):
        self.line.close()
