"""The examples run, on a small scan, and leave behind what they promise."""
import os
import pathlib
import subprocess
import sys

import numpy as np
import pytest

import sfumato
from png import read_png

EXAMPLES = pathlib.Path(__file__).parents[2] / "examples"


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    file = tmp_path_factory.mktemp("examples") / "scan.ply"
    sfumato.write(file, sfumato.synth("courtyard", points=20_000))
    return file


def run(name, folder, *words):
    done = subprocess.run([sys.executable, EXAMPLES / f"{name}.py", *map(str, words)], cwd=folder, capture_output=True, text=True,
                          timeout=300, check=False, env=os.environ)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_every_example_is_tested():
    mine = pathlib.Path(__file__).read_text()
    for file in EXAMPLES.glob("*.py"):
        assert f'"{file.stem}"' in mine, file.name


def test_figure(tmp_path, small):
    run("figure", tmp_path, small)
    assert read_png(tmp_path / "figure.png").shape == (720, 1280, 3)


def test_maps(tmp_path, small):
    run("maps", tmp_path, small, "maps.npz", 4)
    maps = np.load(tmp_path / "maps.npz")
    assert maps["rgb"].shape == (4, 240, 320, 3) and maps["normal"].shape == (4, 240, 320, 3)
    # What the maps say of the poses leads every pixel back to a point of the scan.
    xyz = sfumato.read(small).xyz
    for pose, depth in zip(maps["pose"], maps["depth"]):
        hit = np.isfinite(depth)
        assert hit.mean() > 0.1
        rows, columns = np.nonzero(hit)
        k = np.linalg.inv(maps["K"])
        eye = (k @ np.stack([columns, rows, np.ones(len(rows))])) * depth[hit]
        world = (pose[:3, :3] @ eye).T + pose[:3, 3]
        sample = world[:: len(world) // 50]
        nearest = np.sqrt(((sample[:, None] - xyz[None]) ** 2).sum(-1).min(1))
        assert np.median(nearest) < 3 * sfumato.analysis.spacing(xyz)  # splats fill between points


def test_turntable(tmp_path, small):
    run("turntable", tmp_path, small, "turn", 3)
    frames = [read_png(file) for file in sorted((tmp_path / "turn").iterdir())]
    assert len(frames) == 3 and all(frame.shape == (480, 640, 3) for frame in frames) and (frames[0] != frames[1]).any()


def test_panels(tmp_path, small):
    pytest.importorskip("matplotlib", reason="the example needs python3-matplotlib")
    run("panels", tmp_path, small, "panels.png")
    assert (tmp_path / "panels.png").stat().st_size > 50_000


def test_overlay(tmp_path):
    pytest.importorskip("matplotlib", reason="the example needs python3-matplotlib")
    run("overlay", tmp_path)
    assert (tmp_path / "overlay.png").stat().st_size > 50_000


def test_rgbd(tmp_path, data):
    run("rgbd", tmp_path, "rgbd.png", data("fragment.pcd"))
    assert read_png(tmp_path / "rgbd.png").shape == (720, 1280, 3)
