"""COPC files of any size: only what is needed is read, and the pictures are the command's."""
import numpy as np
import pytest

import sfumato
from test_same_bytes import RESOLUTION, SIZE, equal, pixels


@pytest.fixture(scope="module")
def leveled(command, tmp_path_factory):
    """200,000 points with levels."""
    folder = tmp_path_factory.mktemp("levels")
    sfumato.write(folder / "scan.laz", sfumato.synth("courtyard", points=200_000, seed=3))
    command("build", folder / "scan.laz", "-o", folder / "scan.copc.laz", "--quiet")
    return folder / "scan.copc.laz"


@pytest.mark.parametrize("words, given", [
    (("--max-points", "30k"), {"max_points": "30k"}),
    (("--memory", "3M"), {"memory": "3M"}),
    (("--memory", "3M", "--zoom", "4", "--shadows", "hard"), {"memory": 3_000_000, "camera": {"zoom": 4}, "shadows": "hard"}),
    (("--memory", "3M", "--panorama"), {"memory": "3M", "panorama": True}),
    (("--memory", "3M", "--crop-relative", "0,0,0,0.5,0.5,1"), {"memory": "3M", "crop_relative": (0, 0, 0, 0.5, 0.5, 1)}),
])
def test_pictures_are_the_command_s(command, tmp_path, leveled, words, given):
    if given.get("panorama"):
        command(leveled, "-t", "points", *words, "--resolution", "160x80", "--quiet", "-o", tmp_path / "c.npy")
        picture = sfumato.render(leveled, technique="points", size=(160, 80), **given)
        assert picture.linear.tobytes() == np.load(tmp_path / "c.npy").tobytes()
        return
    picture = sfumato.render(leveled, technique="points", size=SIZE, **given)
    equal(picture, pixels(command, tmp_path, leveled, "-t", "points", *words))
    assert any("are left out" in note for note in picture.notes)


def test_every_picture_reads_what_it_shows(leveled):
    with sfumato.Renderer(leveled, technique="points", max_points=30_000) as renderer:
        overview = renderer.render(size=SIZE)
        assert len(renderer) <= 30_000
        near = renderer.view(zoom=6, size=SIZE)
        close = renderer.render(near)
        assert renderer.render(size=SIZE).rgba.tobytes() == overview.rgba.tobytes()
    fresh = sfumato.render(leveled, technique="points", camera=near, max_points=30_000)
    assert close.rgba.tobytes() == fresh.rgba.tobytes()
    with sfumato.Renderer(leveled, technique="points") as whole:  # it fits
        assert len(whole) > 190_000


@pytest.mark.parametrize("memory", ["3M", "15M"])  # too little for one cloud of all frames, and enough
def test_a_path_reads_what_its_frames_show(command, tmp_path, leveled, memory):
    command(leveled, "-t", "points", "--memory", memory, "--path", "orbit", "--frames", "3", *RESOLUTION, "-o", tmp_path / "f{n}.png")
    from png import read_png

    with sfumato.Renderer(leveled, technique="points", memory=memory) as renderer:
        for n, picture in enumerate(renderer.frames(renderer.orbit(3, size=SIZE))):
            equal(picture, read_png(tmp_path / f"f{n}.png"))


def test_heights_of_levels_are_not_exaggerated(leveled):
    with pytest.raises(sfumato.Error, match="vertical exaggeration needs all points in memory"):
        sfumato.Renderer(leveled, max_points=30_000, vertical_exaggeration=2)


def test_open_reads_parts(leveled):
    levels = sfumato.open(leveled, max_points=50_000)
    whole = sfumato.read(leveled)
    assert len(levels) == len(whole) and sum(points for points, _ in levels.levels) == len(whole)
    assert np.allclose(levels.bounds, whole.bounds, atol=1e-3)
    spacings = [spacing for _, spacing in levels.levels]
    assert spacings == sorted(spacings, reverse=True)
    coarse = levels.read(max_points=10_000)
    assert 0 < len(coarse) <= 50_000
    low, high = (np.asarray(corner) for corner in whole.bounds)
    box = (*low, *(low + 0.3 * (high - low)))
    part = sfumato.open(leveled, crop=box).read()
    inside = ((whole.xyz >= box[:3]) & (whole.xyz <= box[3:])).all(1)
    assert len(part) == inside.sum() > 100
    camera = sfumato.Renderer(levels).view(zoom=8)
    seen = levels.read(camera)
    assert 0 < len(seen) <= 50_000
    equal(sfumato.render(levels, technique="points", size=SIZE), sfumato.render(leveled, technique="points", size=SIZE, max_points=50_000).rgba)


def test_what_cannot_be_opened(scan, tmp_path, leveled):
    with pytest.raises(sfumato.Error, match="sfumato build makes one"):
        sfumato.open(scan)
    with pytest.raises(sfumato.Error, match="nowhere"):
        sfumato.open(tmp_path / "nowhere.copc.laz")
    with pytest.raises(sfumato.Error, match="not a whole number of at least 1"):
        sfumato.open(leveled, memory="a lot")
    with pytest.raises(sfumato.Error, match="give a Camera"):
        sfumato.open(leveled).read("top")


def test_real_levels(command, tmp_path, data):
    file = data("lion_takanawa.copc.laz")
    equal(sfumato.render(file, max_points="200k", size=SIZE), pixels(command, tmp_path, file, "--max-points", "200k"))
