#!/usr/bin/python3
"""Depth frames of several views, put together without preprocessing, against depth frames that were held out.

usage: multi_view.py FOLDER [SFUMATO] [--frames 5,10,20] [--step 10] [--held-out 150,450,750] [--keep FOLDER]

FOLDER holds frame-NNNNNN.depth.png (16 bit, mm; 0 and 65535: not measured), .color.jpg or .png, .pose.txt (4x4, camera to world)
and camera-intrinsics.txt (3x3), as data/ of github.com/andyzeng/tsdf-fusion-python (1000 frames of 7-Scenes; not for commercial
use, so no picture of them is part of the project). For each held-out frame the frames STEP, -STEP, 2 STEP ... away are put together,
every second pixel of each, and drawn at 1280x720 from its camera. Pixels count that have no depth edge and no hole within three
pixels. Prints a table, means over the held-out frames: median and mean difference of depth where something is drawn, share with
nothing drawn, shares more than 5 cm in front of and behind the held-out depth. First row: the frame after each held-out one, moved
to its camera, which is the noise of the sensor alone. --keep keeps clouds and pictures. Needs Debian's python3-numpy and python3-pil.
"""
import argparse
import glob
import json
import os
import re
import subprocess
import tempfile

import numpy as np
from PIL import Image

WIDTH, HEIGHT, OUTLIER_M, EDGE, REACH = 1280, 720, 0.05, 0.05, 3
WAYS = {'`points`': ['points'], '`splats`': ['splats'], '`denoise`': ['denoise'],
        **{f'T = {t}': ['denoise', '--weight-threshold', t] for t in ('0.1', '0.5', '1')},
        'T = 1, Delta = 5 cm (as in the paper)': ['denoise', '--weight-threshold', '1', '--bin-size', '0.05'],
        '`denoise`, Delta = 5 cm': ['denoise', '--bin-size', '0.05']}


class Frames:
    def __init__(self, folder):
        self.folder, self.k = folder, np.loadtxt(os.path.join(folder, 'camera-intrinsics.txt'))

    def path(self, number, what):
        return next(iter(glob.glob(os.path.join(self.folder, f'frame-{number:06}.{what}.*'))), None)

    def pose(self, number):
        return np.loadtxt(self.path(number, 'pose'))

    def depth(self, number):
        depth = np.asarray(Image.open(self.path(number, 'depth'))).astype(float)
        return np.where((depth > 0) & (depth < 65535), depth / 1000, np.nan)

    def rays(self, shape):
        v, u = np.indices(shape)
        return np.stack([(u - self.k[0, 2]) / self.k[0, 0], (v - self.k[1, 2]) / self.k[1, 1], np.ones(shape)], -1)

    def points(self, number, every=2):
        """World positions and colours of the measured pixels, of two as on a chessboard."""
        depth, pose = self.depth(number), self.pose(number)
        kept = np.isfinite(depth) & (np.indices(depth.shape).sum(0) % every == 0)
        colour = np.asarray(Image.open(self.path(number, 'color')).convert('RGB').resize(depth.shape[::-1]))
        return (self.rays(depth.shape) * depth[..., None])[kept] @ pose[:3, :3].T + pose[:3, 3], colour[kept]


def write_ply(path, points, colours):
    rows = np.empty(len(points), [('xyz', '<f4', 3), ('rgb', 'u1', 3)])
    rows['xyz'], rows['rgb'] = points, colours
    names = [f'float {c}' for c in 'xyz'] + [f'uchar {c}' for c in ('red', 'green', 'blue')]
    head = f'ply\nformat binary_little_endian 1.0\nelement vertex {len(rows)}\nproperty ' + '\nproperty '.join(names) + '\nend_header\n'
    with open(path, 'wb') as file:
        file.write(head.encode() + rows.tobytes())


def interior(depth):
    """Pixels without an edge or a hole within REACH."""
    low = high = np.pad(depth, REACH, constant_values=np.nan)
    for axis in (0, 1):  # nan where any is
        low, high = (reduce([np.roll(a, s, axis) for s in range(-REACH, REACH + 1)], 0) for reduce, a in ((np.min, low), (np.max, high)))
    return (high - low)[REACH:-REACH, REACH:-REACH] < EDGE * depth


