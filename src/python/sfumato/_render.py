"""From clouds to pictures."""
import os

from . import _engine, _progress
from ._camera import Camera, orbit, path
from ._cloud import Cloud, as_cloud
from ._error import Error
from ._techniques import settings_of

ALL_OUTPUTS = ("rgba", "linear", "depth", "normal")
_KEYWORDS = ("colors", "technique", "camera", "size", "normals", "scalars", "radii", "background", "up", "color", "color_by",
             "colormap", "range", "hide_classes", "whole", "draw", "outputs", "progress")


class Picture:
    """One view. Arrays have the top row first; they are views of the picture, and None for outputs that were not asked for.
    A notebook shows the picture by itself."""

    def __init__(self, shot):
        self._shot = shot

    @property
    def rgba(self):
        """uint8 (height, width, 4): sRGB, straight alpha."""
        return self._shot.rgba()

    @property
    def linear(self):
        """float32 (height, width, 4): linear light, premultiplied by alpha."""
        return self._shot.linear()

    @property
    def depth(self):
        """float32 (height, width): along the view axis, scene units; inf where nothing is."""
        return self._shot.depth()

    @property
    def normal(self):
        """float32 (height, width, 3): world, unit, facing the camera; 0 where there is none."""
        return self._shot.normal()

    @property
    def alpha(self):
        """float32 (height, width): what the points cover, from 0 to 1; 1 everywhere unless the background is transparent."""
        if self.linear is not None:
            return self.linear[..., 3]
        return None if self.rgba is None else (self.rgba[..., 3] / 255).astype("float32")

    @property
    def camera(self):
        """The `Camera` of the view."""
        return Camera._of(self._shot.camera)

    @property
    def size(self):
        """(width, height), pixels."""
        return self._shot.camera.size

    @property
    def technique(self):
        """The technique's name: what "auto" became."""
        return self._shot.technique

    @property
    def reason(self):
        """Why "auto" chose the technique; empty when it was named."""
        return self._shot.reason

    @property
    def parameters(self):
        """Every parameter of the technique by name, with what automatic values became."""
        return dict(self._shot.parameters)

    @property
    def analysis_parameters(self):
        """Those of what was measured before rendering."""
        return dict(self._shot.analysis_parameters)

    @property
    def color_by(self):
        """What the colours show: "rgb", "elevation" ..., what "auto" became."""
        return self._shot.color_by

    @property
    def background(self):
        """sRGB from 0 to 1."""
        return self._shot.background

    @property
    def notes(self):
        """What is worth knowing about the picture, a list of lines."""
        return self._shot.notes

    def save(self, file, quality=90):
        """Writes .png .jpg .webp (sRGB), .exr (linear, with depth and normals where they were asked for) or .npy (linear).

        `quality` from 1 to 100 is that of .jpg and .webp. PNG and EXR keep camera and technique. The file appears when it is
        complete. Raises `Error`: "usage" for other extensions, "io".
        """
        if not 1 <= quality <= 100:
            raise Error(f"quality: {quality} is not in 1..100")
        file = os.fspath(file)
        self._shot.save(file, os.path.splitext(file)[1].lower(), int(quality))

    def _repr_png_(self):
        if self.rgba is None:
            return None
        import tempfile

        with tempfile.TemporaryDirectory() as folder:
            name = os.path.join(folder, "picture.png")
            self.save(name)
            with open(name, "rb") as file:
                return file.read()

    def __array__(self, dtype=None, copy=None):
        import numpy as np

        return np.asarray(self.rgba, dtype)

    def __repr__(self):
        return f"<Picture {self.size[0]}x{self.size[1]} of {self.technique}, coloured by {self.color_by}>"


def _size(size):
    width, height = size
    return int(width), int(height)


def _color_text(name, value):
    """A colour's name, or numbers from 0 to 1."""
    if value is None or isinstance(value, str):
        return value
    values = [float(v) for v in value]
    if len(values) != 3 or not all(0 <= v <= 1 for v in values):
        raise Error(f"{name}: give a colour's name, #hex or three numbers from 0 to 1")
    return ",".join(repr(v) for v in values)


