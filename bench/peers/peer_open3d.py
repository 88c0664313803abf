#!/usr/bin/python3
"""Open3D peer.   usage: peer_open3d.py FILE.ply load|normals|points|views|array   prints one JSON line

load: read_point_cloud. normals: KDTreeSearchParamKNN(24), tree included. points: legacy renderer, one frame
and its read-back, 1024 x 1024, 1 px (opens a window: needs an X server). views: 30 views as arrays, in turns of a degree. array: from arrays of numpy to a PNG.
"""
import json
import resource
import statistics
import sys
import tempfile
import time

import numpy as np
import open3d

K = 24
FRAMES = 5
VIEWS = 30


def elapsed_ms(start):
    return round(1e3 * (time.perf_counter() - start), 1)


def window_of(cloud):
    window = open3d.visualization.Visualizer()
    window.create_window(width=1024, height=1024, visible=False)
    window.add_geometry(cloud)
    window.get_render_option().point_size = 1.0
    return window


def render(cloud):
    window = window_of(cloud)
    view = window.get_view_control()
    times = []
    for _ in range(FRAMES + 1):  # the first is the warm-up
        view.rotate(10, 0)
        start = time.perf_counter()
        window.poll_events()
        window.update_renderer()
        window.capture_screen_float_buffer(True)
        times.append(elapsed_ms(start))
    return statistics.median(times[1:])


def views(cloud):
    window = window_of(cloud)
    view = window.get_view_control()
    np.asarray(window.capture_screen_float_buffer(True))
    start = time.perf_counter()
    for _ in range(VIEWS):
        view.rotate(1000 / 180 / 3, 0)  # pixels of a drag
        np.asarray(window.capture_screen_float_buffer(True))
    return round(elapsed_ms(start) / VIEWS, 1)


def picture_of_arrays(cloud):
    """Both are arrays before the clock starts."""
    xyz, rgb = np.array(cloud.points), np.array(cloud.colors)
    with tempfile.TemporaryDirectory() as folder:
        start = time.perf_counter()
        made = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(xyz))
        made.colors = open3d.utility.Vector3dVector(rgb)
        window = open3d.visualization.Visualizer()
        window.create_window(width=1024, height=1024, visible=False)
        window.add_geometry(made)
        window.get_render_option().point_size = 1.0
        window.capture_screen_image(folder + '/picture.png', True)
        return elapsed_ms(start)


def main():
    path, mode = sys.argv[1:3]
    start = time.perf_counter()
    cloud = open3d.io.read_point_cloud(path)
    result = {'peer': 'open3d ' + open3d.__version__, 'mode': mode, 'n': len(cloud.points),
              'load_ms': elapsed_ms(start)}
    if mode == 'normals':
        cloud.normals = open3d.utility.Vector3dVector()
        start = time.perf_counter()
        cloud.estimate_normals(open3d.geometry.KDTreeSearchParamKNN(K))
        result['normals_ms'] = elapsed_ms(start)
    elif mode == 'points':
        result['frame_ms'] = render(cloud)
    elif mode == 'views':
        result['view_ms'] = views(cloud)
    elif mode == 'array':
        result['array_ms'] = picture_of_arrays(cloud)
    result['peak_mb'] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024
    print(json.dumps(result))


main()
