"""What is wrong is said in one line that names the nearest right thing; the same line as the command's where it has one."""
import os
import re
import subprocess
import warnings

import numpy as np
import pytest

import sfumato

XYZ = np.random.default_rng(1).uniform(size=(100, 3)).astype(np.float32)


@pytest.mark.parametrize("given, says", [
    ({"technique": "surfaces"}, "surface"),
    ({"point_sise": 3, "technique": "points"}, "no technique has a parameter 'point_sise'; did you mean 'point_size'?"),
    ({"colour_by": "rgb"}, "did you mean 'color_by'?"),
    ({"point_size": "big", "technique": "points"}, "parameter 'point_size': 'big' is not a number"),
    ({"samples": 10_000}, "in range"),
    ({"shadows": "sofd"}, "did you mean soft?"),
    ({"point_size": 2, "technique": "surface"}, "point_size is a parameter of "),
    ({"shadows": object()}, "a object is no value"),
    ({"color_by": "heigth", "scalars": {"height": XYZ[:, 2]}}, "height"),
    ({"colormap": "viridus"}, "viridis"),
    ({"background": "steelblu"}, "did you mean steelblue?"),
    ({"background": (1, 2, 3)}, "background: '1,2,3' is no colour. Write a name .* or R,G,B in 0..1"),
    ({"camera": "tob"}, "did you mean top?"),
    ({"camera": 5}, "give a Camera"),
    ({"camera": {"elevation": 100}}, r"outside \[-90, 90\]"),
    ({"size": (0, 10)}, "at least 1"),
    ({"size": (10**6, 10)}, "beyond the largest picture"),
    ({"outputs": ["dept"]}, "did you mean 'depth'?"),
    ({"up": "Q"}, "not one of auto"),
    ({"color": "red", "color_by": "rgb"}, "color and color_by contradict each other"),
    ({"color": "red", "colormap": "turbo"}, "colormap does not go with color"),
    ({"range": (2, 2)}, "range: '2,2' is empty"),
    ({"range": (1, 2, 3)}, "range: '1,2,3' is not 2 numbers"),
    ({"exposure": 1000}, "exposure: '1000' is not in 0.1..100"),
    ({"vertical_exaggeration": 0}, "vertical_exaggeration: '0' is not in 0.001..1000"),
    ({"max_points": 0.5}, "max_points: '0.5' is not a whole number of at least 1"),
    ({"crop": (0, 0, 0, 1, -1, 1)}, "crop: '0,0,0,1,-1,1' is empty along y"),
    ({"camera": {"zoom": 0}}, "zoom: '0' is not more than 0"),
    ({"camera": {"roll": np.nan}}, "roll: 'nan' is not a number"),
    ({"camera": {"direction": (0, 0, 0)}}, "direction: 0,0,0 is no direction"),
    ({"camera": {"side": "top", "azimuth": 10}}, "side and azimuth / elevation contradict each other"),
    ({"camera": {"position": (1, 2, 3), "elevation": 10}}, "position and azimuth / elevation contradict each other"),
    ({"camera": {"position": (1, 2, 3), "look_at": (0, 0, 0), "direction": (0, 0, 1)}}, "direction and position with look_at contradict each other"),
    ({"camera": {"position": (1, 2, 3), "look_at": (1, 2, 3)}}, "the same point"),
    ({"camera": {"pixel_size": 0.1, "scale": 200}}, "pixel_size and scale contradict each other"),
    ({"camera": {"pixel_size": 0.1, "zoom": 2}}, "pixel_size and zoom contradict each other"),
    ({"camera": {"scale": "1:200", "dpi": 0}}, "scale needs a dpi of more than 0"),
    ({"camera": {"start": sfumato.Camera(intrinsics=(500, 500, 320, 240)), "size": (64, 48)}}, "^size does not go with the intrinsics of the camera"),
    ({"crop": (0, 0, 0, 1, 1, 1), "crop_relative": (0, 0, 0, 1, 1, 1)}, "crop and crop_relative contradict each other"),
    ({"ground": True}, "add --shadows soft"),
    ({"technique": "points,soft"}, "names several"),
    ({"normals": XYZ[:5]}, r"normals: found an array of shape \(5, 3\), expected \(100, 3\)"),
    ({"colors": XYZ[:, :2]}, r"expected \(100, 3\) or \(100, 4\)"),
    ({"scalars": {"a": ["p"] * 100}}, "holds no numbers"),
])
def test_wrong_names_and_values(given, says):
    with pytest.raises(sfumato.Error, match=says) as caught:
        sfumato.render(XYZ, **given)
    assert caught.value.code == "usage" and "\n" not in str(caught.value)


@pytest.mark.parametrize("points, code, says", [
    (np.zeros((5, 2)), "usage", r"xyz: found an array of shape \(5, 2\), expected \(N, 3\)"),
    (np.zeros((0, 3)), "bad_input", "no points"),
    (np.full((9, 3), np.nan), "bad_input", "no points"),
    (np.zeros(7, [("a", float)]), "usage", "no x, y and z but a"),
    ("nowhere.laz", "io", "nowhere.laz"),
    (object(), "usage", "holds no numbers"),
])
def test_points_that_are_none(points, code, says):
    with pytest.raises(sfumato.Error, match=says) as caught:
        sfumato.render(points)
    assert caught.value.code == code


