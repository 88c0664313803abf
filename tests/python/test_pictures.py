"""Pictures, many of one cloud, and what else happens meanwhile."""
import os
import shutil
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import sfumato
from png import read_png

SMALL = (96, 64)


def run(code, **environment):
    """A program of its own."""
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120, check=False,
                          env={**os.environ, **environment})


def test_arrays_of_a_picture(sphere):
    picture = sfumato.render(*sphere[:1], size=SMALL, background="transparent", technique="splats")
    assert picture.rgba.shape == (64, 96, 4) and picture.rgba.dtype == np.uint8
    assert picture.linear.shape == (64, 96, 4) and picture.linear.dtype == np.float32
    assert picture.depth.shape == (64, 96) and picture.depth.dtype == np.float32
    assert picture.normal.shape == (64, 96, 3) and picture.normal.dtype == np.float32
    hit = np.isfinite(picture.depth)
    assert 0.1 < hit.mean() < 0.9
    assert picture.alpha[32, 48] == 1 and picture.alpha[0, 0] == 0 and picture.rgba[0, 0, 3] == 0
    # The camera's own numbers lead from depth back to the sphere of radius 2.
    radius = np.linalg.norm(picture.camera.unproject(picture.depth)[hit], axis=-1)
    assert np.median(np.abs(radius - 2)) < 0.02  # discs on a sphere with 0.07 between points stand off by 0.001
    normal = picture.normal[32, 48]
    assert np.linalg.norm(normal) == pytest.approx(1, abs=1e-3) and np.dot(normal, picture.camera.direction) < -0.9
    assert picture.size == SMALL and picture.technique == "splats" and picture.parameters["samples"] >= 1
    rgba = picture.rgba
    del picture
    assert rgba[32, 48, 3] == 255  # arrays outlive the picture


@pytest.mark.parametrize("extension", ["png", "jpg", "webp", "exr", "npy"])
def test_pictures_are_saved(tmp_path, sphere, extension):
    picture = sfumato.render(sphere[0], size=SMALL)
    file = tmp_path / f"p.{extension}"
    picture.save(file)
    start = {"png": b"\x89PNG", "jpg": b"\xff\xd8\xff", "webp": b"RIFF", "exr": b"\x76\x2f\x31\x01", "npy": b"\x93NUMPY"}[extension]
    assert file.read_bytes().startswith(start)
    if extension == "png":
        assert (read_png(file) == picture.rgba[..., :3]).all()
    if extension == "npy":
        assert (np.load(file) == picture.linear).all()


def test_notebooks_show_pictures(tmp_path, sphere):
    picture = sfumato.render(sphere[0], size=SMALL)
    (tmp_path / "p.png").write_bytes(picture._repr_png_())
    assert (read_png(tmp_path / "p.png") == picture.rgba[..., :3]).all()


def test_edits_of_the_array_are_saved(tmp_path, sphere):
    picture = sfumato.render(sphere[0], size=SMALL)
    picture.rgba[:5, :5] = 255, 0, 0, 255
    picture.save(tmp_path / "p.png")
    assert (read_png(tmp_path / "p.png")[:5, :5] == (255, 0, 0)).all()


def test_scalars_and_one_colour(sphere):
    by_height = sfumato.render(sphere[0], scalars={"height": sphere[0][:, 2]}, color_by="height", size=SMALL)
    assert by_height.color_by == "height"
    red = sfumato.render(sphere[0], "red", size=SMALL, shading="albedo", technique="points", edl=False, background="white")
    assert {tuple(c) for c in np.unique(red.rgba.reshape(-1, 4), axis=0)} >= {(255, 0, 0, 255), (255, 255, 255, 255)}


def test_the_caller_s_arrays_and_clouds_stay(sphere):
    xyz = sphere[0].copy()
    cloud = sfumato.Cloud(xyz)
    sfumato.render(xyz, size=SMALL)
    sfumato.render(cloud, size=SMALL)
    assert (xyz == sphere[0]).all() and (cloud.positions == sphere[0]).all() and len(cloud) == 10_000
    assert (sfumato.render(cloud, size=SMALL).rgba == sfumato.render(xyz, size=SMALL).rgba).all()


