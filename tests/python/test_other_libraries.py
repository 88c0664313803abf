"""Objects of the libraries themselves, where they are installed; test_cloud.py has stand-ins for those that are not."""
import os
import subprocess
import sys

import numpy as np
import pytest

import sfumato


def test_clouds_of_open3d(sphere):
    """In a process of its own: Open3D and its libraries stay out of the other tests."""
    pytest.importorskip("open3d", reason="python3-open3d is not installed")
    code = """
import numpy as np, open3d, sfumato
rng = np.random.default_rng(1)
xyz, colors, normals = rng.normal(size=(5000, 3)), rng.uniform(size=(5000, 3)), rng.normal(size=(5000, 3))
normals /= np.linalg.norm(normals, axis=1, keepdims=True)
cloud = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(xyz))
assert sfumato.Cloud(cloud).colors is None and sfumato.Cloud(cloud).normals is None
cloud.colors = open3d.utility.Vector3dVector(colors)
cloud.normals = open3d.utility.Vector3dVector(normals)
found = sfumato.Cloud(cloud)
assert np.abs(found.xyz - xyz).max() < 1e-6
assert np.abs(found.colors[:, :3] / 255 - colors).max() <= 0.502 / 255
assert np.abs(found.normals - normals).max() < 1e-6
wanted = sfumato.render(found, size=(80, 60)).rgba
assert (sfumato.render(cloud, size=(80, 60)).rgba == wanted).all()
if hasattr(open3d, "t"):
    tensors = open3d.t.geometry.PointCloud.from_legacy(cloud)
    tensors.point["confidence"] = open3d.core.Tensor(np.arange(5000, dtype=np.float32)[:, None])
    found = sfumato.Cloud(tensors)
    assert np.abs(found.xyz - xyz).max() < 1e-6 and (found.scalars["confidence"] == np.arange(5000)).all()
# And back.
again = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(found.xyz))
assert len(again.points) == 5000
print("fine", hasattr(open3d, "t"))
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False, env=os.environ, timeout=300)
    assert done.returncode == 0, done.stderr
    assert "fine" in done.stdout


def test_data_frames(sphere):
    pandas = pytest.importorskip("pandas", reason="python3-pandas is not installed")
    frame = pandas.DataFrame({"X": sphere[0][:, 0], "Y": sphere[0][:, 1], "Z": sphere[0][:, 2], "Intensity": np.arange(10_000)})
    cloud = sfumato.Cloud(frame)
    assert (cloud.xyz == sphere[0]).all() and (cloud.scalars["intensity"] == np.arange(10_000)).all()


def test_meshes_of_pyvista(sphere):
    pyvista = pytest.importorskip("pyvista", reason="pyvista is not installed")
    mesh = pyvista.PolyData(sphere[0])
    mesh.point_data["height"] = sphere[0][:, 2]
    cloud = sfumato.Cloud(mesh)
    assert (cloud.xyz == sphere[0]).all() and (cloud.scalars["height"] == sphere[0][:, 2]).all()


def test_records_of_laspy(sphere, tmp_path):
    laspy = pytest.importorskip("laspy", reason="laspy is not installed")
    sfumato.write(tmp_path / "a.las", sfumato.Cloud(sphere[0], scalars={"intensity": np.arange(10_000)}))
    cloud = sfumato.Cloud(laspy.read(tmp_path / "a.las"))
    assert np.abs(cloud.xyz - sphere[0]).max() <= 1e-3 and (cloud.scalars["intensity"] == np.arange(10_000)).all()