def test_scalars_that_are_not_there():
    cloud = sfumato.Cloud(XYZ, scalars={"height": XYZ[:, 2]})
    with pytest.raises(KeyError, match="did you mean 'height'?"):
        cloud.scalars["heigth"]
    assert cloud.scalars.get("width") is None and "height" in cloud.scalars
    with pytest.raises(sfumato.Error, match=r"expected \(100,\)"):
        cloud.scalars["height"] = np.zeros(3)
    with pytest.raises(sfumato.Error, match="spheres"):
        sfumato.synth("sphere")
    with pytest.raises(sfumato.Error, match="did you mean 'points'?"):
        sfumato.synth("tori", point=5)


def test_damaged_files_are_refused_as_by_the_command(command, tmp_path, scan):
    cut = tmp_path / "cut.ply"
    cut.write_bytes(scan.read_bytes()[:60])  # within its header
    done = subprocess.run([command.program, str(cut), "-o", str(tmp_path / "x.png")], capture_output=True, text=True, check=False,
                          env={**os.environ, "SFUMATO_CONFIG": ""})
    with pytest.raises(sfumato.Error) as caught:
        sfumato.read(cut)
    assert caught.value.code == "bad_input" and done.returncode == 2
    assert done.stderr.strip() == f"sfumato: {caught.value}"


def test_pictures_that_cannot_be_saved(tmp_path):
    picture = sfumato.render(XYZ, size=(64, 48), outputs="rgba")
    with pytest.raises(sfumato.Error, match="pictures are written as"):
        picture.save(tmp_path / "x.gif")
    with pytest.raises(sfumato.Error, match="has no linear image"):
        picture.save(tmp_path / "x.exr")
    with pytest.raises(sfumato.Error) as caught:
        picture.save(tmp_path / "nowhere" / "x.png")
    assert caught.value.code == "io"
    with pytest.raises(sfumato.Error, match="not in 1..100"):
        picture.save(tmp_path / "x.jpg", quality=0)


def test_techniques_are_what_the_command_lists(command):
    import json

    listed = json.loads(command("techniques", "--json"))
    ours = sfumato.techniques()
    assert [t.name for t in ours] == [t["name"] for t in listed]
    for mine, theirs in zip(ours, listed):
        assert mine.summary == theirs["summary"] and list(mine.needs) == theirs["needs"]
        for key in ("parameters", "shared_parameters"):
            for p, q in zip(getattr(mine, key), theirs[key], strict=True):
                default = list(p.default) if isinstance(p.default, tuple) else p.default
                assert (p.name, p.kind, default, p.auto, p.unit, p.help) == (q["name"], q["kind"], q["default"], q["auto"], q["unit"], q["help"])
                assert (list(p.range) if p.range else None) == q.get("range")
    assert "point_size" in str(sfumato.techniques("points"))
    with pytest.raises(sfumato.Error, match="points"):
        sfumato.techniques("pionts")


def test_every_public_name_is_documented_and_in_the_stubs():
    import inspect
    import pathlib

    stub = (pathlib.Path(sfumato.__file__).parent / "__init__.pyi").read_text()
    compile(stub, "__init__.pyi", "exec")
    for name in sfumato.__all__:
        thing = getattr(sfumato, name)
        assert inspect.getdoc(thing), name
        assert name in stub, name
        if inspect.isclass(thing):
            for member, value in vars(thing).items():
                if not member.startswith("_") and (inspect.isfunction(value) or isinstance(value, (property, classmethod))):
                    assert inspect.getdoc(value), f"{name}.{member}"
    for technique in sfumato.techniques():
        for parameter in technique.parameters + technique.shared_parameters:
            assert f"{parameter.name}: " in stub, parameter.name


@pytest.fixture(scope="module")
def damaged(tmp_path_factory):
    """A LAZ file of 120,000 points in chunks of 50,000, 50,000 and 20,000; the head of the second is gone."""
    file = tmp_path_factory.mktemp("damaged") / "damaged.laz"
    sfumato.write(file, np.random.default_rng(2).uniform(size=(120_000, 3)))
    content = bytearray(file.read_bytes())
    # Where the chunks begin stands at the end of the file, coded. Those of noise are as long as they have points, so that the
    # second begins at 41.7 %; broken around there, it says where.
    around = bytearray(content)
    begin, end = int(0.41 * len(content)), int(0.42 * len(content))
    around[begin:end] = b"\xff" * (end - begin)
    file.write_bytes(around)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        notes = sfumato.read(file).notes
    place = int(next(re.search(r"byte (\d+)", note) for note in notes if "chunk 1, " in note).group(1))
    content[place:place + 60] = b"\xff" * 60
    file.write_bytes(content)
    return file


def test_damaged_parts_are_left_out_with_a_warning(damaged):
    with pytest.warns(sfumato.PartialWarning, match=r"^50000 of 120000 points are missing.*strict=True.*chunk 1, ") as caught:
        cloud = sfumato.read(damaged)
    assert len(cloud) == 70_000 and any("chunk 1, " in note and "left out" in note for note in cloud.notes)
    with pytest.warns(sfumato.PartialWarning, match="50000 of 120000") as rendering:
        sfumato.render(damaged, technique="points", size=(32, 24), outputs="rgba")
    # It stands in the lines of who asked.
    assert [warning.filename for warning in (*caught, *rendering)] == [__file__] * 2


def test_strict_refuses_damaged_parts(damaged, scan):
    for read in (sfumato.read, sfumato.Renderer, lambda file, strict: sfumato.render(file, size=(32, 24), strict=strict)):
        with pytest.raises(sfumato.Error, match="chunk 1, ") as caught:
            read(damaged, strict=True)
        assert caught.value.code == "bad_input"
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert len(sfumato.read(scan, strict=True)) > 0
