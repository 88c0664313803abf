"""Cameras."""
import os

from . import _engine
from ._error import Error

#: What K means in pixels: OpenCV counts from the centre of the first pixel, OpenGL (and sfumato's files) from its corner.
_CENTERS = {"opencv": 0.5, "opengl": 0.0}


def _convention(name):
    if name not in _CENTERS:
        raise Error(f"convention: '{name}' is not one of opencv, opengl")
    return name


def _intrinsics(values, convention):
    import numpy as np

    k = np.asarray(values, float)
    if k.shape == (3, 3):
        if abs(k[0, 1]) > 1e-9 * abs(k[0, 0]):
            raise Error("intrinsics: the matrix has skew, which no camera here has")
        k = np.array([k[0, 0], k[1, 1], k[0, 2], k[1, 2]])
    if k.shape != (4,) or not np.isfinite(k).all() or k[0] <= 0 or k[1] <= 0:
        raise Error("intrinsics: give a matrix of shape (3, 3) or fx, fy, cx, cy in pixels")
    shift = _CENTERS[convention]
    return float(k[0]), float(k[1]), float(k[2]) + shift, float(k[3]) + shift


class Camera(_engine.Camera):
    """A pinhole or parallel camera in world coordinates, double precision.

    Parameters
    ----------
    position, target : three numbers, world
        Where it stands and what it looks at.
    up : three numbers
        A direction that is up in the picture.
    fov : float
        Full vertical angle, degrees.
    size : (width, height)
        Pixels.
    height_world : float, optional
        Parallel projection that shows so much of the world from top to bottom, scene units.
    intrinsics : fx, fy, cx, cy, optional
        Pixels; wins over `fov`. The corner of the first pixel is (0, 0), its centre (0.5, 0.5), y points down.

    Every one of them is an attribute that can be set.
    """

    def __init__(self, position=(0, -1, 0), target=(0, 0, 0), up=(0, 0, 1), fov=45.0, size=(1280, 720),
                 height_world=None, intrinsics=None):
        super().__init__()
        self.position = tuple(position)
        self.target = tuple(target)
        self.up = tuple(up)
        self.fov = fov
        self.size = tuple(size)
        if height_world is not None:
            self.orthographic = True
            self.height_world = height_world
        if intrinsics is not None:
            self.custom_intrinsics = tuple(intrinsics)
        self._check()

    def _check(self):
        import math

        numbers = (*self.position, *self.target, *self.up, self.fov)
        if not all(math.isfinite(v) and abs(v) <= 1e15 for v in numbers):
            raise Error("camera: a number is not finite or beyond 1e15, where no point can be seen")
        if self.position == self.target:
            raise Error("camera: position and target are the same point")
        if not any(self.up):
            raise Error("camera: up is zero")
        if not 0 < self.fov < 180:
            raise Error(f"camera: a fov of {self.fov:g} degrees is outside (0, 180)")
        if min(self.size) < 1:
            raise Error("camera: size: give width and height in pixels, both at least 1")

    @classmethod
    def _of(cls, engine):
        camera = cls.__new__(cls)
        _engine.Camera.__init__(camera, engine)
        return camera

    @classmethod
    def look_at(cls, position, target, up=(0, 0, 1), fov=45.0, size=(1280, 720)):
        """The camera at `position` that looks at `target`; world coordinates, `fov` in degrees, `size` in pixels."""
        return cls(position, target, up, fov, size)

    @classmethod
    def from_pose(cls, pose, intrinsics, size, convention="opencv"):
        """The camera of a pose and intrinsics, as structure from motion, SLAM and simulators give them.

        Parameters
        ----------
        pose : array (4, 4)
            Camera to world: its columns are the camera's axes and its place. Invert world-to-camera matrices first, or
            use `from_opencv`.
        intrinsics : array (3, 3) or fx, fy, cx, cy
            Pixels.
        size : (width, height)
            Pixels.
        convention : "opencv" or "opengl"
            "opencv": x right, y down, z forward; (0, 0) is the centre of the first pixel. "opengl" (also Blender, NeRF):
            x right, y up, z backward; (0, 0) is the corner of the first pixel, y down.
        """
        import numpy as np

        pose = np.asarray(pose, float)
        if pose.shape not in ((4, 4), (3, 4)) or not np.isfinite(pose).all():
            raise Error(f"pose: found an array of shape {pose.shape}, expected (4, 4), finite")
        axes, place = pose[:3, :3], pose[:3, 3]
        if np.abs(axes.T @ axes - np.eye(3)).max() > 1e-3:  # matrices written with four digits are fine
            raise Error("pose: its axes are not at right angles and of length 1; take scale and shear out of the matrix")
        if np.linalg.det(axes) < 0:
            raise Error("pose: it is mirrored; a camera's axes are right-handed")
        flip = -1.0 if _convention(convention) == "opencv" else 1.0
        forward, up = -flip * axes[:, 2], flip * axes[:, 1]
        return cls(tuple(place), tuple(place + forward), tuple(up), size=size, intrinsics=_intrinsics(intrinsics, convention))

    @classmethod
    def from_opencv(cls, camera_matrix, rotation, translation, size):
        """The camera of OpenCV's calibration or `solvePnP`: world to camera, x_camera = R x_world + t.

        Parameters
        ----------
        camera_matrix : array (3, 3)
            Pixels, as OpenCV counts them. The photograph has to be undistorted.
        rotation : array (3, 3) or (3,)
            A matrix or a rotation vector (Rodrigues, radians).
        translation : array (3,)
            Scene units.
        size : (width, height)
            Pixels.
        """
        import numpy as np

        turn = np.asarray(rotation, float)
        if turn.size == 3:
            vector = turn.reshape(3)
            angle = np.linalg.norm(vector)
            x, y, z = vector / angle if angle > 0 else (0.0, 0.0, 0.0)
            cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
            turn = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
        if turn.shape != (3, 3):
            raise Error(f"rotation: found an array of shape {turn.shape}, expected (3, 3) or (3,)")
        pose = np.eye(4)
        pose[:3, :3] = turn.T
        pose[:3, 3] = -turn.T @ np.asarray(translation, float).reshape(3)
        return cls.from_pose(pose, camera_matrix, size, "opencv")

    @classmethod
    def from_json(cls, text):
        """The camera of a text as `to_json` gives it, or the command's ``--output-camera``."""
        return cls._of(_engine.Camera.from_json(text))

    @classmethod
    def load(cls, file):
        """The camera of a JSON file."""
        return cls._of(_engine.Camera.load(os.fspath(file)))

    def save(self, file):
        """Writes a JSON file, as the command's ``--camera`` takes it."""
        super().save(os.fspath(file))

    def pose(self, convention="opencv"):
        """Camera to world, array (4, 4); see `from_pose` for the conventions."""
        import numpy as np

        pose = np.linalg.inv(self.view_matrix())
        if _convention(convention) == "opencv":
            pose[:3, 1:3] *= -1
        return pose

    def matrix(self, convention="opencv"):
        """Intrinsics as an array (3, 3), pixels; see `from_pose` for the conventions."""
        import numpy as np

        fx, fy, cx, cy = self.intrinsics
        shift = _CENTERS[_convention(convention)]
        return np.array([[fx, 0, cx - shift], [0, fy, cy - shift], [0, 0, 1]])

    def project(self, xyz):
        """Where points lie in the picture: array (N, 3) of world coordinates to (N, 3) of x, y in pixels (the corner of the
        first pixel is (0, 0)) and depth along the view axis, scene units. Points behind the camera have a depth below 0."""
        import numpy as np

        xyz = np.asarray(xyz, float)
        view = self.view_matrix()
        eye = (xyz - self.position) @ view[:3, :3].T
        depth = -eye[..., 2]
        fx, fy, cx, cy = self.intrinsics
        by = 1.0 if self.orthographic else depth
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.stack([fx * eye[..., 0] / by + cx, cy - fy * eye[..., 1] / by, depth], axis=-1)

    def unproject(self, depth):
        """World coordinates (height, width, 3) of a depth map (height, width) of this camera; NaN where nothing is."""
        import numpy as np

        depth = np.asarray(depth, float)
        height, width = depth.shape
        if (width, height) != self.size:
            raise Error(f"depth: found {width} x {height} pixels, the camera has {self.size[0]} x {self.size[1]}")
        depth = np.where(np.isfinite(depth), depth, np.nan)
        fx, fy, cx, cy = self.intrinsics
        by = 1.0 if self.orthographic else depth
        x, y = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
        eye = np.stack([(x - cx) / fx * by, (cy - y) / fy * by, -depth], axis=-1)
        return eye @ self.view_matrix()[:3, :3] + np.asarray(self.position)

    def resized(self, width, height):
        """The same view at another size; the vertical angle stays."""
        return self._of(super().resized(width, height))

    def replace(self, **changes):
        """A copy with other attributes: ``camera.replace(fov=20)``."""
        camera = self._of(self)
        for name, value in changes.items():
            if name not in ("position", "target", "up", "fov", "size", "height_world", "orthographic", "custom_intrinsics"):
                raise Error(f"a camera has no '{name}'")
            setattr(camera, name, value)
        camera._check()
        return camera

    def __eq__(self, other):
        return isinstance(other, _engine.Camera) and self.to_json() == other.to_json()

    __hash__ = None

    def __reduce__(self):
        return Camera.from_json, (self.to_json(),)

    def __repr__(self):
        def list_of(values):
            return "(" + ", ".join(f"{v:.7g}" for v in values) + ")"

        lens = f"height_world={self.height_world:.7g}" if self.orthographic else f"fov={self.fov:.4g}"
        if self.custom_intrinsics:
            lens = f"intrinsics={list_of(self.custom_intrinsics)}"
        return f"Camera(position={list_of(self.position)}, target={list_of(self.target)}, up={list_of(self.up)}, {lens}, size={self.size})"


