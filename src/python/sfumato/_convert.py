"""Points of other libraries, without importing any of them."""
from ._error import Error

#: Names of PDAL and others, besides those in CamelCase that become snake_case.
_OTHER_NAMES = {"return_num": "return_number", "num_returns": "number_of_returns", "nb_of_returns": "number_of_returns",
                "reflectance": "intensity", "class": "classification", "normal_x": "nx", "normal_y": "ny",
                "normal_z": "nz"}


def _plain(name):
    """GpsTime is gps_time; X is x."""
    import re

    plain = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower()
    return _OTHER_NAMES.get(plain, plain)


def pdal_name(name):
    """gps_time is GpsTime; x is X."""
    return {"nx": "NormalX", "ny": "NormalY", "nz": "NormalZ"}.get(name) or "".join(word[:1].upper() + word[1:] for word in name.split("_"))


def _numbers(name, values):
    import numpy as np

    values = np.asarray(values)
    if values.dtype == np.float16 or values.dtype == np.longdouble:
        values = values.astype(np.float32 if values.dtype == np.float16 else np.float64)
    if values.dtype.kind not in "fiub":
        raise Error(f"{name}: an array of {values.dtype} holds no numbers")
    return values.astype(values.dtype.newbyteorder("="), copy=False)


def _rows(name, values, widths, count=None):
    values = _numbers(name, values)
    rows = "N" if count is None else count
    if values.ndim != 2 or values.shape[1] not in widths or (count is not None and len(values) != count):
        wanted = " or ".join(f"({rows}, {width})" for width in widths)
        raise Error(f"{name}: found an array of shape {values.shape}, expected {wanted}")
    return values


def columns_of(xyz, colors=None, normals=None, scalars=None, radii=None):
    """Arrays as columns: name, one-dimensional array (a view where the types allow), and whether it is a scalar."""
    xyz = _rows("xyz", xyz, (3,))
    count = len(xyz)
    columns = [(name, xyz[:, k]) for k, name in enumerate("xyz")]
    if normals is not None:
        normals = _rows("normals", normals, (3,), count)
        columns += [(name, normals[:, k]) for k, name in enumerate(("nx", "ny", "nz"))]
    if colors is not None:
        colors = _rows("colors", colors, (3, 4), count)
        if colors.dtype.kind == "b":
            raise Error("colors: found booleans; give bytes from 0 to 255 or floats from 0 to 1")
        columns += [(name, colors[:, k]) for k, name in zip(range(colors.shape[1]), ("red", "green", "blue", "alpha"))]
    if radii is not None:
        columns.append(("radius", _column("radii", radii, count)))
    columns = [(name, forward(values), False) for name, values in columns]
    return columns + [(name, forward(_column(name, values, count)), True) for name, values in (scalars or {}).items()]


def forward(values):
    """Readers step forward through memory."""
    import numpy as np

    return values if values.strides[0] >= 0 else np.ascontiguousarray(values)


def _column(name, values, count):
    values = _numbers(name, values)
    if values.ndim == 2 and values.shape[1] == 1:
        values = values[:, 0]
    if values.shape != (count,):
        raise Error(f"{name}: found an array of shape {values.shape}, expected ({count},)")
    return values


def _structured(array):
    """A record a point, as laspy, PDAL and pyntcloud have them."""
    fields = {}
    for name in array.dtype.names:
        if array.dtype[name].shape == () and array.dtype[name].kind in "fiub":
            fields.setdefault(_plain(name), _numbers(name, array[name].reshape(-1)))
    if not all(axis in fields for axis in "xyz"):
        raise Error(f"the records have no x, y and z but {', '.join(array.dtype.names)}")
    return [(name, forward(values), False) for name, values in fields.items()]


def _open3d(cloud):
    import numpy as np

    if hasattr(cloud, "point") and "positions" in cloud.point:  # open3d.t.geometry.PointCloud
        def array(name):
            return cloud.point[name].cpu().numpy()

        names = [name for name in cloud.point if name not in ("positions", "colors", "normals")]
        return columns_of(array("positions"), array("colors") if "colors" in cloud.point else None,
                          array("normals") if "normals" in cloud.point else None,
                          {name: array(name) for name in names if array(name).ndim == 1 or array(name).shape[1] == 1})
    return columns_of(np.asarray(cloud.points), np.asarray(cloud.colors) if cloud.has_colors() else None,
                      np.asarray(cloud.normals) if cloud.has_normals() else None)


def _pyvista(mesh):
    import numpy as np

    colors = normals = None
    scalars = {}
    for name in mesh.point_data.keys():
        values = np.asarray(mesh.point_data[name])
        if name.lower() in ("rgb", "rgba", "colors", "color") and values.ndim == 2 and values.shape[1] in (3, 4):
            colors = values
        elif name.lower() in ("normals", "normal") and values.ndim == 2 and values.shape[1] == 3:
            normals = values
        elif values.ndim == 1 and values.dtype.kind in "fiub":
            scalars[name] = values
    return columns_of(np.asarray(mesh.points), colors, normals, scalars)


def _laspy(las):
    import numpy as np

    xyz = np.stack([np.asarray(las.x, float), np.asarray(las.y, float), np.asarray(las.z, float)], axis=1)
    names = list(las.point_format.dimension_names)
    colors = None
    if all(name in names for name in ("red", "green", "blue")):
        colors = np.stack([np.asarray(las[name]) for name in ("red", "green", "blue")], axis=1)
    skipped = ("X", "Y", "Z", "red", "green", "blue")
    return columns_of(xyz, colors, None, {_plain(n): np.asarray(las[n]) for n in names if n not in skipped})


def columns_of_object(thing):
    """The columns of a point cloud of another library, a data frame or an array; None when it is none of these."""
    import numpy as np

    if hasattr(thing, "point_format") and hasattr(thing, "x"):
        return _laspy(thing)
    if (hasattr(thing, "has_colors") and hasattr(thing, "points")) or (hasattr(thing, "point") and hasattr(thing, "to_legacy")):
        return _open3d(thing)
    if hasattr(thing, "point_data") and hasattr(thing, "points"):
        return _pyvista(thing)
    if hasattr(thing, "points") and hasattr(thing.points, "to_records"):  # pyntcloud
        thing = thing.points
    if hasattr(thing, "to_records"):  # pandas
        return _structured(thing.to_records(index=False))
    if hasattr(thing, "vertices"):  # trimesh
        colors = getattr(thing, "colors", None)
        return columns_of(np.asarray(thing.vertices), colors if colors is not None and len(colors) else None)
    if isinstance(thing, np.ndarray) and thing.dtype.names:
        return _structured(thing)
    return None
