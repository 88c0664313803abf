"""examples/serve/nginx.conf: the page, its pictures and its socket through TLS."""
import os
import shutil
import ssl
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.dirname(__file__))
from server import Server, Socket, check, failures, free_port, make_scan  # noqa: E402

EXAMPLE = os.path.join(os.path.dirname(__file__), "../../examples/serve/nginx.conf")


class Behind:
    """The proxy as the server that a socket connects to."""

    def __init__(self, server, port):
        self.host, self.port, self.token = "scan.example", port, server.token

    def connect(self):
        import socket

        plain = socket.create_connection(("127.0.0.1", self.port), timeout=60)
        trusting = ssl._create_unverified_context()  # the certificate is made here
        return trusting.wrap_socket(plain, server_hostname=self.host)

    def get(self, path, host=None):
        line = self.connect()
        line.sendall(f"GET /{self.token}/{path} HTTP/1.1\r\nHost: {host or f'{self.host}:{self.port}'}\r\nConnection: close\r\n\r\n".encode())
        answer = b""
        while more := line.recv(65536):
            answer += more
        return int(answer.split()[1])


def main():
    lacks = [program for program in ("nginx", "openssl") if not shutil.which(program)]
    if lacks:
        print(f"SKIPPED: there is no {' and no '.join(lacks)} (apt-get install {' '.join(lacks)})")
        return
    with tempfile.TemporaryDirectory() as folder, \
            Server(make_scan(folder), "-t", "points", "--host", "scan.example", "--quiet") as server:
        server.wait_ready()
        subprocess.run(["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-keyout", f"{folder}/key.pem", "-out", f"{folder}/cert.pem",
                        "-subj", "/CN=scan.example", "-days", "2"], check=True, capture_output=True)
        with open(EXAMPLE, encoding="utf-8") as example, open(f"{folder}/sfumato.conf", "w", encoding="utf-8") as out:
            text = example.read()
            check("the example names the default port", "127.0.0.1:8080" in text)
            out.write(text.replace("127.0.0.1:8080", f"127.0.0.1:{server.port}"))
        port = free_port()
        temporary = "".join(f"{kind}_temp_path {folder}/{kind}; " for kind in ("client_body", "proxy", "fastcgi", "uwsgi", "scgi"))
        with open(f"{folder}/nginx.conf", "w", encoding="utf-8") as out:
            out.write(f"""daemon off; pid {folder}/pid; error_log {folder}/errors;
events {{}}
http {{ access_log off; {temporary}
  server {{ listen 127.0.0.1:{port} ssl; ssl_certificate {folder}/cert.pem; ssl_certificate_key {folder}/key.pem;
    include {folder}/sfumato.conf; }} }}
""")
        proxy = subprocess.Popen(["nginx", "-p", folder, "-e", f"{folder}/errors", "-c", f"{folder}/nginx.conf"], stderr=subprocess.PIPE)
        try:
            behind = Behind(server, port)
            for _ in range(100):
                try:
                    behind.connect().close()
                    break
                except OSError:
                    time.sleep(0.1)
            check("the page comes through TLS", behind.get("") == 200)
            check("pictures come through TLS", behind.get("render?technique=points&resolution=64x48") == 200)
            check("a name that was not given is refused", behind.get("", "evil.example") == 421)
            page = Socket(behind, headers=[f"Origin: https://scan.example:{port}"])
            check("the socket opens", page.status == 101, page.status)
            page.send(do="size", width=64, height=48)
            page.listen(Socket.is_exact)
            check("its pictures come", page.is_exact())
            page.close()
            check("another origin is refused", Socket(behind, headers=["Origin: https://evil.example"]).status == 403)
        finally:
            proxy.terminate()
            proxy.communicate(timeout=20)
    if failures:
        sys.exit(f"{len(failures)} failed: {failures}")


main()
