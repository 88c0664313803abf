"""Clouds: read, written, made, and taken from arrays."""
import os
from collections.abc import MutableMapping

from . import _convert, _engine, _progress
from ._error import Error, warn_of_damage
from ._look import count_of, request_of
from ._techniques import Parameter, text_of


class Scalars(MutableMapping):
    """Numbers of the points by name: a view of the cloud's memory (float32), or, where the cloud keeps large numbers as an
    offset and a rest (GPS times), their values as a new array (float64). Assigning copies."""

    def __init__(self, engine):
        self._engine = engine

    def __getitem__(self, name):
        if name not in self._engine.scalar_types():
            # Mapping's own methods (`in`, `get`) ask for a KeyError.
            near = _engine.nearest_word(name, list(self)) if isinstance(name, str) else ""
            raise _NoScalar(f"the cloud has no scalar '{name}'" + (f"; did you mean '{near}'?" if near else f"; there are: {', '.join(self) or 'none'}"))
        return self._engine.scalar(name)

    def __setitem__(self, name, values):
        self._engine.set_scalar(name, values)

    def __delitem__(self, name):
        raise Error("scalars stay with their cloud; take those you want into a new one")

    def __iter__(self):
        return iter(self._engine.scalar_types())

    def __len__(self):
        return len(self._engine.scalar_types())

    def __repr__(self):
        return f"<scalars: {', '.join(self) or 'none'}>"


class _NoScalar(Error, KeyError):
    def __str__(self):
        return Exception.__str__(self)


