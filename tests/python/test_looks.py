"""Presets, scenes, panoramas, legends and contact sheets: the same bytes as the command, and the same files."""
import json

import numpy as np
import pytest

import sfumato
from png import read_png
from test_same_bytes import RESOLUTION, SIZE, equal, pixels

MOVED = [[0, -1, 0, 30], [1, 0, 0, 4], [0, 0, 1, 2], [0, 0, 0, 1]]


@pytest.mark.parametrize("words, given", [
    (("--legend", "--color-by", "elevation"), {"legend": True, "color_by": "elevation"}),
    (("--legend", "--color-by", "classification"), {"legend": True, "color_by": "classification"}),
    (("--color-by", "classification", "--class-colors", "2=tan,building=#aa3300"), {"color_by": "classification", "class_colors": "2=tan,building=#aa3300"}),
    (("--exposure", "2.5"), {"exposure": 2.5}),
    (("--crop-relative", "0,0,0,1,1,0.5", "--max-points", "5000"), {"crop_relative": (0, 0, 0, 1, 1, 0.5), "max_points": 5000}),
    (("--show-classes", "2", "--filter", "z ..1"), {"show_classes": [2], "filters": "z ..1"}),
    (("--camera-position", "3,-20,9", "--camera-focal-point", "2,1,1"), {"camera": {"position": (3, -20, 9), "look_at": (2, 1, 1)}}),
    (("--camera-position", "3,-20,9", "--camera-direction", "0,1,-0.2"), {"camera": {"position": (3, -20, 9), "direction": (0, 1, -0.2)}}),
    (("--camera-direction", "1,1,-1", "--camera-view-up", "1,0,1"), {"camera": {"direction": (1, 1, -1), "view_up": (1, 0, 1)}}),
])
def test_what_the_command_knows(command, tmp_path, scan, words, given):
    equal(sfumato.render(scan, technique="points", size=SIZE, **given), pixels(command, tmp_path, scan, "-t", "points", *words))


def test_colours_of_classes_come_from_a_file_too(tmp_path, scan):
    file = tmp_path / "colours.txt"
    file.write_text("2=tan\nbuilding=#aa3300\n")
    given = {"technique": "points", "size": SIZE, "color_by": "classification"}
    wanted = sfumato.render(scan, class_colors="2=tan,building=#aa3300", **given)
    assert (sfumato.render(scan, class_colors=str(file), **given).rgba == wanted.rgba).all()
    assert (sfumato.render(scan, **given).rgba != wanted.rgba).any()
    with pytest.raises(sfumato.Error, match="class_colors: 'lawn=green'"):
        sfumato.render(scan, class_colors="lawn=green", **given)


def test_meshes_are_points_on_their_faces(command, tmp_path):
    file = tmp_path / "square.obj"
    file.write_text("v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nf 1 2 3 4\n")
    equal(sfumato.render(file, size=SIZE), pixels(command, tmp_path, file))
    equal(sfumato.render(file, vertices=True, size=SIZE), pixels(command, tmp_path, file, "--vertices"))
    assert len(sfumato.read(file)) == 4 and len(sfumato.read(file, vertices=False)) == 259200


def test_selections_of_clouds_are_those_of_files(scan):
    wanted = {"show_classes": [2, 6], "filters": ["z 0.5.."], "crop_relative": (0, 0, 0, 0.7, 1, 1)}
    assert (sfumato.render(sfumato.read(scan), size=SIZE, **wanted).rgba == sfumato.render(scan, size=SIZE, **wanted).rgba).all()


