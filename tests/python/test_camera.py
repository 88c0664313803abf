"""Cameras and the conventions of others."""
import pickle

import numpy as np
import pytest

import sfumato

K = np.array([[300.0, 0, 158.2], [0, 310.0, 121.7], [0, 0, 1]])


def turned():
    """A camera to world pose of OpenCV that looks from (3, -4, 2) to the origin."""
    place = np.array([3.0, -4, 2])
    forward = -place / np.linalg.norm(place)
    right = np.cross(forward, (0, 0, 1))
    right /= np.linalg.norm(right)
    pose = np.eye(4)
    pose[:3, :3] = np.stack([right, np.cross(forward, right), forward], axis=1)
    pose[:3, 3] = place
    return pose


def opencv_pixels(pose, xyz):
    """The textbook: x = K (R X + t)."""
    inverse = np.linalg.inv(pose)
    eye = xyz @ inverse[:3, :3].T + inverse[:3, 3]
    return (eye @ K.T)[:, :2] / eye[:, 2:], eye[:, 2]


def test_poses_of_opencv_land_on_their_pixels():
    xyz = np.random.default_rng(1).uniform(-1, 1, (100, 3))
    camera = sfumato.Camera.from_pose(turned(), K, (320, 240))
    where, depth = opencv_pixels(turned(), xyz)
    got = camera.project(xyz)
    assert np.abs(got[:, :2] - 0.5 - where).max() < 1e-9  # OpenCV counts from the centre of the first pixel
    assert np.abs(got[:, 2] - depth).max() < 1e-12
    assert np.abs(camera.pose() - turned()).max() < 1e-12
    assert np.abs(camera.matrix() - K).max() < 1e-12


def test_opengl_is_opencv_with_two_axes_turned():
    flipped = turned() @ np.diag([1.0, -1, -1, 1])
    ours, theirs = sfumato.Camera.from_pose(turned(), K, (320, 240)), sfumato.Camera.from_pose(flipped, K + [[0, 0, 0.5], [0, 0, 0.5], [0, 0, 0]], (320, 240), "opengl")
    assert np.abs(ours.view_matrix() - theirs.view_matrix()).max() < 1e-12
    assert np.allclose(ours.intrinsics, theirs.intrinsics, atol=1e-12)
    assert np.abs(theirs.pose("opengl") - flipped).max() < 1e-12


def test_rotation_vectors_and_matrices_agree():
    inverse = np.linalg.inv(turned())
    angle = np.arccos((np.trace(inverse[:3, :3]) - 1) / 2)
    axis = np.array([inverse[2, 1] - inverse[1, 2], inverse[0, 2] - inverse[2, 0], inverse[1, 0] - inverse[0, 1]]) / (2 * np.sin(angle))
    by_vector = sfumato.Camera.from_opencv(K, angle * axis, inverse[:3, 3], (320, 240))
    by_matrix = sfumato.Camera.from_opencv(K, inverse[:3, :3], inverse[:3, 3], (320, 240))
    assert np.abs(by_vector.pose() - turned()).max() < 1e-9 and np.abs(by_matrix.pose() - turned()).max() < 1e-9


@pytest.mark.parametrize("camera", [
    sfumato.Camera((3, -4, 2), (0, 0, 0), size=(64, 48)), sfumato.Camera((3, -4, 2), (0, 0, 0), size=(64, 48), height_world=3),
    sfumato.Camera.from_pose(turned(), K, (320, 240))])
def test_what_is_projected_comes_back(camera):
    depth = np.random.default_rng(2).uniform(1, 9, camera.size[::-1])
    depth[0, 0] = np.inf
    world = camera.unproject(depth)
    assert np.isnan(world[0, 0]).all()
    x, y, z = np.moveaxis(camera.project(world), -1, 0)
    rows, columns = np.indices(depth.shape)
    good = np.isfinite(depth)
    assert np.abs(x - columns - 0.5)[good].max() < 1e-9 and np.abs(y - rows - 0.5)[good].max() < 1e-9
    assert np.abs(z - depth)[good].max() < 1e-12


