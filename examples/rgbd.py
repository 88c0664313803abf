#!/usr/bin/python3
"""Frames of a depth camera put together, and their noise and strays removed while rendering.   rgbd.py [OUT.png] [FRAMES...]

Each frame is a file that `sfumato.read` takes (PCD, PLY, or a depth image with its camera beside it); without any, a room is
scanned by simulated cameras with the noise of structured light.
"""
import sys

import sfumato

out = sys.argv[1] if len(sys.argv) > 1 else "rgbd.png"
frames = sys.argv[2:]
cloud = sfumato.read(frames) if frames else sfumato.synth("room", points=400_000, noise="structured_light", flying_pixels=0.3)
with sfumato.Renderer(cloud, technique="denoise") as renderer:
    picture = renderer.render(size=(1280, 720))
    picture.save(out)
print(f"{out}: {len(cloud):,} points", *picture.notes, sep="\n")