@pytest.mark.parametrize("words, given", [
    ((), {}),
    (("--camera-position", "2,-3,1.7"), {"camera": {"position": (2, -3, 1.7)}}),
    (("--camera-azimuth-angle", "70", "--shadows", "hard"), {"camera": {"azimuth": 70}, "shadows": "hard"}),
])
def test_panoramas(command, tmp_path, scan, words, given):
    command(scan, "-t", "splats", "--panorama", *words, "--resolution", "200x100", "--quiet", "-o", tmp_path / "command.npy",
            "--output-depth", tmp_path / "depth.npy", "--output-camera", tmp_path / "camera.json")
    picture = sfumato.render(scan, technique="splats", panorama=True, size=(200, 100), **given)
    assert (picture.linear == np.load(tmp_path / "command.npy")).all()
    assert picture.depth.tobytes() == np.load(tmp_path / "depth.npy").tobytes()
    again = sfumato.render(scan, technique="splats", panorama=True, camera=tmp_path / "camera.json",
                           **({"shadows": "hard"} if "shadows" in given else {}))
    assert again.linear.tobytes() == picture.linear.tobytes()


def test_panoramas_of_another_shape_are_refused(scan):
    with pytest.raises(sfumato.Error, match=r"twice as wide as high: \(200, 100\)"):
        sfumato.render(scan, panorama=True, size=(250, 100))


def test_legends_say_what_the_colours_mean(scan):
    with sfumato.Renderer(scan, technique="points", color_by="elevation", colormap="turbo", range=(0, 5)) as renderer:
        plain = renderer.render(size=SIZE)
        assert plain.legend == {"title": "elevation", "low": 0, "high": 5, "colormap": "turbo"}
        explained = renderer.render(size=SIZE, legend=True)
        changed = (plain.rgba != explained.rgba).any(-1)
        assert 0.01 < changed.mean() < 0.3 and changed[60:, 80:].sum() > 0.5 * changed.sum()  # a corner
        assert (plain.linear == explained.linear).all()
        renderer.color(color_by="classification")
        legend = renderer.render(size=SIZE).legend
        cloud = sfumato.read(scan)
        codes, counts = np.unique(cloud.scalars["classification"], return_counts=True)
        assert sum(points for _, _, points in legend["swatches"]) == counts[~np.isin(codes, (7, 18))].sum()
        renderer.color("steelblue")
        assert renderer.render(size=SIZE).legend is None
    notes = sfumato.render(scan, color="steelblue", size=SIZE, legend=True).notes
    assert any("legend has no effect" in note for note in notes)
    turbo = sfumato.colormap("turbo", 3)
    assert turbo.shape == (3, 3) and (turbo[0] != turbo[2]).any() and (sfumato.colormap("turbo", 257)[128] == turbo[1]).all()


def test_contact_sheets(command, tmp_path, scan):
    wanted = pixels(command, tmp_path, scan, "-t", "points,splats,soft", "--color-by", "elevation", "--legend")
    with sfumato.Renderer(scan, color_by="elevation") as renderer:
        pictures = [renderer.render(size=SIZE, technique=name, legend=name == "soft") for name in ("points", "splats", "soft")]
    sheet = sfumato.contact_sheet(pictures)
    equal(sheet, wanted)
    assert sheet.linear is None and sheet.technique == "points,splats,soft"
    assert (sfumato.contact_sheet(pictures, ["a", "b", "c"]).rgba != sheet.rgba).any()
    with pytest.raises(sfumato.Error, match="3 pictures and 2 labels"):
        sfumato.contact_sheet(pictures, ["a", "b"])
    with pytest.raises(sfumato.Error, match="one size"):
        sfumato.contact_sheet([pictures[0], sfumato.render(scan, size=(50, 50))])


LOOK = ("-t", "points", "--point-size", "3", "--size-mode", "pixels", "--shadows", "hard", "--color-by", "elevation", "--colormap", "turbo",
        "--hide-classes", "none", "--filter", "z ..4", "--background-color", "#203040", "--zoom", "1.4", "--legend")


