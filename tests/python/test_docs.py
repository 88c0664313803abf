"""The code of docs/python.md runs, from its first line to its last."""
import pathlib
import re

PAGE = pathlib.Path(__file__).parents[2] / "docs/python.md"


def test_the_page_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"^```python\n(.*?)^```", PAGE.read_text(), re.S | re.M)
    assert len(blocks) >= 6
    names = {}
    for block in blocks:
        exec(compile(block, str(PAGE), "exec"), names)
    assert {file.name for file in tmp_path.iterdir()} == {"courtyard.png", "upper.laz", "camera.json", "look.json", "scene.json"}
    assert names["normals"].shape == (20_000, 3) and names["pixels"].shape == (20_000, 3)