def path(keys, frames=None):
    """A smooth path through key cameras, from the first to the last: a list of `frames` cameras.

    `keys` are cameras, or a file as the command's ``--path`` takes it: JSON ``{"cameras": [...]}``, or poses of
    nerfstudio, COLMAP, TUM, KITTI or Open3D, which without `frames` are returned as they are.
    """
    are_pictures = False
    if isinstance(keys, (str, os.PathLike)):
        keys, are_pictures = _engine.read_camera_path(os.fspath(keys))
    else:
        keys = list(keys)
    if frames is None and are_pictures:
        return [Camera._of(camera) for camera in keys]
    if not keys or frames is None or frames < 1:
        raise Error("path: give at least one camera and one frame")
    return [Camera._of(camera) for camera in _engine.interpolate([k.resized(*keys[0].size) for k in keys], frames)]


def orbit(start, frames=120, degrees=360.0, up=None):
    """A turn about what `start` looks at: a list of `frames` cameras, the first of which is `start`.

    A full turn does not repeat its first frame. `up` is the axis, by default the up of `start`.
    """
    if frames < 1:
        raise Error("orbit: give at least one frame")
    import math

    axis = tuple(up or start.up)
    length = math.sqrt(sum(v * v for v in axis))
    return [Camera._of(camera) for camera in _engine.orbit(start, tuple(v / length for v in axis), frames, degrees)]
