"""fetched.py SFUMATO POINTS OPTION...: share of a COPC file that a picture of it over HTTP fetches."""
import http.server
import json
import os
import re
import subprocess
import sys
import tempfile
import threading


class Ranges(http.server.BaseHTTPRequestHandler):
    protocol_version = 'HTTP/1.1'

    def log_message(self, *_):
        pass

    def do_GET(self):
        first, last = map(int, re.fullmatch(r'bytes=(\d+)-(\d+)', self.headers['Range']).groups())
        with open(self.server.file, 'rb') as file:
            file.seek(first)
            part = file.read(last + 1 - first)
        self.server.fetched += len(part)
        self.send_response(206)
        self.send_header('Content-Length', str(len(part)))
        self.send_header('Content-Range', f'bytes {first}-{first + len(part) - 1}/{self.server.size}')
        self.end_headers()
        self.wfile.write(part)


def main():
    sfumato, points, *options = sys.argv[1:]
    with tempfile.TemporaryDirectory() as folder:
        server = http.server.ThreadingHTTPServer(('127.0.0.1', 0), Ranges)
        server.file = os.path.join(folder, 'cloud.copc.laz')
        cloud = os.path.join(folder, 'cloud.las')
        subprocess.run([sfumato, 'synth', 'courtyard', '--points', points, '-o', cloud, '--quiet'], check=True)
        subprocess.run([sfumato, 'build', cloud, '-o', server.file, '--quiet'], check=True)
        server.size, server.fetched = os.path.getsize(server.file), 0
        threading.Thread(target=server.serve_forever, daemon=True).start()
        subprocess.run([sfumato, f'http://127.0.0.1:{server.server_port}/cloud.copc.laz', '-o', os.path.join(folder, 'out.png'),
                        '-t', 'points', '--resolution', '640x360', '--quiet', *options], check=True, env={**os.environ, 'no_proxy': '*'})
        print(json.dumps({'share': 100 * server.fetched / server.size, 'bytes': server.fetched}))


if __name__ == '__main__':
    main()