def test_renderers_take_turns_on_any_thread(sphere):
    """Contexts belong to a thread, renderers to nobody."""
    clouds = [sphere[0], sphere[0] * np.float32(0.5) + np.float32(1)]
    wanted = [sfumato.render(cloud, size=SMALL, technique="surface").rgba.copy() for cloud in clouds]
    renderers = [sfumato.Renderer(cloud, technique="surface") for cloud in clouds]
    failed = []

    def work(k):
        for _ in range(5):
            if not (renderers[k].render(size=SMALL).rgba == wanted[k]).all():
                failed.append(k)

    threads = [threading.Thread(target=work, args=(k % 2,)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not failed
    renderers[0].close()
    with pytest.raises(sfumato.Error, match="the renderer is closed"):
        renderers[0].render()


def test_other_threads_run_while_one_renders():
    ticks, stop = [], threading.Event()

    def tick():
        while not stop.wait(0.005):
            ticks.append(time.monotonic())

    thread = threading.Thread(target=tick)
    thread.start()
    start = time.monotonic()
    sfumato.render(sfumato.synth("tori", points=400_000), technique="soft", size=(320, 240))
    end = time.monotonic()
    stop.set()
    thread.join()
    inside = [t for t in ticks if start < t < end]
    # With the interpreter's lock held, none would run but one at each end; how many do is the machine's.
    assert len(inside) > 2


def test_progress_is_told(sphere):
    told = []
    sfumato.render(sfumato.synth("tori", points=300_000), technique="strokes", size=SMALL, progress=lambda *each: told.append(each))
    assert told and all(0 <= share <= 1 and isinstance(text, str) and text for share, text in told)

    class Bar:  # what tqdm has
        n, total, texts = 0.0, None, []
        def reset(self, total): self.n, self.total = 0.0, total
        def update(self, step): self.n += step
        def set_description(self, text, refresh): self.texts.append(text)

    bar = Bar()
    sfumato.render(sphere[0], size=SMALL, progress=bar)
    assert bar.total == 1.0 and bar.n == pytest.approx(1) and bar.texts


def test_what_progress_raises_stops_the_work():
    class Enough(Exception):
        pass

    def enough(share, text):
        raise Enough(text)

    with pytest.raises(Enough):
        sfumato.render(sfumato.synth("tori", points=500_000), technique="strokes", size=SMALL, progress=enough)
    assert sfumato.render(np.eye(3), size=SMALL).rgba is not None  # and all goes on


def test_ctrl_c_stops_the_work():
    threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    start = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        while time.monotonic() - start < 60:
            sfumato.render(sfumato.synth("courtyard", points=1_000_000), technique="strokes", size=(640, 480))
    assert time.monotonic() - start < 30


def test_importing_loads_neither_gl_nor_other_packages():
    """`make bench BENCH=python` has the time."""
    code = "import sys; before = set(sys.modules); import sfumato; " \
           "new = {name.split('.')[0] for name in set(sys.modules) - before} - set(sys.stdlib_module_names); " \
           "print(any('libEGL' in line or 'libGL' in line for line in open('/proc/self/maps')), new)"
    assert run(code).stdout == "False {'sfumato'}\n"


def test_no_driver_is_said_in_one_line():
    done = run("import sfumato, numpy\ntry:\n  sfumato.render(numpy.eye(3))\nexcept sfumato.Error as e:\n  print(e.code, e)",
               __EGL_VENDOR_LIBRARY_FILENAMES="/nowhere", LIBGL_DRIVERS_PATH="/nowhere")
    assert done.stdout.startswith("no_gl no OpenGL") and done.stdout.count("\n") == 1, done.stdout + done.stderr


def test_the_end_of_the_interpreter_is_quiet():
    """Renderers and pictures that still live, threads that wait."""
    done = run("import sfumato, numpy\nr = sfumato.Renderer(numpy.eye(3))\np = r.render(size=(64, 48))\nprint(p.rgba.shape)")
    assert done.returncode == 0 and done.stderr == "" and done.stdout == "(48, 64, 4)\n"


def test_a_fork_after_rendering_is_refused_before_it_hangs():
    done = run("import os, sfumato, numpy\nsfumato.render(numpy.eye(3), size=(64, 48))\nif os.fork() == 0:\n"
               "  try:\n    sfumato.render(numpy.eye(3), size=(64, 48))\n  except sfumato.Error as e:\n    print(e.code, e, flush=True)\n"
               "  os._exit(0)\nos.wait()")
    assert done.stdout.startswith("no_gl OpenGL does not survive a fork") and done.returncode == 0, done.stdout + done.stderr


def test_videos(tmp_path, sphere):
    with sfumato.Renderer(sphere[0], technique="points") as renderer:
        cameras = renderer.orbit(4, size=(63, 47))  # odd sizes, which codecs do not take
        if not shutil.which("ffmpeg"):
            with pytest.raises(sfumato.Error, match="there is no ffmpeg here; install it"):
                renderer.video(tmp_path / "turn.mp4", cameras)
            return
        renderer.video(tmp_path / "turn.mp4", cameras, fps=10)
        assert b"ftyp" in (tmp_path / "turn.mp4").read_bytes()[:32]
        with pytest.raises(sfumato.Error, match="ffmpeg failed"):
            renderer.video(tmp_path / "turn.nothing", cameras)
        before = (tmp_path / "turn.mp4").read_bytes()
        with pytest.raises(sfumato.Error, match="a frame has"):
            renderer.video(tmp_path / "turn.mp4", cameras + renderer.orbit(1, size=(31, 17)))
        assert (tmp_path / "turn.mp4").read_bytes() == before
        assert [file.name for file in tmp_path.iterdir()] == ["turn.mp4"]


def test_progress_that_raises_when_all_is_done():
    """What was made is freed where its context is, and the interpreter goes on."""
    done = run("import sfumato, numpy\ndef stop(share, text):\n  if share == 1: raise KeyboardInterrupt\n"
               "try:\n  sfumato.Renderer(numpy.random.rand(1000, 3), technique='points', progress=stop)\n"
               "except KeyboardInterrupt:\n  print(sfumato.render(numpy.eye(3), size=(64, 48)).size)\n")
    assert done.stdout == "(64, 48)\n" and done.returncode == 0, done.stdout + done.stderr


def test_closing_while_another_thread_renders(sphere):
    """Either a picture or an error; nothing is used after it is gone."""
    for _ in range(5):
        renderer = sfumato.Renderer(sphere[0], technique="points")
        said = []

        def work():
            try:
                for _ in range(20):
                    assert renderer.render(size=SMALL).parameters["samples"] >= 1
            except sfumato.Error as error:
                said.append(str(error))

        threads = [threading.Thread(target=work) for _ in range(3)]
        for thread in threads:
            thread.start()
        time.sleep(0.05)
        renderer.close()
        for thread in threads:
            thread.join()
        assert all(text == "the renderer is closed" for text in said)


def test_other_colours_for_the_same_renderer(sphere):
    with sfumato.Renderer(sphere[0], scalars={"height": sphere[0][:, 2]}) as renderer:
        first = renderer.render(size=SMALL).rgba.copy()
        renderer.color(color_by="height", colormap="turbo")
        picture = renderer.render(size=SMALL)
        assert picture.color_by == "height" and (picture.rgba != first).any()
        assert (picture.rgba == sfumato.render(sphere[0], scalars={"height": sphere[0][:, 2]}, color_by="height", colormap="turbo",
                                               size=SMALL).rgba).all()
        renderer.color()
        assert (renderer.render(size=SMALL).rgba == first).all()


def test_index_says_which_point_is_seen():
    xyz = np.random.default_rng(3).uniform(0, 1, (3000, 3))
    camera = sfumato.Camera(position=(0.5, -2, 0.5), target=(0.5, 0, 0.5), up=(0, 0, 1), size=(64, 48))
    picture = sfumato.render(xyz, technique="points", camera=camera, outputs=["index"], size_mode="pixels", point_size=1)
    assert picture.index.dtype == np.int64 and picture.index.shape == (48, 64)
    assert np.array_equal(picture.index >= 0, np.isfinite(picture.depth))
    seen = picture.index >= 0
    assert np.allclose(xyz[picture.index[seen], 1] + 2, picture.depth[seen], atol=1e-5)
    with pytest.raises(sfumato.Error, match="panorama"):
        sfumato.render(xyz, panorama=True, outputs=["index"])