def _color_wishes(color, color_by, colormap, range):
    wishes = {"color": _color_text("color", color), "color_by": color_by, "colormap": colormap,
              "range": None if range is None else tuple(float(v) for v in range)}
    return {name: value for name, value in wishes.items() if value is not None}


class Renderer:
    """One cloud for many pictures: points are sorted, measured and brought to the GPU once.

    >>> with sfumato.Renderer("scan.laz", technique="surface") as renderer:
    ...     for picture in renderer.frames(renderer.orbit(60)):
    ...         ...

    The parameters are those of `render`. Any thread may use it; all renderers share one OpenGL context and take turns.
    """

    def __init__(self, points, colors=None, technique="auto", normals=None, scalars=None, radii=None, background="auto",
                 up=None, color=None, color_by=None, colormap=None, range=None, hide_classes=(7, 18), whole=False, draw=(),
                 progress=None, **parameters):
        settings = settings_of(parameters, _KEYWORDS)
        if isinstance(colors, str):
            color, colors = colors, None
        own = None
        if isinstance(points, Cloud):
            if any(each is not None for each in (colors, normals, scalars, radii)):
                raise Error("a Cloud brings its own colours, normals, scalars and radii; set them there")
            own = points
        elif isinstance(points, (str, os.PathLike)) or all(each is None for each in (colors, normals, scalars, radii)):
            cloud = as_cloud(points, progress)
        else:
            cloud = Cloud(points, colors, normals, scalars, radii, progress=progress)
        wishes = _color_wishes(color, color_by, colormap, range)
        wishes["hide_classes"] = [int(each) for each in hide_classes or ()]
        wishes["background"] = _color_text("background", background) or "auto"
        wishes["up"] = up
        wishes["whole"] = bool(whole)
        wishes["draw"] = [draw] if isinstance(draw, str) else [str(rule) for rule in draw]
        # A cloud that nobody else sees is handed over.
        self._stage = _engine.Stage((own or cloud)._engine, own is None, technique, settings, wishes, _progress.callback(progress))

    def render(self, camera=None, size=None, technique=None, outputs=ALL_OUTPUTS, progress=None, **parameters):
        """A `Picture`. Everything is as in the function `render`; technique and parameters given here hold for this
        picture, on top of those of the renderer. What another technique needs is computed once."""
        return self._render(self._camera(camera, size), size, technique, outputs, None, progress, settings_of(parameters, _KEYWORDS))

    def _render(self, camera, size, technique, outputs, light_from, progress, settings):
        outputs = [outputs] if isinstance(outputs, str) else list(outputs)
        return Picture(self._stage.render(camera, _size(size or (1280, 720)), technique, settings, outputs, light_from,
                                          _progress.callback(progress)))

    def _camera(self, camera, size):
        """None is the first view of `size`."""
        if camera is None:
            return None
        if isinstance(camera, (str, os.PathLike)):
            name = os.fspath(camera)
            camera = Camera.load(name) if name.endswith(".json") else self.view(name, **({"size": size} if size else {}))
        elif isinstance(camera, dict):
            camera = self.view(**{"size": size or (1280, 720), **camera})
        if not isinstance(camera, _engine.Camera):
            raise Error("camera: give a Camera, the name of a side, angles as a dict, or a JSON file")
        if size is None or _size(size) == camera.size:
            return camera
        if camera.custom_intrinsics:
            raise Error("size does not go with the intrinsics of a camera: they hold for its own width and height")
        return camera.resized(*_size(size))

    def view(self, side=None, azimuth=None, elevation=None, zoom=1.0, roll=0.0, look_at=None, distance=None, fov=None,
             orthographic=False, size=(1280, 720)):
        """A `Camera` that shows the cloud.

        Parameters
        ----------
        side : "front", "back", "left", "right", "top", "bottom" or "iso", optional
        azimuth, elevation : float, optional
            Degrees: the turn about the up axis, 0 from the front, and the height above the horizon, -90 to 90. What suits
            the scan where they are not given.
        zoom : float
            Shows things so many times as large.
        roll : float
            Degrees about the direction of view, counter-clockwise.
        look_at : three numbers, optional
            World: looks at this place from the same side.
        distance : float, optional
            From the place looked at, scene units.
        fov : float, optional
            Full vertical angle in degrees, from where 45 degrees show everything.
        orthographic : bool
            Parallel projection.
        size : (width, height)
            Pixels.
        """
        wishes = {"zoom": float(zoom), "roll": float(roll), "orthographic": bool(orthographic), "size": _size(size)}
        if side is not None:
            if azimuth is not None or elevation is not None:
                raise Error("a side and azimuth or elevation contradict each other: give one of them")
            azimuth, elevation = _engine.find_view(side)
            wishes["upright"] = True
        for name, value in (("azimuth", azimuth), ("elevation", elevation), ("distance", distance), ("fov", fov)):
            if value is not None:
                wishes[name] = float(value)
        if look_at is not None:
            wishes["look_at"] = tuple(float(v) for v in look_at)
        return Camera._of(self._stage.view(wishes))

    def orbit(self, frames=120, degrees=360.0, start=None, size=None):
        """A turn about the up axis: a list of `Camera`, the first of which is `start` or the first view."""
        camera = self._camera(start, size) or self._stage.first_view(*_size(size or (1280, 720)))
        return orbit(camera, frames, degrees, self._stage.up_vector)

    def frames(self, cameras, technique=None, outputs=("rgba",), progress=None, **parameters):
        """Yields a `Picture` for each camera. The light stays where it is for the first.

        `cameras` are any of what `render` takes; `progress` counts pictures where they have a length.
        """
        settings = settings_of(parameters, _KEYWORDS)
        report = _progress.callback(progress)
        total = len(cameras) if hasattr(cameras, "__len__") else None
        first = None
        for number, camera in enumerate(cameras):
            camera = self._camera(camera, None) or self._stage.first_view(1280, 720)
            # A single picture has the light of single pictures.
            first = first or (camera if total != 1 else None)
            yield self._render(camera, None, technique, outputs, first, None, settings)
            if report and total:
                report((number + 1) / total, "frames")

    def video(self, file, cameras, fps=30, technique=None, progress=None, **parameters):
        """Writes the frames as a video (.mp4 .webm .mkv .gif ...: what ffmpeg makes of the extension).

        Raises `Error` ("usage") when there is no ffmpeg.
        """
        import shutil
        import subprocess

        program = shutil.which("ffmpeg")
        if not program:
            raise Error("video: there is no ffmpeg here; install it, or save the pictures of renderer.frames(cameras) one by one")
        file, process, size = os.fspath(file), None, None
        try:
            for picture in self.frames(cameras, technique, ("rgba",), progress, **parameters):
                if process is None:
                    size = picture.size
                    # Video codecs want even sizes and subsample colours; a GIF needs neither.
                    for_codec = [] if file.lower().endswith(".gif") else [
                        "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p"]
                    process = subprocess.Popen(
                        [program, "-loglevel", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgba", "-s", f"{size[0]}x{size[1]}",
                         "-r", str(fps), "-i", "-", *for_codec, "-r", str(fps), file],
                        stdin=subprocess.PIPE, stderr=subprocess.PIPE)
                if picture.size != size:
                    raise Error(f"video: a frame has {picture.size} pixels, the first had {size}")
                process.stdin.write(picture.rgba.tobytes())
            if process is None:
                raise Error("video: there are no cameras")
            _, said = process.communicate()
            if process.returncode != 0:
                raise Error(f"{file}: ffmpeg failed: {said.decode(errors='replace').strip().splitlines()[-1:]}", "io")
        except BrokenPipeError:
            said = process.stderr.read().decode(errors="replace").strip()
            raise Error(f"{file}: ffmpeg failed: {said}", "io") from None
        finally:
            if process and process.poll() is None:
                process.kill()
                process.wait()

    def color(self, color=None, color_by=None, colormap=None, range=None):
        """Other colours for the same points, as in `render`."""
        self._stage.set_color(_color_wishes(color, color_by, colormap, range))

    @property
    def technique(self):
        """The name of the technique: what "auto" became."""
        return self._stage.technique

    @property
    def up(self):
        """The axis that is up: what "auto" became."""
        return self._stage.up

    def __len__(self):
        return len(self._stage)

    def close(self):
        """Frees the GPU's memory; so does deleting the renderer."""
        self._stage.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


