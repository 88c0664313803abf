#!/usr/bin/python3
"""Ours, as peer_open3d.py does it.   usage: python_sfumato.py FILE.ply array|frames|views   prints one JSON line

array: from arrays (float64 and colours, as both libraries give them) to a PNG, everything but reading them included. frames: one
picture of many, 1024 x 1024, as an array. views: 30 views as arrays, in turns of a degree.
"""
import json
import statistics
import sys
import time

import numpy as np

import sfumato

FRAMES = 10
VIEWS = 30


def elapsed_ms(start):
    return round(1e3 * (time.perf_counter() - start), 1)


def main():
    path, mode, out = sys.argv[1:4]
    cloud = sfumato.read(path)
    xyz, rgb = cloud.xyz, cloud.colors[:, :3] / 255
    result = {'peer': 'sfumato ' + sfumato.__version__, 'mode': mode, 'n': len(xyz)}
    # The look of the peer: closest points of one pixel, unlit.
    plain = dict(technique='points', point_size=1, size_mode='pixels', shading='albedo', edl=False, smooth_outlines=False)
    start = time.perf_counter()
    if mode == 'array':
        sfumato.render(xyz, rgb, size=(1024, 1024), **plain).save(out)
        result['array_ms'] = elapsed_ms(start)
    elif mode == 'views':
        renderer = sfumato.Renderer(xyz, rgb, **plain)
        cameras = renderer.orbit(VIEWS + 1, degrees=VIEWS + 1, size=(1024, 1024))
        renderer.render(cameras[0], outputs='rgba')
        start = time.perf_counter()
        for camera in cameras[1:]:
            np.asarray(renderer.render(camera, outputs='rgba').rgba)
        result['view_ms'] = round(elapsed_ms(start) / VIEWS, 1)
    else:
        renderer = sfumato.Renderer(xyz, rgb, **plain)
        times = []
        for camera in renderer.orbit(FRAMES + 1, degrees=100, size=(1024, 1024)):
            start = time.perf_counter()
            np.asarray(renderer.render(camera, outputs='rgba').rgba)
            times.append(elapsed_ms(start))
        result['frame_ms'] = statistics.median(times[1:])
    print(json.dumps(result))


main()