def test_presets_of_the_command(command, tmp_path, scan):
    wanted = pixels(command, tmp_path, scan, *LOOK, "--save-preset", tmp_path / "look.json")
    picture = sfumato.render(scan, preset=tmp_path / "look.json")  # its size is in it
    equal(picture, wanted)
    assert picture.parameters["point_size"] == 3 and picture.technique == "points"
    # What is given wins.
    equal(sfumato.render(scan, preset=tmp_path / "look.json", color_by="classification", shadows="off"),
          pixels(command, tmp_path, scan, "--preset", tmp_path / "look.json", "--color-by", "classification", "--shadows", "off"))
    other = sfumato.render(scan, preset=tmp_path / "look.json", technique="splats")
    equal(other, pixels(command, tmp_path, scan, "--preset", tmp_path / "look.json", "-t", "splats"))
    # One picture of another technique: parameters that both have stay.
    with sfumato.Renderer(scan, preset=tmp_path / "look.json") as renderer:
        assert renderer.render(technique="splats").rgba.tobytes() == other.rgba.tobytes()


def test_numbers_reach_the_engine_as_they_are(scan):
    place, middle = (0.1 + 0.2, -20 / 3, 1e-300), (np.float32(0.1), 1, 123456789.123456789)
    with sfumato.Renderer(scan) as renderer:
        camera = renderer.view(position=place, look_at=middle)
    assert camera.position == place and camera.target == tuple(map(float, middle))


def test_boxes_may_have_open_ends(scan):
    low, high = (-np.inf, -np.inf, -np.inf), (np.inf, np.inf, 1.0)
    assert 0 < len(sfumato.read(scan, crop=(*low, *high))) == (sfumato.read(scan).xyz[:, 2] <= 1).sum()
    assert len(sfumato.read(scan, crop_relative=(low, (np.inf,) * 3))) == len(sfumato.read(scan))


def test_numbers_of_numpy_in_looks(tmp_path, scan):
    given = {"technique": "points", "range": np.array([0, 4.0]), "crop_relative": np.array([[0, 0, 0], [1, 1, 0.5]]),
             "color_by": "elevation", "max_points": np.int64(5000), "background": np.array([0.1, 0.2, 0.3]),
             "vertical_exaggeration": np.longdouble(1.5)}
    with sfumato.Renderer(scan, **given) as renderer:
        wanted = renderer.render(size=SIZE)
        renderer.save_preset(tmp_path / "look.json")
    equal(sfumato.render(scan, preset=tmp_path / "look.json", size=SIZE), wanted.rgba)
    equal(sfumato.render(scan, preset=given, size=SIZE), wanted.rgba)


def test_presets_with_a_camera(command, tmp_path, scan):
    command(scan, *RESOLUTION, "--view", "top", "--output-camera", tmp_path / "camera.json", "-o", tmp_path / "x.png")
    wanted = pixels(command, tmp_path, scan, "-t", "splats", "--camera", tmp_path / "camera.json", "--save-preset", tmp_path / "look.json")
    equal(sfumato.render(scan, preset=tmp_path / "look.json"), wanted)
    equal(sfumato.render(scan, preset=tmp_path / "look.json", camera="front"),
          pixels(command, tmp_path, scan, "-t", "splats", "--view", "front"))


def test_presets_of_python(command, tmp_path, scan):
    given = {"technique": "points", "point_size": 2, "shadows": "soft", "color_by": "elevation", "range": (0, 4), "hide_classes": (),
             "draw": ["class 3-5: soft opacity=0.3"], "background": "transparent"}
    with sfumato.Renderer(scan, **given) as renderer:
        camera = renderer.view("iso", size=SIZE)
        wanted = renderer.render(camera)
        renderer.save_preset(tmp_path / "look.json", camera)
    equal(wanted, pixels(command, tmp_path, scan, "--preset", tmp_path / "look.json"))
    equal(sfumato.render(scan, preset=tmp_path / "look.json"), wanted.rgba)
    equal(sfumato.render(scan, preset={**given, "camera": camera}), wanted.rgba)
    # Every parameter is in it, also what was not given.
    assert json.loads((tmp_path / "look.json").read_text())["parameters"]["points"]["size_mode"] == "adaptive"


