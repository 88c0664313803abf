"""ParaView's remote rendering in motion: a pvserver, and a client of pvpython that turns the view and gets every picture.

usage: /usr/bin/python3 peer_pvserver.py CLOUD [--line MS,MBIT]            (within xvfb-run)

As bench/serve_motion.py does it with sfumato serve: 1280x720, some seconds of motion, then single turns at rest. Prints as JSON
pictures_a_second, kb_a_second, photon_ms (median of a turn until its picture is with the client) and converge_ms (the full picture
after a motion). Settings are ParaView's own, but everything is rendered on the server; points are GL points of 2 px.
"""
import json
import os
import re
import socket
import statistics
import subprocess
import sys
import tempfile
import time

MOTION_S, SINGLE, LONGEST_S, SIZE = 8, 12, 40, (1280, 720)


def client(cloud, port):
    """Runs in pvpython."""
    from paraview import simple
    simple.Connect('127.0.0.1', port)
    points = simple.MaskPoints(simple.PLYReader(FileNames=[cloud]), OnRatio=1, MaximumNumberofPoints=2**31 - 1, GenerateVertices=1)
    view = simple.CreateView('RenderView')
    view.ViewSize, view.RemoteRenderThreshold = SIZE, 0
    shown = simple.Show(points, view)
    shown.PointSize = 2
    simple.ResetCamera(view)
    proxy = view.SMProxy
    camera = simple.GetActiveCamera()

    def turn(still):
        camera.Azimuth(1.0)
        proxy.StillRender() if still else proxy.InteractiveRender()

    proxy.StillRender()
    end = time.monotonic() + 1
    while time.monotonic() < end:
        turn(False)
    print('begin', flush=True)
    os.read(0, 1)  # its sys.stdin reads words
    began, count = time.monotonic(), 0
    while time.monotonic() < began + MOTION_S:
        turn(False)
        count += 1
    took = time.monotonic() - began
    print('end', count, took, flush=True)
    os.read(0, 1)  # its sys.stdin reads words
    began = time.monotonic()
    proxy.StillRender()
    converge, waits, singles = time.monotonic() - began, [], time.monotonic()
    for _ in range(SINGLE):
        time.sleep(0.3)
        began = time.monotonic()
        turn(False)
        waits.append(time.monotonic() - began)
        proxy.StillRender()
        if time.monotonic() > singles + LONGEST_S:
            break
    if not proxy.GetClientSideObject().GetUseDistributedRenderingForRender():
        sys.exit('the client rendered, not the server')
    print('done', json.dumps({'photon_ms': round(1000 * statistics.median(waits)), 'converge_ms': round(1000 * converge),
                              'peer': 'ParaView ' + str(simple.GetParaViewSourceVersion()).split()[-1]}), flush=True)


def carried(port):
    """Bytes that the server's end of the connection has sent."""
    said = subprocess.run(['ss', '-tinH', 'sport', '=', f':{port}'], capture_output=True, text=True, check=False).stdout
    return sum(int(number) for number in re.findall(r'bytes_sent:(\d+)', said))


def free_port():
    with socket.socket() as end:
        end.bind(('127.0.0.1', 0))
        return end.getsockname()[1]


def main():
    cloud, words = os.path.abspath(sys.argv[1]), sys.argv[2:]
    port = free_port()
    scratch = tempfile.TemporaryDirectory()
    environment = {**os.environ, 'HOME': scratch.name}
    server = subprocess.Popen(['pvserver', f'--server-port={port}'], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              env=environment)
    other = None
    try:
        for line in server.stdout:
            if 'Accepting connection' in line:
                break
        near = port
        if words[:1] == ['--line']:
            sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))
            from line import Line, listen
            near = listen(Line(*[float(number) for number in words[1].split(',')]), lambda: socket.create_connection(('127.0.0.1', port)))
        other = subprocess.Popen(['pvpython', os.path.abspath(__file__), 'client', cloud, str(near)], stdin=subprocess.PIPE,
                                 stdout=subprocess.PIPE, text=True, env=environment)
        result = {}
        for line in other.stdout:
            word, _, rest = line.strip().partition(' ')
            if word == 'begin':
                before = carried(port)
                other.stdin.write('\n')
                other.stdin.flush()
            elif word == 'end':
                count, took = rest.split()
                result['pictures_a_second'] = round(int(count) / float(took), 1)
                result['kb_a_second'] = round((carried(port) - before) / float(took) / 1000)
                other.stdin.write('\n')
                other.stdin.flush()
            elif word == 'done':
                result.update(json.loads(rest))
        other.wait(30)
        print(json.dumps(result))
    finally:
        for process in (other, server):
            if process and process.poll() is None:
                process.terminate()
                process.wait(30)


if __name__ == '__main__':
    if sys.argv[1] == 'client':
        client(sys.argv[2], int(sys.argv[3]))
    else:
        main()
