"""What strangers and broken programs send to the server: refused in one line, within bounded memory, and others go on."""
import json
import os
import signal
import struct
import subprocess
import sys
import tempfile
import threading
import time

sys.path.insert(0, os.path.dirname(__file__))
from server import COMMAND, Server, Socket, check, failures, make_scan  # noqa: E402


def status(answer):
    return int(answer.split()[1]) if answer.startswith(b"HTTP/1.1 ") else 0


def requests_of(server):
    """Name, bytes, statuses that are right (0: hung up)."""
    host, token = f"127.0.0.1:{server.port}", server.token

    def ask(path, more=(), method="GET", name=host):
        ends = [] if "Connection: Upgrade" in more else ["Connection: close"]
        return "\r\n".join([f"{method} {path} HTTP/1.1", f"Host: {name}", *ends, *more, "", ""]).encode()

    good = f"/{token}/"
    wrong = ("0" if token[0] != "0" else "1") + token[1:]
    yield "the page itself", ask(good), {200}
    yield "no token", ask("/"), {403}
    yield "a wrong token", ask(f"/{wrong}/"), {403}
    yield "a token that is too short", ask(f"/{token[:-1]}/info"), {403}
    yield "a wrong bearer token", ask("/info", [f"Authorization: Bearer {wrong}"]), {403}
    yield "a wrong token of a query", ask(f"/info?token={wrong}"), {403}
    yield "pictures without a token", ask("/render?technique=points"), {403}
    yield "another host (DNS rebinding)", ask(good, name="evil.example:8080"), {421}
    yield "a host that only begins like ours", ask(good, name="localhost.evil.example"), {421}
    yield "no host", f"GET {good} HTTP/1.1\r\nConnection: close\r\n\r\n".encode(), {421}
    yield "another origin", ask(good + "info", ["Origin: http://evil.example"]), {403}
    yield "origin null", ask(good + "info", ["Origin: null"]), {403}
    yield "our own origin", ask(good + "info", [f"Origin: http://{host}"]), {200}
    for path in ("../../etc/passwd", "..%2f..%2fetc%2fpasswd", "%2e%2e/%2e%2e/etc/passwd", "page/../index.html",
                 "....//etc/passwd", "etc/passwd", "/etc/passwd"):
        yield f"traversal {path}", ask(good + path), {404}
    yield "a byte 0 in the path", ask(good + "info%00.html"), {400}
    yield "a broken escape", ask(good + "info?x=%zz"), {400}
    yield "an escape that is cut off", ask(good + "%2"), {400}
    yield "a path of 6000 bytes", ask(good + "a" * 6000), {400}
    yield "a header of 20,000 bytes", ask(good, ["X: " + "a" * 20000]), {431, 400, 0}
    yield "5000 headers", ask(good, [f"X{i}: 1" for i in range(5000)]), {431, 400, 0}
    yield "a header that claims 4 GB", ask(good, ["Content-Length: 4294967296"]), {413, 400, 0}
    yield "a body of 1 byte", ask(good, ["Content-Length: 1"]) + b"x", {413, 400, 0}
    yield "a length below zero", ask(good, ["Content-Length: -1"]), {400, 0}
    yield "two lengths", ask(good, ["Content-Length: 1", "Content-Length: 2"]), {400, 0}
    yield "chunks without an end", ask(good, ["Transfer-Encoding: chunked"]) + b"fffffffffffffff\r\n", {400, 413, 0}
    for method in ("POST", "PUT", "DELETE", "OPTIONS", "TRACE", "CONNECT"):
        yield f"method {method}", ask(good, method=method), {405, 400}
    yield "an unknown method", ask(good, method="FROBNICATE"), {405, 400}
    yield "no HTTP at all", b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + bytes(200) + b"\r\n\r\n", {400, 0}
    yield "a line of nothing", b"\r\n\r\n\r\n", {400, 0}
    yield "HTTP/9.9", f"GET {good} HTTP/9.9\r\nHost: {host}\r\n\r\n".encode(), {400, 0}
    yield "a socket without its headers", ask(good + "socket"), {404}
    render = good + "render?resolution=64x64&"
    for option in ("output=/tmp/x.png", "o=/tmp/x.png", "output-depth=x.npy", "preset=/etc/passwd", "scene=/etc/passwd",
                   "camera=/etc/passwd", "save-preset=/tmp/x", "save-scene=/tmp/x", "path=orbit", "shader-dir=/", "watch=",
                   "threads=1", "transform=1: 1", "columns=x,y,z", "memory=1", "json=", "help=", "nonsense=1",
                   "technique=nonsense", "resolution=0x0", "resolution=99999x9", "point-size=nan", "crop=1,2", "draw=x",
                   "color-by=nonsense", "view=inside"):
        yield f"render?{option}", ask(render + option.replace(" ", "%20")), {400}
    upgrade = ["Upgrade: websocket", "Connection: Upgrade", "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==",
               "Sec-WebSocket-Version: 13"]
    yield "a socket without a token", ask("/socket", upgrade), {403}
    yield "a socket of another origin", ask(good + "socket", ["Origin: http://evil.example", *upgrade]), {403}
    yield "a socket elsewhere", ask(good + "info", upgrade), {404}