def test_presets_as_people_write_them(command, tmp_path, scan):
    (tmp_path / "look.json").write_text(json.dumps({"technique": "points", "options": {
        "resolution": [160, 120], "legend": "on", "color-by": "elevation", "whole": "no", "hide-classes": [7.0, 18.0],
        "color-range": "", "exposure": ""}}))
    picture = sfumato.render(scan, preset=tmp_path / "look.json")
    command(scan, "--preset", tmp_path / "look.json", "-o", tmp_path / "command.png")
    assert (picture.rgba[..., :3] == read_png(tmp_path / "command.png")[..., :3]).all()
    assert (picture.rgba != sfumato.render(scan, preset=tmp_path / "look.json", legend=False).rgba).any()


@pytest.mark.parametrize("content, says", [
    ('{"options": {"hide-classes": "2.5"}}', "hide-classes: '2.5'"),
    ('{"options": {"legend": "maybe"}}', "legend: 'maybe' is not true or false"),
    ('{"options": {"color-bye": "rgb"}}', "did you mean 'color-by'?"),
    ('{"options": {"zoom": "large"}}', "zoom: 'large' is not a number"),
    ('{"parameters": {"point_sise": 3}}', "no technique has 'point_sise'"),
    ('{"files": ["a.ply"]}', "it is a scene"),
    ('{"technique": "surfaces"}', "surface"),
    ("nothing", "look.json"),
])
def test_presets_that_are_wrong(tmp_path, scan, content, says):
    (tmp_path / "look.json").write_text(content)
    with pytest.raises(sfumato.Error, match=says):
        sfumato.render(scan, preset=tmp_path / "look.json")


def test_scenes_of_the_command(command, tmp_path, scan):
    other = tmp_path / "other.ply"
    sfumato.write(other, sfumato.synth("spheres", points=4_000))
    (tmp_path / "given.json").write_text(json.dumps({
        "files": [str(scan), {"file": "other.ply", "transform": sum(MOVED, [])}],
        "options": {"draw": ["file 2: points point_size=3", "class 3-5: soft"], "shadows": "hard"}}))
    wanted = pixels(command, tmp_path, "--scene", tmp_path / "given.json", "-t", "splats", "--save-scene", tmp_path / "saved.json")
    for name in ("given.json", "saved.json"):
        scene = sfumato.Scene.load(tmp_path / name)
        assert [item.transform for item in scene.items] == [None, MOVED] and len(scene.draw) == 2
        equal(sfumato.render(scene, technique="splats", size=None if name == "saved.json" else SIZE), wanted)
    # And written again.
    scene.save(tmp_path / "again.json")
    equal(sfumato.render(sfumato.Scene.load(tmp_path / "again.json")), wanted)
    equal(sfumato.render(scene), pixels(command, tmp_path, "--scene", tmp_path / "again.json"))


def test_scenes_are_cropped_as_by_the_command(command, tmp_path, scan):
    box = [-6, -6, -1, 3, 4, 2.5]
    (tmp_path / "given.json").write_text(json.dumps({"files": [str(scan)], "technique": "points", "options": {"crop": box}}))
    wanted = pixels(command, tmp_path, "--scene", tmp_path / "given.json")
    equal(sfumato.render(sfumato.Scene.load(tmp_path / "given.json"), size=SIZE), wanted)
    assert (wanted != pixels(command, tmp_path, scan, "-t", "points")).any()
    sfumato.Scene([scan], technique="points", crop=(box[:3], box[3:])).save(tmp_path / "saved.json")
    assert [float(number) for number in json.loads((tmp_path / "saved.json").read_text())["options"]["crop"].split(",")] == box
    equal(sfumato.render(sfumato.Scene.load(tmp_path / "saved.json"), size=SIZE), wanted)


