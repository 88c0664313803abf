"""Files by http:// and packed files, through the command: what is fetched, and servers that misbehave."""
import gzip
import http.server
import os
import re
import shutil
import signal
import ssl
import subprocess
import sys
import tempfile
import threading
import time
import zipfile

sys.path.insert(0, os.path.dirname(__file__))
from server import COMMAND, check, failures  # noqa: E402


class Server(http.server.ThreadingHTTPServer):
    """Files of a folder with ranges; the first word of a path says how it misbehaves."""
    daemon_threads = True
    fetched = 0
    hits = {}
    parts = []

    def handle_error(self, *_):  # of clients that hang up
        pass


class Handler(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"

    def log_message(self, *_):
        pass

    def do_GET(self):
        _, manner, name = self.path.split("?")[0].split("/", 2)
        self.server.hits[manner] = hits = self.server.hits.get(manner, 0) + 1
        if manner == "redirect":
            return self.answer(302, b"", {"Location": "/plain/" + name})
        if manner == "loop":
            return self.answer(302, b"", {"Location": self.path})
        if manner == "elsewhere":
            return self.answer(302, b"", {"Location": "file:///etc/passwd"})
        if manner == "busy":  # twice for each part
            part = self.headers.get("Range", "")
            self.server.hits[part] = self.server.hits.get(part, 0) + 1
            if self.server.hits[part] <= 2:
                return self.answer(503, b"wait")
        if manner == "refuses":
            return self.answer(503, b"")
        if manner == "downgrade":
            return self.answer(302, b"", {"Location": "http://127.0.0.1:1/"})
        if manner == "stall":
            time.sleep(30)
        try:
            with open(os.path.join(self.server.folder, name), "rb") as file:
                data = file.read()
        except OSError:
            return self.answer(404, b"<html>no</html>")
        asked = re.fullmatch(r"bytes=(\d+)-(\d+)", self.headers.get("Range", ""))
        if not asked or manner == "whole":
            return self.answer(200, data)
        first, last = int(asked[1]), min(int(asked[2]), len(data) - 1)
        if first >= len(data):
            return self.answer(416, b"")
        total = len(data) + (1 << 20 if manner == "larger" else 0) + (hits if manner == "changes" else 0)
        part = data[first:last + 1]
        self.server.parts.append((first, last + 1))
        headers = {"Content-Range": f"bytes {first}-{last}/{total}"}
        if manner == "cut":
            headers["Content-Length"] = str(len(part))
            self.answer(206, part[:len(part) // 2], headers)
            self.close_connection = True
            return None
        if manner == "longer":
            part += b"more"
        if manner == "silent_size":
            headers = {}
        return self.answer(206, part, headers)

    def answer(self, status, body, headers=()):
        self.send_response(status)
        for name, value in {"Content-Length": str(len(body)), **dict(headers)}.items():
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(body)
        self.server.fetched += len(body)


def command(*words, **environment):
    began = time.monotonic()
    own = {name: value for name, value in os.environ.items() if name not in ("CURL_CA_BUNDLE", "SSL_CERT_FILE")}
    done = subprocess.run([COMMAND, *words], capture_output=True, text=True,
                          env={**own, "SFUMATO_HTTP_TIMEOUT": "2", "no_proxy": "*", **environment})
    done.seconds = time.monotonic() - began
    return done


def certificate(folder, name):
    """A certificate of a server on this machine that nobody signed."""
    files = [os.path.join(folder, name + ending) for ending in (".crt", ".key")]
    subprocess.run(["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj", "/CN=localhost", "-addext",
                    "subjectAltName=IP:127.0.0.1", "-out", files[0], "-keyout", files[1]], check=True, capture_output=True)
    return files


def start(folder, secured_by=None):
    server = Server(("127.0.0.1", 0), Handler)
    server.folder = folder
    if secured_by:
        context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        context.load_cert_chain(*secured_by)
        server.socket = context.wrap_socket(server.socket, server_side=True, do_handshake_on_connect=False)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    return server


def try_https(folder):
    if not shutil.which("openssl"):
        print("openssl is not here: https is not tried")
        return
    ours, others = certificate(folder, "ours"), certificate(folder, "others")
    server = start(folder, ours)
    address = f"https://127.0.0.1:{server.server_port}/plain/small.laz"
    local = command("info", os.path.join(folder, "small.laz"))
    for name in ("SSL_CERT_FILE", "CURL_CA_BUNDLE"):
        done = command("info", address, **{name: ours[0]})
        check(f"https, certificate in {name}", done.returncode == 0 and done.stdout.splitlines()[1:] == local.stdout.splitlines()[1:], done)
    for what, trusted in (("unknown", others[0]), ("absent", os.path.join(folder, "absent.crt"))):
        done = command("info", address, SSL_CERT_FILE=trusted)
        check(f"https, certificate {what}: one line", done.returncode == 6 and "certificate" in done.stderr and "SSL_CERT_FILE" in done.stderr
              and done.stderr.count("\n") == 1, done)
    bare = start(folder)
    done = command("info", f"https://127.0.0.1:{bare.server_port}/plain/small.laz", SSL_CERT_FILE=ours[0])
    check("https of a server without it: one line", done.returncode == 6 and done.stderr.count("\n") == 1, done)
    done = command("info", address.replace("plain", "downgrade"), SSL_CERT_FILE=ours[0])
    check("https is not led to http", done.returncode == 6 and "rotocol" in done.stderr and done.stderr.count("\n") == 1, done)
    server.shutdown(), bare.shutdown()


def try_interrupt(url):
    for what, words in (("a stalled fetch", ["info", url("stall", "small.laz")]), ("a wait before the next try", ["info", url("refuses", "small.laz")]),
                        ("a stalled view", [url("stall", "small.laz"), "-o", "never.png", "-t", "points"])):
        began = subprocess.Popen([COMMAND, *words], stderr=subprocess.PIPE, text=True,
                                 env={**os.environ, "SFUMATO_HTTP_TIMEOUT": "15", "no_proxy": "*"})
        time.sleep(1.2)
        began.send_signal(signal.SIGINT)
        asked = time.monotonic()
        said = began.communicate()[1]
        late = time.monotonic() - asked
        check(f"Ctrl-C in {what}: {late:.2f} s", began.returncode == 130 and said == "sfumato: interrupted\n" and late < 10, (said, late))


def pictures_agree(folder, one, other, *words):
    names = [os.path.join(folder, "a.png"), os.path.join(folder, "b.png")]
    pixels = []
    for source, name in zip((one, other), names):
        done = command(source, "-o", name, "-t", "points", "--resolution", "160x120", *words)
        if done.returncode != 0:
            return False, done
        with open(name, "rb") as file:
            data = file.read()
        pixels.append(data[data.index(b"IDAT"):])  # not the command
    return pixels[0] == pixels[1], ""


def main():
    with tempfile.TemporaryDirectory() as folder:
        at = lambda name: os.path.join(folder, name)  # noqa: E731
        for words in (["synth", "courtyard", "--points", "400k", "-o", at("scan.ply")], ["build", at("scan.ply"), "-o", at("scan.copc.laz")],
                      ["synth", "courtyard", "--points", "2M", "-o", at("large.laz")], ["build", at("large.laz"), "-o", at("large.copc.laz")],
                      ["convert", at("scan.ply"), "--max-points", "60k", "-o", at("small.laz")],
                      ["convert", at("small.laz"), "-o", at("small.las")], ["convert", at("small.laz"), "-o", at("small.txt")]):
            done = command(*words)
            check(" ".join(words[:2]), done.returncode == 0, done)

        # Packed.
        for name in ("small.txt", "small.las", "scan.ply"):
            with open(at(name), "rb") as file, gzip.open(at(name + ".gz"), "wb") as packed:
                packed.write(file.read())
            check(name + ".gz is the same picture", *pictures_agree(folder, at(name), at(name + ".gz")))
        with zipfile.ZipFile(at("one.zip"), "w", zipfile.ZIP_DEFLATED) as packed:
            packed.write(at("small.las"), "data/small.las")
            packed.writestr("readme.md", "a scan")
        check("a .las in a zip is the same picture", *pictures_agree(folder, at("small.las"), at("one.zip")))
        with zipfile.ZipFile(at("two.zip"), "w") as packed:
            packed.write(at("small.las"), "a.las"), packed.write(at("small.laz"), "b.laz")
        done = command("info", at("two.zip"))
        check("two clouds in a zip are named", done.returncode == 2 and "a.las, b.laz" in done.stderr, done)
        with zipfile.ZipFile(at("none.zip"), "w") as packed:
            packed.writestr("readme.md", "nothing here" * 9)
        done = command("info", at("none.zip"))
        check("a zip without a cloud says so", done.returncode == 2 and "no point cloud" in done.stderr, done)
        with open(at("small.txt.gz"), "rb") as file:
            data = file.read()
        with open(at("cut.txt.gz"), "wb") as file:
            file.write(data[:len(data) // 2])
        done = command("info", at("cut.txt.gz"))
        check("a cut gzip says so", done.returncode == 2 and "ends in its middle" in done.stderr and done.stderr.count("\n") == 1, done)
        with open(at("bad.txt.gz"), "wb") as file:
            file.write(data[:5000] + b"\0" * 2000 + data[7000:])
        done = command("info", at("bad.txt.gz"))
        check("a damaged gzip says so", done.returncode == 2 and "gzip stream" in done.stderr and done.stderr.count("\n") == 1, done)

        # At a server.
        server = start(folder)
        url = lambda manner, name: f"http://127.0.0.1:{server.server_port}/{manner}/{name}"  # noqa: E731
        for manner in ("plain", "redirect", "whole", "busy"):
            check(manner + ": the same picture", *pictures_agree(folder, at("small.laz"), url(manner, "small.laz")))
        check("other formats and a query", *pictures_agree(folder, at("scan.ply"), url("plain", "scan.ply.gz?token=a*b")))
        size = os.path.getsize(at("scan.copc.laz"))
        server.fetched = 0
        done = command(url("plain", "scan.copc.laz"), "-o", at("c.png"), "--resolution", "64x48", "-t", "points", "--max-points", "3000")
        check(f"a COPC for a small view: {server.fetched} of {size} bytes", done.returncode == 0 and server.fetched < size / 3, done)

        # Of a larger one, through a long lens: only nodes that the view crosses, each once, and the sample (1/30 of the points).
        size = os.path.getsize(at("large.copc.laz"))
        server.fetched, server.parts = 0, []
        done = command(url("plain", "large.copc.laz"), "-o", at("c.png"), "--resolution", "160x120", "-t", "points", "--zoom", "40")
        check(f"a COPC through a long lens: {server.fetched} of {size} bytes", done.returncode == 0 and server.fetched < .26 * size, done)
        # Little reads fetch blocks of 16 KB, whose ends may lie in larger parts.
        overlap = lambda parts: sum(max(0, one[1] - next[0]) for one, next in zip(parts, parts[1:]))  # noqa: E731
        parts = sorted(server.parts)
        large = [part for part in parts if part[1] - part[0] > 1 << 14]
        check(f"nothing is fetched twice: {overlap(parts)} bytes", overlap(large) == 0 and overlap(parts) < .02 * server.fetched, parts)

        for manner, said in (("cut", "cuts the connection off"), ("stall", "silent for 2 s"), ("larger", "server"), ("changes", "changed at the server"),
                             ("longer", "more than"), ("silent_size", "how large"), ("loop", "redirects"), ("elsewhere", "rotocol")):
            done = command("info", url(manner, "small.txt" if manner in ("larger", "changes") else "small.laz"))
            check(f"{manner}: one line", done.returncode in (2, 6) and said in done.stderr and done.stderr.count("\n") == 1, done)
            check(f"{manner}: in time", done.seconds < 20, done.seconds)
        done = command("info", url("plain", "none.laz"))
        check("404: one line", done.returncode == 6 and "404" in done.stderr and done.stderr.count("\n") == 1, done)
        done = command("info", "http://127.0.0.1:1/x.laz")
        check("nobody there: one line", done.returncode == 6 and done.stderr.count("\n") == 1, done)
        try_interrupt(url)
        server.shutdown()
        try_https(folder)
    print(f"{len(failures)} failures")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