def sockets(server):
    """Name, what is done with a socket; each is closed by the server."""
    yield "no JSON", lambda s: s.frame(1, b"{{{{")
    yield "JSON that is no object", lambda s: s.frame(1, b"[1,2]")
    yield "nested 10,000 deep", lambda s: s.frame(1, b"[" * 10000)
    yield "an unknown deed", lambda s: s.send(do="erase", file="/etc/passwd")
    yield "a number that is a text", lambda s: s.send(do="drag", dx="1", dy=2)
    yield "a number beyond all", lambda s: s.frame(1, b'{"do":"drag","dx":1e300,"dy":0}')
    yield "NaN", lambda s: s.frame(1, b'{"do":"drag","dx":NaN,"dy":0}')
    yield "a picture of 10^9 pixels a side", lambda s: s.send(do="size", width=10**9, height=10**9)
    yield "a shot of 10^6 pixels a side", lambda s: s.send(do="shoot", width=10**6, height=10**6)
    yield "a text of 30,000 bytes", lambda s: s.send(do="technique", name="x" * 30000)
    yield "a message of 1 MB", lambda s: s.frame(1, b'{"do":"' + b"x" * 1000000 + b'"}')
    yield "bytes for text", lambda s: s.frame(2, b"\x00\x01\x02")
    yield "text that is no UTF-8", lambda s: s.frame(1, b'{"do":"\xff\xfe"}')
    yield "a frame without a mask", lambda s: s.frame(1, b'{"do":"undo"}', masked=False)
    yield "an unknown kind of frame", lambda s: s.frame(7, b"x")
    yield "a frame that claims 2^62 bytes", lambda s: s.line.sendall(b"\x81\xff" + struct.pack(">Q", 2**62) + b"abcd")
    yield "pieces without an end", lambda s: [s.frame(1 if i == 0 else 0, b"x" * 30000, final=False) for i in range(4)]
    yield "5000 messages at once", lambda s: [s.send(do="drag", dx=1, dy=1) for _ in range(5000)]