def test_scenes_of_python(command, tmp_path, scan):
    """Files, arrays and clouds, each by its own technique; as files they are the command's."""
    other = sfumato.synth("spheres", points=4_000)
    sfumato.write(tmp_path / "other.ply", other)
    look = {"technique": "splats", "shadows": "soft"}
    files = sfumato.Scene([scan, sfumato.Item(tmp_path / "other.ply", MOVED, technique="points", point_size=3)],
                          draw="class 3-5: soft opacity=0.3", **look)
    assert files.rules() == ["class 3-5: soft opacity=0.3", "file 2: points point_size=3"]
    picture = sfumato.render(files, size=SIZE)
    files.save(tmp_path / "scene.json", picture.camera)
    equal(picture, pixels(command, tmp_path, "--scene", tmp_path / "scene.json"))
    clouds = sfumato.Scene([sfumato.read(scan), sfumato.Item(sfumato.read(tmp_path / "other.ply"), np.array(MOVED), technique="points", point_size=3)],
                           draw="class 3-5: soft opacity=0.3", **look)
    equal(sfumato.render(clouds, size=SIZE), picture.rgba)
    with sfumato.Renderer(clouds, shadows="off") as renderer:  # what is given wins
        assert (renderer.render(size=SIZE).rgba != picture.rgba).any()
    with pytest.raises(sfumato.Error, match="a scene file names files"):
        clouds.save(tmp_path / "clouds.json")
    # Clouds in a scene stay as they are.
    assert sfumato.render(sfumato.Scene([other, other]), size=SIZE).rgba.shape == (120, 160, 4) and len(other) == 4_000
    alone = sfumato.Scene([sfumato.Item(other.xyz, technique="points")])
    assert alone.rules() == ["*: points"]
    equal(sfumato.render(alone, size=SIZE), sfumato.render(sfumato.Cloud(other.xyz), draw="*: points", size=SIZE).rgba)


def test_scenes_that_are_wrong(tmp_path, scan):
    with pytest.raises(sfumato.Error, match="the scene has no items"):
        sfumato.render(sfumato.Scene())
    with pytest.raises(sfumato.Error, match=r"transform: found an array of shape \(3, 3\)"):
        sfumato.render(sfumato.Scene([sfumato.Item(scan, np.eye(3))]))
    with pytest.raises(sfumato.Error, match="flattens nothing"):
        sfumato.render(sfumato.Scene([sfumato.Item(scan, np.zeros((4, 4)))]))
    with pytest.raises(sfumato.Error, match="name it"):
        sfumato.Item(scan, point_size=3)
    with pytest.raises(sfumato.Error, match="did you mean 'point_size'?"):
        sfumato.Item(scan, technique="points", point_sise=3)
    with pytest.raises(sfumato.Error, match="colours"):
        sfumato.render(sfumato.Scene([scan]), np.zeros((5, 3)))


def test_what_a_keyword_may_be(scan):
    noise = sfumato.Cloud(np.random.default_rng(1).uniform(size=(2_000, 3)), scalars={"classification": np.full(2_000, 7)})
    # None hides nothing, wherever it stands, and no limit may be any number.
    assert len(sfumato.Renderer(noise, hide_classes=None)) == 2_000
    assert len(sfumato.Renderer(noise, preset={"hide_classes": None})) == 2_000
    assert len(sfumato.Renderer(noise, hide_classes=(), max_points=10**18, memory=2**60)) == 2_000
    # What is read once is asked for again with other colours.
    part = sfumato.Renderer(scan, technique="points", crop=iter([0, 0, -9, 30, 30, 9]), show_classes=iter([2]))
    part.color(color_by="elevation")
    for crop in ((0, 0, 0, 1, 1, None), ("0", "0", "x", "1", "1", "1")):
        with pytest.raises(sfumato.Error, match="crop"):
            sfumato.Renderer(scan, crop=crop)
