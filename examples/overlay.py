#!/usr/bin/python3
"""A scan over a photograph, through the camera that took it.   overlay.py [SCAN CAMERA.json PHOTO.png] [OUT.png]

CAMERA.json holds what OpenCV's calibration and solvePnP give: {"K": 3x3, "R": 3x3 or rotation vector, "t": [3]}; the photograph
is undistorted. Without arguments, a synthetic photograph is made first.
"""
import json
import sys

import matplotlib.image
import numpy as np

import sfumato

if len(sys.argv) > 3:
    cloud = sfumato.read(sys.argv[1])
    with open(sys.argv[2], encoding="utf-8") as file:
        known = json.load(file)
    photo = np.asarray(matplotlib.image.imread(sys.argv[3]))[..., :3]
    photo = photo / 255 if photo.dtype == np.uint8 else photo
else:
    cloud = sfumato.synth("courtyard", points=200_000)
    camera = sfumato.Camera.look_at((17, -22, 9), (0, 0, 3), fov=40, size=(640, 480))
    to_camera = np.linalg.inv(camera.pose("opencv"))
    known = {"K": camera.matrix("opencv"), "R": to_camera[:3, :3], "t": to_camera[:3, 3]}
    photo = sfumato.render(cloud, technique="splats", camera=camera, shadows="soft", background="skyblue").rgba[..., :3] / 255

height, width = photo.shape[:2]
camera = sfumato.Camera.from_opencv(known["K"], known["R"], known["t"], (width, height))
scan = sfumato.render(cloud, technique="points", camera=camera, background="transparent", color_by="elevation", colormap="turbo")
share = 0.5 * scan.alpha[..., None]
blend = (1 - share) * photo + share * scan.rgba[..., :3] / 255
matplotlib.image.imsave(sys.argv[-1] if len(sys.argv) in (2, 5) else "overlay.png", np.clip(blend, 0, 1))
