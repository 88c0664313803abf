#!/usr/bin/python3
"""One scan by four techniques, with its depth, in one figure of matplotlib.   panels.py [SCAN] [OUT.png|pdf]"""
import sys

import matplotlib

matplotlib.use("Agg")  # no display
import matplotlib.pyplot as plt
import numpy as np

import sfumato

scan = sys.argv[1] if len(sys.argv) > 1 else sfumato.synth("courtyard", points=200_000, outliers=500)
out = sys.argv[2] if len(sys.argv) > 2 else "panels.png"

figure, axes = plt.subplots(2, 3, figsize=(12, 6), layout="constrained")
with sfumato.Renderer(scan) as renderer:
    camera = renderer.view(zoom=1.2, size=(480, 320))
    for axis, technique in zip(axes.flat, ("points", "surface", "soft", "denoise")):
        axis.imshow(renderer.render(camera, technique=technique, outputs="rgba"))
        axis.set_title(technique)
    picture = renderer.render(camera, technique="splats")
depth = np.where(np.isfinite(picture.depth), picture.depth, np.nan)
shown = axes[1, 1].imshow(depth, cmap="viridis")
axes[1, 1].set_title("depth, scene units")
figure.colorbar(shown, ax=axes[1, 1])
axes[1, 2].imshow(0.5 + 0.5 * picture.normal)
axes[1, 2].set_title("normals")
for axis in axes.flat:
    axis.set_axis_off()
figure.savefig(out, dpi=100)
