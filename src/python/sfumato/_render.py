"""From clouds to pictures."""
import os

from . import _engine, _progress
from ._camera import Camera, orbit
from ._cloud import Cloud, Levels
from ._error import Error, warn_of_damage
from ._look import FURNITURE, KEYWORDS, Look, furniture_of, is_default, options_of, request_of
from ._scene import Scene
from ._techniques import settings_of, text_of

ALL_OUTPUTS = ("rgba", "linear", "depth", "normal")
_KEYWORDS = ("colors", "camera", "size", "normals", "scalars", "radii", "memory", "strict", "preset", "outputs", "panorama", "progress", *KEYWORDS)


class Picture:
    """One view. Arrays have the top row first; they are views of the picture, and None for outputs that were not asked for.
    A notebook shows the picture by itself."""

    def __init__(self, picture):
        self._picture = picture

    @property
    def rgba(self):
        """uint8 (height, width, 4): sRGB, straight alpha."""
        return self._picture.rgba()

    @property
    def linear(self):
        """float32 (height, width, 4): linear light, premultiplied by alpha."""
        return self._picture.linear()

    @property
    def depth(self):
        """float32 (height, width): along the view axis, scene units; inf where nothing is."""
        return self._picture.depth()

    @property
    def normal(self):
        """float32 (height, width, 3): world, unit, facing the camera; 0 where there is none."""
        return self._picture.normal()

    @property
    def index(self):
        """int64 (height, width): which point is seen, from 0 on and file after file; -1 where none is. Ask for it: outputs=["index"]."""
        return self._picture.index()

    @property
    def alpha(self):
        """float32 (height, width): what the points cover, from 0 to 1; 1 everywhere unless the background is transparent."""
        if self.linear is not None:
            return self.linear[..., 3]
        return None if self.rgba is None else (self.rgba[..., 3] / 255).astype("float32")

    @property
    def camera(self):
        """The `Camera` of the view."""
        return Camera._of(self._picture.camera)

    @property
    def size(self):
        """(width, height), pixels."""
        return self._picture.camera.size

    @property
    def technique(self):
        """The technique's name: what "auto" became."""
        return self._picture.technique

    @property
    def reason(self):
        """Why "auto" chose the technique; empty when it was named."""
        return self._picture.reason

    @property
    def parameters(self):
        """Every parameter of the technique by name, with what automatic values became."""
        return dict(self._picture.parameters)

    @property
    def analysis_parameters(self):
        """Those of what was measured before rendering."""
        return dict(self._picture.analysis_parameters)

    @property
    def color_by(self):
        """What the colours show: "rgb", "elevation" ..., what "auto" became."""
        return self._picture.color_by

    @property
    def legend(self):
        """What the colours mean, as a dict: `title` and either `low`, `high` and `colormap` (a name, or
        "#rrggbb,..." where heights are spread by numbers of points; see `colormap`), or `swatches`: (label,
        (r, g, b), points) each. None where colours explain themselves."""
        return self._picture.legend

    @property
    def background(self):
        """sRGB from 0 to 1."""
        return self._picture.background

    @property
    def notes(self):
        """What is worth knowing about the picture, a list of lines."""
        return self._picture.notes

    def save(self, file, quality=90, dpi=0):
        """Writes .png .jpg .webp .tif (sRGB; the .tif of a plan is a GeoTIFF), .exr (linear, with depth and normals where they were asked for) or .npy (linear).

        `quality` from 1 to 100 is that of .jpg and .webp, `dpi` the pixels an inch on paper (0: none is said). PNG and EXR keep camera and technique. The file appears when it is
        complete. Raises `Error`: "usage" for other extensions, "io".
        """
        if not 1 <= quality <= 100:
            raise Error(f"quality: {quality} is not in 1..100")
        file = os.fspath(file)
        self._picture.save(file, os.path.splitext(file)[1].lower(), int(quality), float(dpi))

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