def render(points, colors=None, technique="auto", camera=None, size=None, normals=None, scalars=None, radii=None,
           background="auto", up=None, color=None, color_by=None, colormap=None, range=None, hide_classes=(7, 18), whole=False,
           draw=(), outputs=ALL_OUTPUTS, progress=None, **parameters):
    """A picture of points: the same bytes as the command gives for the same view and parameters.

    >>> sfumato.render(xyz, rgb, technique="surface", shadows="soft").save("scan.png")

    Parameters
    ----------
    points : array (N, 3), path, `Cloud`, or a point cloud of another library
        World coordinates, scene units, float32 or float64; see `Cloud` for what else is taken, `read` for files.
    colors : array (N, 3) or (N, 4), or one colour, optional
        sRGB, bytes or floats from 0 to 1; "steelblue" paints every point alike.
    technique : str
        "auto" (what suits the scan), "points", "splats", "surface", "soft", "layers", "denoise" or "strokes".
    camera : `Camera`, str, dict, path, optional
        By default the view from the side that suits the scan. "top", "iso" ... names a side,
        ``{"azimuth": 30, "elevation": 20, "zoom": 2}`` takes what `Renderer.view` does, a .json file is read.
    size : (width, height), optional
        Pixels; the camera's, else (1280, 720).
    normals, scalars, radii
        As in `Cloud`.
    background : colour, "auto" or "transparent"
        A name, "#hex" or three numbers from 0 to 1; "auto" contrasts with the points.
    up : "+Z", "-Y" ..., optional
        The axis that points up; what the file says, else what the shape tells.
    color : colour, optional
        One colour for all points.
    color_by : str, optional
        "rgb", "intensity", "classification", "elevation", "normal", "clay", "file" or any scalar.
    colormap : str, optional
        `colormaps()` lists them.
    range : (low, high), optional
        Values at the ends of the colour map; the 2-98 % percentiles.
    hide_classes : list of int
        Classification codes that are left out, with withheld points: noise. () shows all.
    whole : bool
        Draws a room with the walls that hide it from outside.
    draw : list of str
        Other techniques for some points: "classification 3-5: soft opacity=0.2". The first rule that selects a point draws
        it; the others are drawn by `technique`. As ``--draw`` of the command.
    outputs : list of "rgba", "linear", "depth", "normal"
        Which arrays the picture has; fewer are faster.
    progress : function of (share, text) or a tqdm bar, optional
    **parameters
        Any parameter of the technique (`techniques`) or the analysis: ``point_size=2``, ``shadows="soft"``, ``samples=8``.

    Returns
    -------
    Picture

    Raises
    ------
    Error
        "usage" for names and values that do not exist (it names the nearest), "bad_input", "no_gl" without an OpenGL 4.5
        driver (software will do), "out_of_memory".
    """
    renderer = Renderer(points, colors, technique, normals, scalars, radii, background, up, color, color_by, colormap, range,
                        hide_classes, whole, draw, progress, **parameters)
    with renderer:
        return renderer.render(camera, size, None, outputs, progress)


def colormaps():
    """The names of the colour maps."""
    return list(_engine.colormap_names())