class Cloud:
    """Points with what is known of them. The arrays are views of the cloud's own memory: writing to them changes the cloud.

    Parameters
    ----------
    xyz : array (N, 3)
        World coordinates, scene units. Float64 keeps its digits: the cloud stores an `origin` in double and the rest in
        float32. Points that are not finite are left out (`kept`).
    colors : array (N, 3) or (N, 4), optional
        sRGB, bytes from 0 to 255, floats from 0 to 1, or 16 bit.
    normals : array (N, 3), optional
        Of any length; zero where unknown.
    scalars : dict of arrays (N,), optional
        Any numbers by name. `intensity`, `classification` (ASPRS codes), `uncertainty` and `shadow` (0 dark to 1 lit, drawn with
        ``shadows="stored"``) mean something to rendering.
    radii : array (N,), optional
        Scene units.
    up : "+Z", "-Y" ..., optional
        The axis that points up; what the shape tells unless given.
    crs : str
        Coordinate reference system, WKT or "EPSG:n".

    `Cloud(thing)` also takes a structured array or a data frame with x, y and z (laspy, PDAL, pandas, pyntcloud), a point
    cloud of Open3D or trimesh, and a mesh of PyVista. Each array is copied once.
    """

    __slots__ = ("_engine",)

    def __init__(self, xyz, colors=None, normals=None, scalars=None, radii=None, up=None, crs="", progress=None):
        columns = None if isinstance(xyz, (list, tuple)) else _convert.columns_of_object(xyz)
        if columns is None:
            columns = _convert.columns_of(xyz, colors, normals, scalars, radii)
        elif any(each is not None for each in (colors, normals, scalars, radii)):
            # What is given beside a foreign cloud wins over what it brings.
            given = _convert.columns_of(_xyz_of(columns), colors, normals, scalars, radii)[3:]
            names = {name for name, _, _ in given}
            columns = [column for column in columns if column[0] not in names] + given
        self._engine = _engine.from_columns(columns, up, crs, _progress.callback(progress))

    @classmethod
    def _of(cls, engine):
        cloud = cls.__new__(cls)
        cloud._engine = engine
        return cloud

    @property
    def positions(self):
        """float32 (N, 3), relative to `origin`: a view."""
        return self._engine.positions()

    @property
    def xyz(self):
        """float64 (N, 3), world coordinates: a new array."""
        return self._engine.world()

    @property
    def origin(self):
        """World position of the local (0, 0, 0): three floats. Setting it moves the cloud."""
        return self._engine.origin

    @origin.setter
    def origin(self, value):
        self._engine.origin = value

    @property
    def colors(self):
        """uint8 (N, 4), sRGB and alpha: a view; None when the points have no colours."""
        return self._engine.colors()

    @property
    def normals(self):
        """float32 (N, 3), unit or zero: a view; None when there are none. Assigning copies and makes them unit vectors."""
        return self._engine.normals()

    @normals.setter
    def normals(self, values):
        self._engine.set_normals(values)

    @property
    def radii(self):
        """float32 (N,), scene units: a view; None when there are none."""
        return self._engine.radii()

    @property
    def scalars(self):
        """Numbers by name; see `Scalars`. ``cloud.scalars["height"] = values`` adds some."""
        return Scalars(self._engine)

    @property
    def up(self):
        """"+Z", "-Y" ...: what the user says is up, None where the file or the shape decides."""
        return self._engine.up

    @up.setter
    def up(self, value):
        self._engine.up = value

    @property
    def crs(self):
        """Coordinate reference system as text, may be empty."""
        return self._engine.crs

    @crs.setter
    def crs(self, value):
        self._engine.crs = value

    @property
    def bounds(self):
        """World-space box: ((x, y, z) of the low corner, (x, y, z) of the high one)."""
        return self._engine.bounds

    @property
    def kept(self):
        """uint32: the rows of the arrays that became points; None when all did."""
        return self._engine.kept()

    @property
    def notes(self):
        """What reading had to guess or leave out, a list of lines."""
        return self._engine.notes

    def __len__(self):
        return len(self._engine)

    def __getitem__(self, which):
        """The points that a mask, a slice or an array of indices picks, as a new cloud."""
        import numpy as np

        if not isinstance(which, slice):
            which = np.asarray(which)
            if which.ndim != 1 or which.dtype.kind not in "iub":
                raise Error("a cloud is picked from with a mask, a slice or a list of indices")
            if which.dtype.kind == "b" and len(which) != len(self):
                raise Error(f"found a mask of {len(which)}, expected {len(self)}")
            if which.dtype.kind == "i" and len(which) and (which.min() < -len(self) or which.max() >= len(self)):
                raise Error(f"an index is outside the {len(self)} points")
        return Cloud._of(self._engine.pick(np.arange(len(self), dtype=np.uint32)[which]))

    def __array__(self, dtype=None, copy=None):
        xyz = self.xyz
        return xyz if dtype is None else xyz.astype(dtype)

    def __repr__(self):
        has = [name for name in ("colors", "normals", "radii") if getattr(self, name) is not None]
        size = [f"{high - low:.4g}" for low, high in zip(*self.bounds)]
        return f"<Cloud of {len(self):,} points, {' x '.join(size)}; {', '.join(has + list(self.scalars)) or 'positions only'}>"

    def to_structured(self, names="plain"):
        """A record a point: x, y, z (float64), then nx, ny, nz, red, green, blue, alpha, radius and the scalars of the types
        that their file had. A new array.

        `names`: "plain", as laspy and pyntcloud spell them, or "pdal": X, Y, Z, Red (16 bits, as LAS has them), GpsTime ...
        """
        import numpy as np

        if names not in ("plain", "pdal"):
            raise Error(f"names: '{names}' is not one of plain, pdal")

        columns = [(axis, self.xyz[:, k]) for k, axis in enumerate("xyz")]
        for group, values in ((("nx", "ny", "nz"), self.normals), (("red", "green", "blue", "alpha"), self.colors)):
            if values is not None:
                columns += [(name, values[:, k]) for k, name in enumerate(group)]
        if self.radii is not None:
            columns.append(("radius", self.radii))
        types = self._engine.scalar_types()
        for name, values in self.scalars.items():
            # A type of whole numbers has no place for what is missing.
            fits = np.isfinite(values).all() or np.dtype(types[name]).kind == "f"
            columns.append((name, values.astype(types[name]) if fits else values))
        if names == "pdal":
            columns = [(_convert.pdal_name(name), values.astype(np.uint16) * np.uint16(257) if name in ("red", "green", "blue") else values)
                       for name, values in columns]
        records = np.empty(len(self), [(name, values.dtype) for name, values in columns])
        for name, values in columns:
            records[name] = values
        return records


