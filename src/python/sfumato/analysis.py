"""What is computed from the neighbours of points: normals, spacing, uncertainty, clusters; how much of a light they see; and
how far they lie from another cloud.

Every function takes what `sfumato.render` takes as points, and returns values in their order; rows that are not finite get NaN,
or -1 as a cluster.
"""
from . import _engine, _progress
from ._cloud import as_cloud
from ._techniques import text_of

__all__ = ["normals", "spacing", "uncertainty", "clusters", "shadow_factors", "distances"]


def _in_rows(cloud, values, points, nothing):
    """Values of the points that are finite, one for each row of the caller's array."""
    import numpy as np

    kept = cloud.kept
    if kept is None or cloud is points:
        return values
    out = np.full((len(points), *values.shape[1:]), nothing, values.dtype)
    out[kept] = values
    return out


def _settings(parameters):
    return [(name, text_of(name, value)) for name, value in parameters.items()]


def normals(points, neighbors=24, progress=None, **parameters):
    """Unit normals, float32 (N, 3): the direction in which the neighbourhood of each point is thinnest, towards the scanner
    where the cloud knows it, else upwards. Normals that the cloud brings are not looked at.

    `neighbors` is how many points are looked at; other parameters are those of `sfumato.analysis_parameters()`.
    """
    cloud = as_cloud(points, progress)
    settings = _settings({"neighbors": neighbors, **parameters})
    return _in_rows(cloud, _engine.normals(cloud._engine, settings, _progress.callback(progress)), points, float("nan"))


def spacing(points, progress=None):
    """How far apart the points are: the median side of the square per point, scene units."""
    return _engine.spacing(as_cloud(points, progress)._engine, _progress.callback(progress))


def uncertainty(points, neighbors=24, progress=None, **parameters):
    """How uncertain the surface is at each point, float32 (N,), scene units: large where points are sparse or disagree about
    its direction (Seemann et al. 2018). What `soft` draws as haze."""
    cloud = as_cloud(points, progress)
    settings = _settings({"neighbors": neighbors, **parameters})
    return _in_rows(cloud, _engine.uncertainty(cloud._engine, settings, _progress.callback(progress)), points, float("nan"))


def clusters(points, neighbors=30, min_size=100, point_threshold=6.0, region_threshold=5.0, gap=None, angle=8.0, bend=12.0,
             progress=None):
    """Which points belong together, int32 (N,) from 0: by colour, or by the bend of the surface where there is none.

    Parameters
    ----------
    neighbors : int
        Points each is compared with.
    min_size : int
        Points; smaller clusters join the nearest one.
    point_threshold, region_threshold : float
        With colours: RGB distances (0 to 255 each) up to which neighbours grow together and regions are merged.
    gap : float, optional
        Scene units: only regions this near are merged; 5 median spacings.
    angle, bend : float
        Without colours: degrees up to which normals of neighbours differ, and how much a surface may bend.
    """
    cloud = as_cloud(points, progress)
    request = {"neighbors": int(neighbors), "min_size": int(min_size), "point_threshold": float(point_threshold),
              "region_threshold": float(region_threshold), "angle": float(angle), "bend": float(bend)}
    if gap is not None:
        request["gap"] = float(gap)
    return _in_rows(cloud, _engine.clusters(cloud._engine, request, _progress.callback(progress)), points, -1)


def shadow_factors(points, light, shadows="soft", progress=None, **parameters):
    """How much of the light each point sees, float32 (N,): 0 dark to 1 lit. As the scalar `shadow` of a cloud, rendering with
    `shadows="stored"` draws them: ``cloud.scalars["shadow"] = shadow_factors(cloud, "dir:1,0,2")``.

    `light` is "X,Y,Z" (a place, world coordinates) or "dir:X,Y,Z" (where it comes from), `shadows` "hard" or "soft"; other
    parameters are those of rendering: light_size, light_samples, shadow_distance.
    """
    cloud = as_cloud(points, progress)
    settings = _settings({"light": light, "shadows": shadows, **parameters})
    return _in_rows(cloud, _engine.shadow_factors(cloud._engine, settings, _progress.callback(progress)), points, float("nan"))


def distances(points, to, scale=None, progress=None):
    """How far each point lies from the cloud `to`, float32 (N,), scene units: from the nearest of its points. With `scale`, along the
    normal of the points within that diameter, between the means of both clouds in a cylinder as wide (M3C2): positive in front of
    `to`, NaN where one of the two is missing. As the scalar `distance` of a cloud it is a colour like any other."""
    cloud, other = as_cloud(points, progress), as_cloud(to, progress)
    found = _engine.distances(cloud._engine, other._engine, None if scale is None else float(scale), _progress.callback(progress))
    return _in_rows(cloud, found, points, float("nan"))