def next_frame(frames, number):
    """Depth of the frame after this one at the pixels of this one, infinite where it has none."""
    depth, pose = np.full(frames.depth(number).shape, np.inf), frames.pose(number)
    local = (frames.points(number + 1, 1)[0] - pose[:3, 3]) @ pose[:3, :3]
    u, v = (np.rint(local[:, a] / local[:, 2] * frames.k[a, a] + frames.k[a, 2]).astype(int) for a in (0, 1))
    inside = (u >= 0) & (u < depth.shape[1]) & (v >= 0) & (v < depth.shape[0])
    np.minimum.at(depth, (v[inside], u[inside]), local[inside, 2])
    return depth


def draw(sfumato, frames, number, cloud, options, name):
    """Depth of a picture at the pixels of the held-out frame."""
    pose, rays = frames.pose(number), frames.rays(frames.depth(number).shape)
    tangent = 1.01 * max(np.abs(rays[..., 1]).max(), np.abs(rays[..., 0]).max() * HEIGHT / WIDTH)
    with open(name + '.json', 'w', encoding='ascii') as file:
        json.dump({'position': pose[:3, 3].tolist(), 'target': (pose[:3, 3] + pose[:3, 2]).tolist(), 'up': (-pose[:3, 1]).tolist(),
                   'fov_y_deg': float(np.degrees(2 * np.arctan(tangent))), 'width': WIDTH, 'height': HEIGHT}, file)
    subprocess.run([sfumato, cloud, '-t', *options, '--camera', name + '.json', '--resolution', f'{WIDTH}x{HEIGHT}', '-o', name + '.png',
                    '--output-depth', name + '.npy', '--quiet'], check=True)
    x, y = (np.floor(rays[..., a] * HEIGHT / 2 / tangent + size / 2).astype(int) for a, size in ((0, WIDTH), (1, HEIGHT)))
    return np.load(name + '.npy')[y, x]


def score(drawn, held_out):
    difference = (drawn - held_out)[interior(held_out)]
    there = np.isfinite(difference)
    wrong = 1000 * np.abs(difference[there])
    return [np.median(wrong), wrong.mean()] + [100 * p.mean() for p in (~there, difference < -OUTLIER_M, there & (difference > OUTLIER_M))]


def show(count, points, way, scores):
    median, mean, missing, front, behind = np.mean(scores, 0)
    print(f'| {count} | {points} | {way} | {median:.1f} | {mean:.1f} | {missing:.2f} | {front:.2f} | {behind:.2f} |', flush=True)


def main():
    parser = argparse.ArgumentParser(usage=__doc__.split('usage: ')[1])
    parser.add_argument('folder')
    parser.add_argument('sfumato', nargs='?', default='build/release/bin/sfumato')
    for name, default in (('--frames', '5,10,20'), ('--step', '10'), ('--held-out', '150,450,750'), ('--keep', '')):
        parser.add_argument(name, default=default)
    options = parser.parse_args()
    frames, held_out, step = Frames(options.folder), [int(n) for n in options.held_out.split(',')], int(options.step)
    print('| frames | points | drawn | median, mm | mean, mm | missing, % | 5 cm in front, % | 5 cm behind, % |\n' + 8 * '|---' + '|')
    after = [score(next_frame(frames, n), frames.depth(n)) for n in held_out if frames.path(n + 1, 'depth')]
    if after:
        show(1, '', 'the next frame', after)
    with tempfile.TemporaryDirectory() as scratch:
        os.makedirs(options.keep or scratch, exist_ok=True)
        for count in map(int, options.frames.split(',')):
            scores, total = {way: [] for way in WAYS}, 0
            for number in held_out:
                places = (number + step * (i // 2 + 1) * (1 - 2 * (i % 2)) for i in range(10 * count))
                chosen = [place for place in places if frames.path(place, 'depth') and place not in held_out][:count]
                if len(chosen) < count:
                    raise SystemExit(f'{options.folder}: {len(chosen)} frames around {number}, {count} are wanted')
                points, colours = map(np.concatenate, zip(*map(frames.points, chosen)))
                name = os.path.join(options.keep or scratch, f'{number}_{count}')
                write_ply(name + '.ply', points, colours)
                total += len(points)
                for i, (way, words) in enumerate(WAYS.items()):
                    drawn = draw(options.sfumato, frames, number, name + '.ply', words, f'{name}_{i}')
                    scores[way].append(score(drawn, frames.depth(number)))
            for way, rows in scores.items():
                show(count, f'{total // len(held_out):,}', way, rows)


if __name__ == '__main__':
    main()