def _xyz_of(columns):
    import numpy as np

    columns = {name: values for name, values, _ in columns}
    return np.stack([columns[axis] for axis in "xyz"], axis=1)


def as_cloud(points, progress=None):
    """A `Cloud` as it is; files, arrays and clouds of other libraries as one."""
    if isinstance(points, Cloud):
        return points
    if isinstance(points, (str, os.PathLike)):
        return read(points, progress=progress)
    return Cloud(points, progress=progress)


def read(files, *more, columns=(), max_points=None, crop=None, crop_relative=None, show_classes=None, hide_classes=None,
         filters=(), up=None, every_attribute=False, strict=False, vertices=True, progress=None):
    """Reads point clouds: LAS, LAZ, COPC, E57, PLY, PCD, PTX, XYZ and more (`formats`).

    Several files become one scene, with the scalar `file` that tells them apart.

    Parameters
    ----------
    files : path, or list of paths
        Files, folders and patterns with ``*``.
    columns : list of str
        Names of the columns of text files, instead of a guess.
    max_points : int, optional
        A subsample of what is left, the same one every time.
    crop, crop_relative : six numbers, optional
        x0, y0, z0, x1, y1, z1: only the points in this box, in world coordinates or in shares of the whole box.
    show_classes, hide_classes : list of int, optional
        ASPRS codes. Rendering leaves out noise by itself.
    filters : list of str
        Only points whose number lies there: ``"intensity 10..200"``, ``"z 3.."``.
    up : "+Z", "-Y" ..., optional
        Wins over what the files say.
    every_attribute : bool
        Also those of LAS that are zero everywhere.
    strict : bool
        Refuses LAZ and COPC files of which parts are damaged. Otherwise those parts are left out with a `PartialWarning`, and
        ``notes`` of the cloud names each.
    vertices : bool
        Of meshes the vertices; otherwise points on the faces, as they are rendered.
    progress : function of (share, text) or a tqdm bar, optional

    Raises `Error`: "io" when a file cannot be opened, "bad_input" when it is damaged or holds no points, "usage".
    """
    request = request_of(columns=list(columns) or None, max_points=max_points, crop=crop, crop_relative=crop_relative, show_classes=show_classes,
                         hide_classes=() if hide_classes is None else hide_classes, filters=filters, up=up, strict=bool(strict), vertices=bool(vertices))
    engine = _engine.read(items_of(_words_of(files, more)), request, bool(every_attribute), _progress.callback(progress))
    warn_of_damage(engine)
    return Cloud._of(engine)


class Levels:
    """COPC files, of which only what is needed is read; `open` makes it. `render` and `Renderer` take it as points: each picture
    reads what its view shows."""

    def __init__(self, engine):
        self._engine = engine

    def __len__(self):
        """Points in the files."""
        return len(self._engine)

    @property
    def bounds(self):
        """World-space box of the files: ((x, y, z) of the low corner, (x, y, z) of the high one)."""
        return self._engine.bounds

    @property
    def levels(self):
        """Of the first file, from the coarsest on: (points, spacing in scene units) of each level."""
        return self._engine.levels

    @property
    def crs(self):
        """Coordinate reference system as text, may be empty."""
        return self._engine.crs

    def read(self, cameras=None, max_points=None, shadows=False, panorama=False, progress=None):
        """A `Cloud` of what is needed, and no more points than `open` allows.

        Parameters
        ----------
        cameras : `Camera` or list of them, optional
            Every point that these views can show, near ones in full and far ones coarsely; without cameras whole levels of
            the scan or of `crop`, as many as there is room for.
        max_points : int, optional
            Without cameras: the most points.
        shadows : bool
            What is out of view counts too, coarsely, for it casts shadows.
        panorama : bool
            The cameras look all around.
        """
        report = _progress.callback(progress)
        if cameras is None:
            engine = self._engine.coarse(count_of("max_points", max_points) or len(self), report)
            warn_of_damage(engine)
            return Cloud._of(engine)
        if max_points is not None:
            raise Error("max_points goes with whole levels; for what cameras see give it to sfumato.open")
        cameras = list(cameras) if isinstance(cameras, (list, tuple)) else [cameras]
        if not all(isinstance(camera, _engine.Camera) for camera in cameras):
            raise Error("cameras: give a Camera or a list of them; renderer.view makes one")
        engine = self._engine.read(cameras, bool(panorama), bool(shadows), report)
        warn_of_damage(engine)
        return Cloud._of(engine)

    def __repr__(self):
        size = [f"{high - low:.4g}" for low, high in zip(*self.bounds)]
        return f"<Levels of {len(self):,} points, {' x '.join(size)}; {self._engine.file}>"