def test_a_point_is_drawn_where_it_projects():
    """One red point among grey ones far away, seen through intrinsics off the centre."""
    camera = sfumato.Camera.from_pose(turned(), K, (320, 240))
    xyz = np.array([[0.3, 0.2, 0.4], [0.31, 0.2, 0.4], [40, 40, 40.0]])
    picture = sfumato.render(xyz, np.array([[255, 0, 0], [255, 0, 0], [9, 9, 9]], np.uint8), technique="points", camera=camera,
                             background="white", shading="albedo", point_size=4, edl=False, up="+Z")
    rows, columns = np.nonzero((picture.rgba[..., 0] > 200) & (picture.rgba[..., 1] < 100))
    wanted = camera.project(xyz[:2]).mean(0)
    assert len(rows) > 0
    assert abs(columns.mean() + 0.5 - wanted[0]) < 1 and abs(rows.mean() + 0.5 - wanted[1]) < 1  # a disc of whole pixels
    assert picture.depth[rows, columns].min() == pytest.approx(wanted[2], abs=0.01)  # the points are 0.006 apart in depth


def test_files_texts_and_copies(tmp_path):
    camera = sfumato.Camera((1, 2, 3), (4, 5, 6), fov=30, size=(640, 480))
    camera.save(tmp_path / "c.json")
    assert sfumato.Camera.load(tmp_path / "c.json") == camera
    assert sfumato.Camera.from_json(camera.to_json()) == camera
    assert pickle.loads(pickle.dumps(camera)) == camera
    other = camera.replace(fov=20)
    assert other.fov == pytest.approx(20) and camera.fov == pytest.approx(30) and other != camera
    assert camera.resized(320, 240).size == (320, 240)
    assert "fov=30" in repr(camera)


def test_orbits_and_paths():
    start = sfumato.Camera((0, -5, 1), (0, 0, 0))
    turn = sfumato.orbit(start, 8)
    assert turn[0].position == pytest.approx(start.position) and turn[4].position == pytest.approx((0, 5, 1), abs=1e-12)
    assert all(isinstance(camera, sfumato.Camera) for camera in turn)
    keys = [start, start.replace(position=(5, 0, 1)), start.replace(position=(0, 5, 3))]
    way = sfumato.path(keys, 11)
    assert way[0].position == pytest.approx(keys[0].position) and way[5].position == pytest.approx(keys[1].position)
    assert way[-1].position == pytest.approx(keys[2].position)


@pytest.mark.parametrize("make, says", [
    (lambda: sfumato.Camera((0, 0, 0), (0, 0, 0)), "the same point"),
    (lambda: sfumato.Camera(fov=180), "180 degrees is outside"),
    (lambda: sfumato.Camera(size=(0, 5)), "at least 1"),
    (lambda: sfumato.Camera((np.nan, 0, 0)), "not finite"),
    (lambda: sfumato.Camera.from_pose(np.diag([1, 1, -1, 1.0]), K, (3, 2)), "mirrored"),
    (lambda: sfumato.Camera.from_pose(2 * np.eye(4), K, (3, 2)), "right angles and of length 1"),
    (lambda: sfumato.Camera.from_pose(np.eye(3), K, (3, 2)), r"shape \(3, 3\), expected \(4, 4\)"),
    (lambda: sfumato.Camera.from_pose(np.eye(4), K, (3, 2), "blender"), "not one of opencv, opengl"),
    (lambda: sfumato.Camera.from_pose(np.eye(4), K + [[0, 9, 0], [0, 0, 0], [0, 0, 0]], (3, 2)), "skew"),
    (lambda: sfumato.Camera.from_json("{}"), "no 'position'"),
    (lambda: sfumato.Camera().replace(focus=3), "no 'focus'"),
    (lambda: sfumato.Camera().unproject(np.zeros((3, 2))), "2 x 3 pixels, the camera has 1280 x 720")])
def test_cameras_that_cannot_be(make, says):
    with pytest.raises(sfumato.Error, match=says):
        make()


def test_poses_of_other_programs_are_a_path(tmp_path):
    (tmp_path / "00.txt").write_text("1 0 0 2 0 1 0 3 0 0 1 4\n1 0 0 3 0 1 0 3 0 0 1 4\n")  # KITTI
    cameras = sfumato.path(tmp_path / "00.txt")
    assert [camera.position for camera in cameras] == [(2, 3, 4), (3, 3, 4)]
    assert cameras[0].direction == (0, 0, 1)
    assert len(sfumato.path(tmp_path / "00.txt", 5)) == 5
