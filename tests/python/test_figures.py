"""Figures and maps: the same bytes as the command draws, and files that keep their place."""
import json
import shutil
import subprocess

import pytest

import sfumato
from png import read_png


def test_what_is_drawn_is_what_the_command_draws(command, tmp_path, scan):
    words = ("--view", "top", "--scale", "1:200", "--dpi", "96", "--up", "+Z", "--scale-bar", "--grid", "--north-arrow", "--title",
             "Site 4", "--caption", "of May", "--color-by", "elevation", "--legend", "--legend-place", "top-left", "--legend-unit", "m",
             "--unit", "m", "--vertical-exaggeration", "2", "--quiet")
    command(scan, "-t", "points", *words, "-o", tmp_path / "c.png")
    with sfumato.Renderer(scan, technique="points", color_by="elevation", up="+Z", vertical_exaggeration=2, title="Site 4",
                          caption="of May", scale_bar=True, unit="m", legend=True, legend_place="top-left") as renderer:
        camera = renderer.view("top", scale="1:200", dpi=96)
        picture = renderer.render(camera, grid=True, north_arrow=True, legend_unit="m")
        wanted = read_png(tmp_path / "c.png")
        assert picture.rgba.shape[:2] == wanted.shape[:2]
        assert (picture.rgba[..., :3] == wanted[..., :3]).all()
        plain = renderer.render(camera, title="", caption="", scale_bar=False, legend=False)
        assert (plain.rgba != picture.rgba).any()
        with pytest.raises(sfumato.Error, match="scale-bar"):
            renderer.render()  # in perspective
        with pytest.raises(sfumato.Error, match="no corner"):
            renderer.render(camera, legend_place="middle")
        with pytest.raises(sfumato.Error, match="is no scale"):
            renderer.view("top", scale="200:1")


def test_a_preset_brings_them(command, tmp_path, scan):
    command(scan, "-t", "points", "--view", "top", "--pixel-size", "0.1", "--scale-bar", "--title", "Site 4", "--quiet", "-o",
            tmp_path / "c.png", "--save-preset", tmp_path / "look.json")
    picture = sfumato.render(scan, preset=tmp_path / "look.json")
    wanted = read_png(tmp_path / "c.png")
    assert picture.rgba.shape[:2] == wanted.shape[:2]
    assert (picture.rgba[..., :3] == wanted[..., :3]).all()


def test_plans_are_saved_at_their_place(tmp_path, scan):
    with sfumato.Renderer(scan, technique="points", up="+Z") as renderer:
        renderer.render(renderer.view("top", pixel_size=0.25)).save(tmp_path / "plan.tif", dpi=300)
    if shutil.which("gdalinfo") is None:
        pytest.skip("gdalinfo is not installed (scripts/install-deps --all)")
    found = json.loads(subprocess.run(["gdalinfo", "-json", tmp_path / "plan.tif"], capture_output=True, text=True, check=True).stdout)
    west, across, _, north, _, down = found["geoTransform"]
    assert (across, down) == (0.25, -0.25)
    assert west % 0.25 == pytest.approx(0) and north % 0.25 == pytest.approx(0)