def open(files, *more, max_points=None, memory=None, crop=None, crop_relative=None, show_classes=None, hide_classes=None, filters=(),
         up=None, strict=False):
    """Opens COPC files of any size, reading only their hierarchy; ``sfumato build`` makes such files.

    Parameters
    ----------
    files : path, or list of paths
    max_points : int, optional
        The most points that are read at once.
    memory : int or str, optional
        Bytes that their points may take, 100 each: ``"2G"``; 4 GB.
    crop, crop_relative, show_classes, hide_classes, filters, up, strict
        As in `read`. Only the parts of the files that reach into the box are read.

    Returns `Levels`. Raises `Error`: "usage" for files that are not COPC, "io", "bad_input".
    """
    request = request_of(max_points=max_points, memory=memory, crop=crop, crop_relative=crop_relative, show_classes=show_classes,
                         hide_classes=() if hide_classes is None else hide_classes, filters=filters, up=up, strict=bool(strict))
    return Levels(_engine.Levels(items_of(_words_of(files, more)), request))


def _words_of(files, more=()):
    words = [files] if isinstance(files, (str, os.PathLike)) else list(files)
    return [os.fspath(word) for word in (*words, *more)]


def items_of(things, rows=None):
    """Files and clouds as the engine takes them, all of them moved by the same 16 numbers."""
    return [(thing if isinstance(thing, str) else as_cloud(thing)._engine, rows) for thing in things]


def write(file, points, progress=None):
    """Writes a cloud as .las .laz .ply .pcd .xyz .txt .asc .csv or .npy. The file appears when it is complete.

    Returns what the format cannot hold as it was, a list of lines. Raises `Error`: "usage" for other extensions, "io".
    """
    return _engine.write(as_cloud(points)._engine, os.fspath(file), _progress.callback(progress))


def synth(scene, mesh=None, progress=None, **parameters):
    """A scan of a synthetic scene, with normals, colours and the scalars of its devices.

    `scene` is one of `synth.scenes()`, or "mesh" with `mesh` the PLY or OBJ file to sample; parameters are those of
    `synth.parameters()`: ``synth("courtyard", points=100_000, outliers=500)``. The same parameters give the same points.

    Raises `Error` ("usage") that names the nearest scene or parameter.
    """
    if (scene == "mesh") != (mesh is not None):
        raise Error('synth: mesh="FILE.ply" goes with the scene "mesh", and "mesh" needs it')
    settings = [(name, text_of(name, value)) for name, value in parameters.items()]
    mesh = None if mesh is None else os.fspath(mesh)
    return Cloud._of(_engine.synth(scene, settings, mesh, _progress.callback(progress)))


synth.scenes = lambda: list(_engine.scene_names()) + ["mesh"]
synth.parameters = lambda: [Parameter(**row) for row in _engine.synth_parameters()]


def formats():
    """The formats of `read` and `write`: a list of dicts with name, extensions, description, can_read, can_write."""
    return _engine.formats()