class Renderer:
    """One cloud for many pictures: points are sorted, measured and brought to the GPU once.

    >>> with sfumato.Renderer("scan.laz", technique="surface") as renderer:
    ...     for picture in renderer.frames(renderer.orbit(60)):
    ...         ...

    The parameters are those of `render`. Any thread may use it; all renderers share one OpenGL context and take turns.
    Of COPC files with more points than `memory` and `max_points` allow, and of `Levels`, each picture reads what it shows.
    """

    def __init__(self, points, colors=None, technique="auto", normals=None, scalars=None, radii=None, background="auto",
                 up=None, color=None, color_by=None, colormap=None, range=None, exposure=None, hide_classes=(7, 18),
                 show_classes=None, filters=(), crop=None, crop_relative=None, max_points=None, memory=None, whole=False, draw=(),
                 preset=None, progress=None, strict=False, vertices=False, class_colors=None, **parameters):
        drawn_on = {name: parameters.pop(name) for name in ("vertical_exaggeration", *FURNITURE) if name in parameters}
        settings = settings_of(parameters, _KEYWORDS)
        if isinstance(colors, str):
            color, colors = colors, None
        given = {"technique": technique, "background": background, "up": up, "color": color, "color_by": color_by,
                 "colormap": colormap, "range": range, "exposure": exposure, "hide_classes": tuple(hide_classes or ()),
                 "show_classes": show_classes, "filters": [filters] if isinstance(filters, str) else list(filters), "crop": crop,
                 "crop_relative": crop_relative, "max_points": max_points, "whole": bool(whole), "vertices": bool(vertices), "class_colors": class_colors,
                 "draw": [draw] if isinstance(draw, str) else [str(rule) for rule in draw]}
        given.update(drawn_on)
        # Iterators are read once, and their values asked for again.
        given = {name: tuple(value) if hasattr(value, "__next__") else value for name, value in given.items()}
        # Each wins over what comes before it: what is always so, the scene, the preset, what is given.
        look = points._look() if isinstance(points, Scene) else Look()
        preset = Look.of(preset)
        wanted = {**KEYWORDS, **look.keywords, **preset.keywords,
                  **{name: value for name, value in given.items() if not is_default(name, value)}}
        self._wanted, self._settings = wanted, settings
        self._preset_parameters, self._preset_file = look.parameters + preset.parameters, preset.file or look.file
        self._first = {**look.view, **preset.view}
        self._first_camera = preset.camera or look.camera
        self._progress = _progress.callback(progress)
        self._furniture = {name: wanted[name] for name in FURNITURE}
        self.legend = wanted["legend"] in (True, "true")

        self._of_reading = {"memory": memory, "strict": bool(strict)}
        self._request = request = self._request_of(wanted)

        sources = None
        if isinstance(points, (str, os.PathLike)):
            sources = [(os.fspath(points), None)]
        elif isinstance(points, (list, tuple)) and points and all(isinstance(each, (str, os.PathLike)) for each in points):
            sources = [(os.fspath(each), None) for each in points]
        elif isinstance(points, Scene):
            sources = points._sources()
        if any(each is not None for each in (colors, normals, scalars, radii)) and (sources or isinstance(points, (Cloud, Levels))):
            raise Error("a Cloud, a file or a scene brings its own colours, normals, scalars and radii; set them there")
        self._has_shadows([])  # what is wrong is said before anything is read
        self._drawn = self._key = None
        if isinstance(points, Levels):
            self._opening = _engine.Opening(points._engine, request, self._progress)
        elif sources:
            self._opening = _engine.Opening(sources, request, self._progress)
        else:
            own = isinstance(points, Cloud)
            cloud = points if own else Cloud(points, colors, normals, scalars, radii, progress=progress)
            self._opening = _engine.Opening(cloud._engine, own, request, self._progress)
        if not self._opening.has_levels:
            self._show(self._opening.take(), bool(sources))

    def _request_of(self, wanted):
        """Of all but what is drawn into single pictures."""
        drawn = {name: value for name, value in wanted.items() if name not in FURNITURE}
        return request_of(options_of(drawn), technique=wanted["technique"], **self._of_reading)

    @property
    def _look(self):
        return self._request, self._settings, self._preset_parameters, self._preset_file

    def _has_shadows(self, settings):
        return _engine.has_shadows(*self._look, settings)

    def _show(self, cloud, is_read=True):
        if is_read:
            warn_of_damage(cloud)
        self._drawn = _engine.CloudRenderer(cloud, self._opening, *self._look, self._progress)

    @property
    def _renderer(self):
        """Of files that are read in parts, with what the last picture needed, or the first view."""
        if self._drawn is None:
            self._read([self._opening.first_view(1280, 720)], False, [])
        return self._drawn

    def _read(self, cameras, panorama, settings):
        """Reads what these views need of files that are read in parts."""
        if not self._opening.has_levels:
            return
        shadows = self._has_shadows(settings)
        key = tuple(camera.to_json() for camera in cameras), panorama, shadows
        if key == self._key:
            return
        self._key = None
        self.close()  # room for what comes
        self._show(self._opening.read(cameras, panorama, shadows, self._progress))
        self._key = key

    def render(self, camera=None, size=None, technique=None, outputs=ALL_OUTPUTS, progress=None, panorama=False, legend=None,
               **parameters):
        """A `Picture`. Everything is as in the function `render`; technique and parameters given here hold for this
        picture, on top of those of the renderer. What another technique needs is computed once."""
        furniture = {name: parameters.pop(name) for name in FURNITURE if name in parameters}
        if legend is not None:
            furniture["legend"] = bool(legend)
        settings = settings_of(parameters, _KEYWORDS)
        camera = self._panorama(camera, size) if panorama else self._camera(camera, size)
        self._read([camera or self._opening.first_view(*_size(size or (1280, 720)))], panorama, settings)
        return self._render(camera, size, technique, outputs, None, progress, settings, panorama, furniture)

    def _render(self, camera, size, technique, outputs, light_from, progress, settings, panorama=False, furniture=()):
        outputs = [outputs] if isinstance(outputs, str) else list(outputs)
        paper = list(getattr(camera, "_paper", ()))
        furniture = paper + furniture_of({**self._furniture, "legend": self.legend, **dict(furniture)})
        return Picture(self._renderer.render(camera, _size(size or (1280, 720)), technique, settings, outputs, light_from, panorama,
                                          furniture, _progress.callback(progress)))

    def _camera(self, camera, size, default=(1280, 720)):
        """None is the first view of `size`."""
        if camera is None:
            if self._first_camera is None and not self._first:
                return None
            request = {**self._first, **({"size": size} if size else {})}
            if self._first_camera is None:
                return self.view(**{**({} if request.keys() & {"pixel_size", "scale"} else {"size": default}), **request})
            return self.view(start=self._first_camera, **request) if request else self._first_camera
        if isinstance(camera, (str, os.PathLike)):
            name = os.fspath(camera)
            camera = Camera.load(name) if name.endswith(".json") else self.view(name, size=size or self._first.get("size", default))
        elif isinstance(camera, dict):
            found = size or self._first.get("size", None if camera.keys() & {"pixel_size", "scale"} else default)
            camera = self.view(**{**({"size": found} if found else {}), **camera})
        if not isinstance(camera, _engine.Camera):
            raise Error("camera: give a Camera, the name of a side, angles as a dict, or a JSON file")
        if size is None or _size(size) == camera.size:
            return camera
        if camera.custom_intrinsics:
            raise Error("size does not go with the intrinsics of a camera: they hold for its own width and height")
        return camera.resized(*_size(size))

    def _panorama(self, camera, size):
        """Where to look around, as the command finds it."""
        stands = camera is None and self._first_camera is not None or isinstance(camera, _engine.Camera)
        stands = stands or isinstance(camera, dict) and camera.get("position") is not None
        stands = stands or isinstance(camera, (str, os.PathLike)) and os.fspath(camera).endswith(".json")
        stands = stands or camera is None and "position" in self._first
        found = self._camera(camera, size, (2048, 1024)) or self._opening.first_view(*_size(size or (2048, 1024)))
        return found if stands else self._opening.inside(found)

    def save_preset(self, file, camera=None):
        """Writes technique, parameters, colours and selection as JSON, for ``preset=`` and ``sfumato --preset``; with a `Camera`
        also the view. The file appears when it is complete."""
        if self._wanted["crop"] is not None:
            raise Error("a preset holds no crop in world coordinates; crop_relative holds for any scan")
        _engine.save_preset(os.fspath(file), self.technique, [*self._preset_parameters, *self._settings], options_of(self._wanted), camera, [])

    def view(self, side=None, azimuth=None, elevation=None, zoom=1.0, roll=0.0, look_at=None, distance=None, fov=None,
             orthographic=False, size=None, position=None, direction=None, view_up=None, start=None, pixel_size=None, scale=None, dpi=300):
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
        size : (width, height), optional
            Pixels; (1280, 720), or those of `start`.
        position : three numbers, optional
            World: stands there, looking at `look_at`, along `direction`, or at the middle.
        direction, view_up : three numbers, optional
            Of the view, and what is up in the picture.
        pixel_size : float, optional
            Scene units per pixel of an orthographic view, in place of `zoom` and `fov`; without `size` the picture is as large as the scan.
        scale : "1:N" or N, optional
            In place of these: print scale of an orthographic view at `dpi` pixels an inch; `Picture.save` keeps them with ``dpi=``.
        start : `Camera`, optional
            Changes this one, in place of the view that shows the scan.
        """
        looks_at = [] if look_at is None else [("look-at" if position is None else "camera-focal-point", text_of("look_at", look_at))]
        request = request_of(
            looks_at, start, side=side, azimuth=azimuth, elevation=elevation, zoom=None if zoom == 1 else zoom, roll=roll, distance=distance, fov=fov,
            orthographic=bool(orthographic), size=None if size is None else "{}x{}".format(*_size(size)), position=position, direction=direction,
            view_up=view_up, pixel_size=pixel_size, scale=scale if scale is None or isinstance(scale, str) else "1:" + text_of("scale", scale),
            dpi=None if scale is None else dpi)
        camera = Camera._of(self._opening.view(request))
        if scale is not None:
            camera._paper = request.paper
        return camera

    def orbit(self, frames=120, degrees=360.0, start=None, size=None):
        """A turn about the up axis: a list of `Camera`, the first of which is `start` or the first view, from as far away as the other sides need.

        Without `start` about what is vertical in the first view: in reconstructions that is across tilted ground.
        """
        camera = self._camera(start, size)
        if camera is not None:
            return orbit(camera, frames, degrees, self._opening.up_vector)
        return orbit(self._opening.first_of_turn(*_size(size or (1280, 720))), frames, degrees, self._opening.vertical)

    def frames(self, cameras, technique=None, outputs=("rgba",), progress=None, **parameters):
        """Yields a `Picture` for each camera. The light stays where it is for the first.

        `cameras` are any of what `render` takes; `progress` counts pictures where they have a length.
        """
        settings = settings_of(parameters, _KEYWORDS)
        report = _progress.callback(progress)
        total = len(cameras) if hasattr(cameras, "__len__") else None
        first, at_once = None, True
        if self._opening.has_levels:  # read once for all of them, as far as memory holds that
            cameras = [self._camera(camera, None) or self._opening.first_view(1280, 720) for camera in cameras]
            shadows = self._has_shadows(settings)
            at_once = len(cameras) == 1 or self._opening.holds(cameras, shadows)
            if at_once:
                self._read(cameras, False, settings)
        for number, camera in enumerate(cameras):
            camera = self._camera(camera, None) or self._opening.first_view(1280, 720)
            if not at_once:
                self._read([camera], False, settings)
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
        stem, extension = os.path.splitext(file)
        part = stem + ".part" + extension  # what was there before stays until the whole is written
        try:
            for picture in self.frames(cameras, technique, ("rgba",), progress, **parameters):
                if process is None:
                    size = picture.size
                    # Video codecs want even sizes and subsample colours; a GIF needs neither.
                    for_codec = [] if file.lower().endswith(".gif") else [
                        "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p"]
                    process = subprocess.Popen(
                        [program, "-loglevel", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgba", "-s", f"{size[0]}x{size[1]}",
                         "-r", str(fps), "-i", "-", *for_codec, "-r", str(fps), part],
                        stdin=subprocess.PIPE, stderr=subprocess.PIPE)
                if picture.size != size:
                    raise Error(f"video: a frame has {picture.size} pixels, the first had {size}")
                process.stdin.write(picture.rgba.tobytes())
            if process is None:
                raise Error("video: there are no cameras")
            _, said = process.communicate()
            if process.returncode != 0:
                raise Error(f"{file}: ffmpeg failed: {said.decode(errors='replace').strip().splitlines()[-1:]}", "io")
            os.replace(part, file)
        except BrokenPipeError:
            said = process.stderr.read().decode(errors="replace").strip()
            raise Error(f"{file}: ffmpeg failed: {said}", "io") from None
        finally:
            if process and process.poll() is None:
                process.kill()
                process.wait()
            if process and os.path.exists(part):
                os.remove(part)

    def color(self, color=None, color_by=None, colormap=None, range=None, exposure=None, class_colors=None):
        """Other colours for the same points, as in `render`."""
        wanted = {**self._wanted, "color": color, "color_by": color_by, "colormap": colormap, "range": range, "exposure": exposure,
                  "class_colors": class_colors}
        request = self._request_of(wanted)
        self._renderer.set_color(request)
        self._wanted, self._request = wanted, request  # also for what is read next

    @property
    def technique(self):
        """The name of the technique: what "auto" became."""
        return self._renderer.technique

    @property
    def up(self):
        """The axis that is up: what "auto" became."""
        return self._opening.up

    def __len__(self):
        return len(self._renderer)

    def close(self):
        """Frees the GPU's memory; so does deleting the renderer."""
        if self._drawn is not None:
            self._drawn.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


