"""The same view and parameters give the same bytes as the command, for every technique."""
import json

import numpy as np
import pytest

import sfumato
from png import read_png

SIZE = (160, 120)
RESOLUTION = ("--resolution", "160x120", "--quiet")
NAMES = [technique.name for technique in sfumato.techniques()]


def pixels(command, tmp_path, *words):
    """What the command draws: sRGB."""
    command(*words, *RESOLUTION, "-o", tmp_path / "command.png")
    return read_png(tmp_path / "command.png")


def equal(picture, wanted):
    channels = wanted.shape[-1]
    assert picture.rgba.shape[:2] == wanted.shape[:2]
    assert (picture.rgba[..., :channels] == wanted).all(), f"{(picture.rgba[..., :channels] != wanted).any(-1).sum()} pixels differ"


@pytest.mark.parametrize("name", ["auto", *NAMES])
def test_colours_of_every_technique(command, tmp_path, scan, name):
    picture = sfumato.render(scan, technique=name, size=SIZE)
    equal(picture, pixels(command, tmp_path, scan, "-t", name))
    assert len(np.unique(picture.rgba.reshape(-1, 4), axis=0)) > 100  # a picture, no blank


@pytest.mark.parametrize("name", NAMES)
def test_every_output_of_every_technique(command, tmp_path, scan, name):
    """The file of the command and that of `save` are the same bytes, and so are the arrays."""
    command(scan, "-t", name, *RESOLUTION, "-o", tmp_path / "c.npy", "--output-depth", tmp_path / "d.npy", "--output-normal",
            tmp_path / "n.npy")
    picture = sfumato.render(scan, technique=name, size=SIZE)
    picture.save(tmp_path / "python.npy")
    assert (tmp_path / "python.npy").read_bytes() == (tmp_path / "c.npy").read_bytes()
    assert picture.linear.tobytes() == np.load(tmp_path / "c.npy").tobytes()
    assert picture.depth.tobytes() == np.load(tmp_path / "d.npy").tobytes()
    assert picture.normal.tobytes() == np.load(tmp_path / "n.npy").tobytes()


@pytest.mark.parametrize("name", NAMES)
def test_fewer_outputs_are_the_same_picture(scan, name):
    with sfumato.Renderer(scan, technique=name) as renderer:
        alone = renderer.render(size=SIZE, outputs=["rgba"])
        assert alone.depth is None and alone.linear is None and alone.normal is None
        equal(renderer.render(size=SIZE), alone.rgba)


@pytest.mark.parametrize("words, given", [
    (("--view", "top", "--zoom", "1.5", "--roll", "20"), {"camera": {"side": "top", "zoom": 1.5, "roll": 20}}),
    (("--view", "iso", "--camera-orthographic"), {"camera": {"side": "iso", "orthographic": True}}),
    (("--camera-azimuth-angle", "70"), {"camera": {"azimuth": 70}}),
    (("--camera-azimuth-angle", "10", "--camera-elevation-angle", "-15", "--camera-view-angle", "30"),
     {"camera": {"azimuth": 10, "elevation": -15, "fov": 30}}),
    (("--look-at", "1,2,1", "--distance", "9"), {"camera": {"look_at": (1, 2, 1), "distance": 9}}),
    (("--color-by", "elevation", "--colormap", "turbo", "--color-range", "0,8"),
     {"color_by": "elevation", "colormap": "turbo", "range": (0, 8)}),
    (("--color", "steelblue", "--background-color", "0.1,0.2,0.3"), {"color": "steelblue", "background": (0.1, 0.2, 0.3)}),
    (("--color-by", "classification", "--hide-classes", "2"), {"color_by": "classification", "hide_classes": [2]}),
    (("--shadows", "soft", "--ground", "--samples", "2"), {"shadows": "soft", "ground": True, "samples": 2}),
    (("--no-background",), {"background": "transparent"}),
    (("--up=-Y",), {"up": "-Y"}),
    (("--neighbors", "12"), {"neighbors": 12}),
    (("--whole",), {"whole": True}),
    (("--draw", "class 3-5: soft opacity=0.2", "--draw", "z 2..: points"),
     {"draw": ["class 3-5: soft opacity=0.2", "z 2..: points"]}),
])
def test_views_and_colours(command, tmp_path, scan, words, given):
    equal(sfumato.render(scan, technique="splats", size=SIZE, **given),
          pixels(command, tmp_path, scan, "-t", "splats", *words))


def test_arrays_are_the_file_they_are_saved_as(command, tmp_path, scan):
    """float32 and float64, with and without colours."""
    cloud = sfumato.read(scan)
    for name, xyz in (("narrow", cloud.positions), ("wide", cloud.xyz + (447_000, 5_412_000, 100))):
        np.save(tmp_path / f"{name}.npy", xyz)
        equal(sfumato.render(xyz, size=SIZE), pixels(command, tmp_path, tmp_path / f"{name}.npy"))
    records = np.empty(len(cloud), [(axis, np.float32) for axis in "xyz"] + [(c, np.uint8) for c in ("red", "green", "blue")])
    for k, axis in enumerate("xyz"):
        records[axis] = cloud.positions[:, k]
    for k, channel in enumerate(("red", "green", "blue")):
        records[channel] = cloud.colors[:, k]
    np.save(tmp_path / "records.npy", records)
    wanted = pixels(command, tmp_path, tmp_path / "records.npy")
    equal(sfumato.render(cloud.positions, cloud.colors[:, :3], size=SIZE), wanted)
    equal(sfumato.render(records, size=SIZE), wanted)
    equal(sfumato.render(cloud.positions, cloud.colors[:, :3].astype(np.float32) / 255, size=SIZE), wanted)


def test_real_scans(command, tmp_path, data):
    for name in ("autzen_trim.las", "office1.pcd", "fragment.pcd"):
        file = data(name)
        picture = sfumato.render(file, size=SIZE)
        equal(picture, pixels(command, tmp_path, file))


def test_a_path_has_the_light_of_its_first_camera(command, tmp_path, scan):
    command(scan, "-t", "points", "--shadows", "hard", "--path", "orbit", "--frames", "3", *RESOLUTION, "-o", tmp_path / "f{n}.png")
    with sfumato.Renderer(scan, technique="points", shadows="hard") as renderer:
        for n, picture in enumerate(renderer.frames(renderer.orbit(3, size=SIZE))):
            equal(picture, read_png(tmp_path / f"f{n}.png"))


def test_camera_and_parameters_are_those_of_the_report(command, tmp_path, scan):
    report = json.loads(command(scan, *RESOLUTION, "-o", tmp_path / "x.png", "--json"))
    picture = sfumato.render(scan, size=SIZE)
    assert json.loads(picture.camera.to_json()) == report["camera"]
    assert picture.technique == report["technique"]
    assert picture.reason == report["automatic_technique"]["reason"]
    assert {name: list(value) if isinstance(value, tuple) else value for name, value in picture.parameters.items()} == report["parameters"]
    assert picture.color_by == report["color_by"]


def test_one_renderer_gives_what_fresh_ones_give(scan):
    """Whatever was drawn before: other techniques, parameters, sizes."""
    camera = {"azimuth": 20, "zoom": 1.3}
    wanted = {name: sfumato.render(scan, technique=name, camera=camera, size=SIZE).rgba.copy() for name in NAMES}
    with sfumato.Renderer(scan) as renderer:
        for name in [*NAMES, *reversed(NAMES)]:
            renderer.render(technique=name, size=(64, 48), shadows="hard", samples=2, outputs="rgba")
            got = renderer.render(camera, SIZE, technique=name)
            assert (got.rgba == wanted[name]).all(), name