def main():
    with tempfile.TemporaryDirectory() as folder, Server(make_scan(folder), "-t", "points", "--clients", "60",
                                                         "--quiet") as server:
        server.wait_ready()
        before = server.peak()
        for name, data, right in requests_of(server):
            answer = server.raw(data)
            check(name, status(answer) in right, answer[:200])
            if status(answer) >= 400 and not name.startswith("an unknown"):
                body = answer.partition(b"\r\n\r\n")[2]
                check(name + ": one line of JSON", "error" in json.loads(body) if body else True, body[:100])
        for name, deed in sockets(server):
            page = Socket(server)
            check(name + ": the socket opens", page.status == 101, page.status)
            try:
                deed(page)
            except (ConnectionError, BrokenPipeError):
                pass
            try:
                page.listen(lambda s: s.closed is not None, 30, confirms=False)
                check(name + ": closed", True)
            except AssertionError as error:
                check(name + ": closed", False, str(error))
            except OSError:
                check(name + ": closed", True)
            page.close()

        # What lies outside of what is known is told, and the page goes on.
        page = Socket(server)
        page.send(do="size", width=64, height=48)
        page.listen(Socket.is_exact)
        page.send(do="set", name="point_size", value="-5")
        page.send(do="technique", name="nonsense")
        page.send(do="color", name="color_by", value="nonsense")
        page.listen(lambda s: len(s.says) >= 3)
        check("wrong values are told", any("point_size" in each for each in page.says), page.says)
        page.send(do="color", name="color_by", value="auto")
        page.close()

        # Lines that stall: half a request, half a socket, a page that takes nothing.
        stalled = [server.connect() for _ in range(20)]
        for line in stalled:
            line.sendall(b"GET / HTTP/1.1\r\nHost: ")
        deaf = Socket(server)
        deaf.send(do="size", width=512, height=384)
        for _ in range(30):
            deaf.send(do="grab", kind="rotate", x=1, y=1)
            deaf.send(do="drag", dx=5, dy=0)
            time.sleep(0.05)
        began = time.monotonic()
        check("others are served beside lines that stall", server.get("info")[0] == 200 and time.monotonic() - began < 20)
        stalled[0].settimeout(30)
        try:
            ended = stalled[0].recv(100)
        except OSError:
            ended = b"timeout"
        check("half a request is given up", ended in (b"",) or ended.startswith(b"HTTP/1.1 4"), ended)
        for line in stalled:
            line.close()
        deaf.close()

        pages, wrong = [], []

        def join():
            try:
                one = Socket(server)
                one.send(do="size", width=48, height=36)
                one.listen(Socket.is_exact, 240)
                pages.append(one)
            except Exception as error:  # noqa: BLE001
                wrong.append(repr(error))

        threads = [threading.Thread(target=join) for _ in range(50)]
        for each in threads:
            each.start()
        for each in threads:
            each.join()
        check("50 pages have their pictures", len(pages) == 50, wrong[:2])
        grown = server.peak() - before
        check(f"memory is bounded: {grown / 1e6:.0f} MB for all of this", grown < 600e6, grown)
        surplus = [Socket(server) for _ in range(12)]
        check("the 61st page is turned away", surplus[-1].status == 503, [each.status for each in surplus])
        for each in pages + surplus:
            each.close()
        check("the server is alive", server.get("info")[0] == 200)
        code, seconds = server.stop(signal.SIGINT)
        check(f"Ctrl-C ends it at once: {seconds:.2f} s", code == 0 and seconds < 5, (code, seconds))
        check("it said nothing", server.said() == "", server.said())

        # Failures of the start: one line, a fixed code.
        taken = subprocess.Popen([COMMAND, "serve", os.path.join(folder, "scan.ply"), "--port", "0"], stdout=subprocess.PIPE, text=True)
        port = taken.stdout.readline().split(":")[2].split("/")[0]
        for words, code, text in (([os.path.join(folder, "scan.ply"), "--port", port], 6, "--port 0"),
                                  ([os.path.join(folder, "none.ply"), "--port", "0"], 6, "none.ply"),
                                  ([os.path.join(folder, "scan.ply"), "--bind", "nowhere"], 1, "--bind"),
                                  ([os.path.join(folder, "scan.ply"), "-o", "x.png"], 1, "--output does not go with serve"),
                                  ([], 1, "name a file")):
            one = subprocess.run([COMMAND, "serve", *words], capture_output=True, text=True, timeout=60)
            check(f"serve {' '.join(words[1:])}: code {code}", one.returncode == code and text in one.stderr and one.stderr.count("\n") == 1,
                  (one.returncode, one.stderr))
        taken.send_signal(signal.SIGTERM)
        check("SIGTERM ends it", taken.wait(30) == 0)
    # Who comes later sees the technique that was chosen for the whole scan from the first word on.
    with tempfile.TemporaryDirectory() as folder:
        scan, levels = make_scan(folder, 200000), os.path.join(folder, "scan.copc.laz")
        subprocess.run([COMMAND, "build", scan, "-o", levels, "--quiet"], check=True)
        for name, words in (("a whole file", (scan,)), ("levels", (levels, "--memory", "3M"))):
            with Server(*words, "--quiet") as server:
                server.wait_ready()
                end = time.monotonic() + 60
                while not server.info()["technique"]["name"] and time.monotonic() < end:
                    time.sleep(0.1)
                page = Socket(server)
                page.send(do="size", width=64, height=48)
                page.listen(lambda s: "technique" in s.state)
                begun, chosen = page.state["technique"]["name"], server.info()["technique"]["name"]
                check(f"{name}: a page begins with the technique that was chosen", begun == chosen != "", (begun, chosen))
                page.close()
    if failures:
        sys.exit(f"{len(failures)} failed: {failures}")


main()
