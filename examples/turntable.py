#!/usr/bin/python3
"""A scan turned once around.   turntable.py [SCAN] [OUT.mp4|FOLDER] [FRAMES]

A name with an extension becomes a video, which needs ffmpeg; a folder gets a picture for each frame.
"""
import os
import sys

import sfumato

scan = sys.argv[1] if len(sys.argv) > 1 else sfumato.synth("tori", points=200_000)
out = sys.argv[2] if len(sys.argv) > 2 else "turntable"
frames = int(sys.argv[3]) if len(sys.argv) > 3 else 60

with sfumato.Renderer(scan, shadows="soft") as renderer:
    cameras = renderer.orbit(frames, size=(640, 480))
    if os.path.splitext(out)[1]:
        renderer.video(out, cameras, fps=30)
    else:
        os.makedirs(out, exist_ok=True)
        for number, picture in enumerate(renderer.frames(cameras)):
            picture.save(os.path.join(out, f"frame_{number:04}.png"))
print(f"{out}: {frames} frames")
