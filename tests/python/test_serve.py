"""A server for the browser, started and ended from Python."""
import gc
import json
import os
import re
import subprocess
import sys
import time
import urllib.error
import urllib.request

import numpy as np
import pytest

import sfumato


@pytest.fixture(autouse=True)
def has_serve(command):
    if "serve" not in command("help"):
        pytest.skip("the command is built without serve: libboost-dev is missing")


def info(server):
    for _ in range(300):
        try:
            with urllib.request.urlopen(server.address + "info", timeout=30) as answer:
                return json.load(answer)
        except urllib.error.HTTPError:
            time.sleep(0.1)
    raise AssertionError("it is not ready")


def test_a_file_is_served_until_it_is_stopped(scan):
    server = sfumato.serve(scan, technique="points", height=420)
    assert re.fullmatch(r"http://127\.0\.0\.1:\d+/[0-9a-f]{32}/", server.address)
    assert info(server)["technique"]["name"] == "points"
    shown = server._repr_html_()
    assert f'<iframe src="{server.address}"' in shown and 'height="420"' in shown
    server.stop()
    server.stop()
    assert not server.running and "ended" in server._repr_html_() and "ended" in repr(server)
    with pytest.raises(urllib.error.URLError):
        urllib.request.urlopen(server.address, timeout=5)


def test_arrays_are_served_within_a_with():
    xyz = np.random.default_rng(1).normal(size=(500, 3))
    with sfumato.serve(xyz, max_points=400, color="red") as server:
        assert info(server)["scene"]["points_shown"] == 400
        process, folder = server._process, server._end.peek()[2][1]
        assert os.path.exists(folder)
    assert process.poll() is not None and not os.path.exists(folder)


def test_nobody_refers_to_it(scan):
    process = sfumato.serve(scan)._process
    gc.collect()
    assert process.poll() is not None


def test_it_ends_with_python(scan):
    done = subprocess.run([sys.executable, "-c", "import sfumato, sys; s = sfumato.serve(sys.argv[1]); print(s._process.pid)", str(scan)],
                          capture_output=True, text=True, check=True)
    assert not os.path.exists(f"/proc/{int(done.stdout)}")


@pytest.mark.parametrize("points, options, code, says", [
    ("nowhere.laz", {}, "io", "nowhere.laz"),
    (None, {"point_sise": 2}, "usage", "point-size"),
    (None, {"technique": "nonsense"}, "usage", "nonsense"),
    (None, {"output": "x.png"}, "usage", "does not go with serve"),
])
def test_mistakes_are_the_commands(scan, points, options, code, says):
    with pytest.raises(sfumato.Error, match=says) as raised:
        sfumato.serve(points or scan, **options)
    assert raised.value.code == code


def test_without_the_command(scan, monkeypatch):
    monkeypatch.delenv("SFUMATO_COMMAND")
    monkeypatch.setenv("PATH", "")
    with pytest.raises(sfumato.Error, match="SFUMATO_COMMAND"):
        sfumato.serve(scan)
