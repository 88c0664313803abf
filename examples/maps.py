#!/usr/bin/python3
"""Depth and normal maps of a scan from many poses, as machine learning wants them.   maps.py [SCAN] [OUT.npz] [POSES]

Writes an archive of numpy: rgb (poses, height, width, 3), depth (inf where nothing is), normal (world), pose (camera to world,
OpenCV) and K.
"""
import sys

import numpy as np

import sfumato

scan = sys.argv[1] if len(sys.argv) > 1 else sfumato.synth("room", points=300_000)
out = sys.argv[2] if len(sys.argv) > 2 else "maps.npz"
poses = int(sys.argv[3]) if len(sys.argv) > 3 else 100

K = np.array([[280.0, 0, 159.5], [0, 280.0, 119.5], [0, 0, 1]])
with sfumato.Renderer(scan, technique="splats") as renderer:
    start = renderer.view(size=(320, 240))
    cameras = []
    for step, camera in enumerate(sfumato.orbit(start, poses, up=(0, 0, 1))):
        nearer = 0.6 + 0.3 * np.cos(step)  # not all from one distance
        place = np.asarray(camera.target) + nearer * (np.asarray(camera.position) - camera.target)
        pose = camera.replace(position=tuple(place)).pose("opencv")
        cameras.append(sfumato.Camera.from_pose(pose, K, (320, 240)))
    maps = {"rgb": [], "depth": [], "normal": []}
    for picture in renderer.frames(cameras, outputs=("rgba", "depth", "normal")):
        maps["rgb"].append(picture.rgba[..., :3])
        maps["depth"].append(picture.depth)
        maps["normal"].append(picture.normal)
np.savez(out, pose=np.stack([camera.pose() for camera in cameras]), K=K, **{name: np.stack(each) for name, each in maps.items()})
print(f"{out}: {poses} poses, depths from {min(d.min() for d in maps['depth']):.2f}")