def render(points, colors=None, technique="auto", camera=None, size=None, normals=None, scalars=None, radii=None,
           background="auto", up=None, color=None, color_by=None, colormap=None, range=None, exposure=None, hide_classes=(7, 18),
           show_classes=None, filters=(), crop=None, crop_relative=None, max_points=None, memory=None, whole=False, draw=(),
           preset=None, outputs=ALL_OUTPUTS, panorama=False, legend=None, progress=None, strict=False, vertices=False, class_colors=None, **parameters):
    """A picture of points: the same bytes as the command gives for the same view and parameters.

    >>> sfumato.render(xyz, rgb, technique="surface", shadows="soft").save("scan.png")

    Parameters
    ----------
    points : array (N, 3), path, `Cloud`, `Scene`, `Levels`, or a point cloud of another library
        World coordinates, scene units, float32 or float64; see `Cloud` for what else is taken, `read` for files. A list of
        paths is one scene.
    colors : array (N, 3) or (N, 4), or one colour, optional
        sRGB, bytes or floats from 0 to 1; "steelblue" paints every point alike.
    technique : str
        A name of `techniques`, or "auto" (what suits the scan).
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
    exposure : float, optional
        Brightness of the file's own colours, 1: as they are; what suits them.
    class_colors : str, optional
        Colours of classes by code or name, "2=#aa7744,building=orange", or a file with one CLASS=COLOUR per line.
    hide_classes : list of int
        Classification codes that are left out, with withheld points: noise. () shows all.
    show_classes, filters, crop, crop_relative, max_points
        As in `read`.
    memory : int or str, optional
        Bytes that the points of COPC files may take, ``"2G"``; 4 GB. Beyond it, or `max_points`, only what the view shows is read.
    whole : bool
        Draws a room with the walls that hide it from outside, and frames all points but strays.
    draw : list of str
        Other techniques for some points: "classification 3-5: soft opacity=0.2". The first rule that selects a point draws
        it; the others are drawn by `technique`. As ``--draw`` of the command.
    preset : path or dict, optional
        Technique, parameters, colours and view that hold unless others are given here: a file of ``--save-preset`` or
        `Renderer.save_preset`, or keywords.
    outputs : list of "rgba", "linear", "depth", "normal", "index"
        Which arrays the picture has; fewer are faster.
    panorama : bool
        Everything around a place in one picture twice as wide as high, (2048, 1024): around the camera, else where the scanner
        stood, else in the middle. Depth is the distance from there.
    legend : bool
        Explains the colours in a corner of `Picture.rgba`.
    legend_title, legend_unit, legend_place, legend_size, scale_bar, north_arrow, grid, title, caption, unit
        What else is drawn into `Picture.rgba`, as the options of the command: ``scale_bar=True, title="Site 4"``.
    vertical_exaggeration : float, optional
        Heights so many times as large; those of legends stay true.
    progress : function of (share, text) or a tqdm bar, optional
    strict : bool
        As in `read`.
    vertices : bool
        Of meshes the vertices alone, instead of points on their faces.
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
                        exposure, hide_classes, show_classes, filters, crop, crop_relative, max_points, memory, whole, draw, preset,
                        progress, strict, vertices, class_colors, **parameters)
    with renderer:
        return renderer.render(camera, size, None, outputs, progress, panorama, legend)


def contact_sheet(pictures, labels=None):
    """Pictures of one size side by side, each below its label, as ``-t all`` of the command makes them: a `Picture` with `rgba` alone.

    `labels` are by default the names of the techniques.
    """
    pictures = list(pictures)
    labels = [picture.technique for picture in pictures] if labels is None else [str(label) for label in labels]
    if not pictures or len(labels) != len(pictures):
        raise Error(f"contact_sheet: found {len(pictures)} pictures and {len(labels)} labels, expected one label a picture")
    return Picture(_engine.contact_sheet([picture._picture for picture in pictures], labels))


def colormaps():
    """The names of the colour maps."""
    return list(_engine.colormap_names())


def colormap(name, count=256):
    """The colours of a map from its low end to its high one, uint8 (count, 3), sRGB; `colormaps` lists the names."""
    if count < 1:
        raise Error("count: give at least 1")
    return _engine.colormap(name, int(count))
