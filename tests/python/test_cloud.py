"""Arrays in and out, files, and clouds of other libraries."""
import types

import numpy as np
import pytest

import sfumato


def test_float32_positions_stay_bit_for_bit(sphere):
    xyz, _ = sphere
    cloud = sfumato.Cloud(xyz)
    assert cloud.positions.tobytes() == xyz.tobytes()
    assert cloud.origin == (0, 0, 0) and len(cloud) == len(xyz)
    assert cloud.colors is None and cloud.normals is None and cloud.radii is None and not cloud.scalars


def test_large_coordinates_keep_their_digits(sphere):
    """UTM: float32 alone would move points by up to 0.25."""
    wanted = sphere[0].astype(float) + (447_123.25, 5_412_345.5, 112)
    cloud = sfumato.Cloud(wanted)
    assert np.abs(cloud.xyz - wanted).max() < 1e-6  # float32 within 4 units of the origin: half a step is 1.2e-7 a unit
    assert np.abs(np.asarray(cloud.origin) - wanted.mean(0)).max() < 5
    assert np.abs(np.asarray(cloud.bounds) - (wanted.min(0), wanted.max(0))).max() < 1e-6


def test_views_are_the_cloud_and_outlive_the_variable(sphere):
    cloud = sfumato.Cloud(sphere[0], colors=np.full((10_000, 3), 7, np.uint8), scalars={"a": np.arange(10_000)})
    cloud.positions[5] = 1, 2, 3
    cloud.colors[5] = 9, 8, 7, 6
    assert cloud.xyz[5].tolist() == [1, 2, 3]
    assert cloud.colors[5].tolist() == [9, 8, 7, 6]
    positions, scalar = cloud.positions, cloud.scalars["a"]
    for k in range(50):  # what a growing list would move
        cloud.scalars[f"more {k}"] = np.zeros(10_000)
    del cloud
    assert positions[5].tolist() == [1, 2, 3]
    assert (scalar == np.arange(10_000)).all()


def test_rows_that_are_not_finite_are_left_out(sphere):
    xyz = sphere[0].copy()
    xyz[[3, 70]] = np.nan, 0, np.inf
    cloud = sfumato.Cloud(xyz, scalars={"row": np.arange(10_000)})
    assert len(cloud) == 9_998
    assert (cloud.kept == np.delete(np.arange(10_000), [3, 70])).all()
    assert (cloud.scalars["row"] == cloud.kept).all()
    assert "2 of 10000 points are not finite" in cloud.notes[0]


@pytest.mark.parametrize("layout", ["C", "F", "sliced", "reversed", "big endian", "float16", "int32", "list"])
def test_any_layout_of_numbers(layout):
    wanted = np.random.default_rng(2).integers(-50, 50, (1_000, 3))
    xyz = {"C": lambda: wanted.astype(np.float32), "F": lambda: np.asfortranarray(wanted, np.float64),
           "sliced": lambda: np.repeat(np.repeat(wanted, 2, 0), 3, 1)[::2, ::3].astype(np.float32)[:, :],
           "reversed": lambda: wanted[::-1].astype(np.float64)[::-1], "big endian": lambda: wanted.astype(">f8"),
           "float16": lambda: wanted.astype(np.float16), "int32": lambda: wanted.astype(np.int32),
           "list": lambda: wanted.tolist()}[layout]()
    assert (sfumato.Cloud(xyz).xyz == wanted).all()


@pytest.mark.parametrize("colors", [np.uint8, np.uint16, np.float32, np.float64])
def test_colours_of_any_range(sphere, colors):
    wanted = np.random.default_rng(3).integers(0, 256, (10_000, 4), dtype=np.uint8)
    wanted[0] = 255  # of 16 bits and of fractions, the largest value tells the range
    given = {np.uint8: wanted, np.uint16: wanted.astype(np.uint16) * 257, np.float32: (wanted / 255).astype(np.float32),
             np.float64: wanted / 255}[colors]
    assert (sfumato.Cloud(sphere[0], colors=given).colors == wanted).all()
    assert (sfumato.Cloud(sphere[0], colors=given[:, :3]).colors[:, 3] == 255).all()


def test_normals_become_unit_vectors(sphere):
    cloud = sfumato.Cloud(sphere[0], normals=3 * sphere[1])
    assert np.abs(cloud.normals - sphere[1]).max() < 1e-6
    cloud.normals = -5 * sphere[1]
    assert np.abs(cloud.normals + sphere[1]).max() < 1e-6


def test_picking_points(sphere):
    cloud = sfumato.Cloud(sphere[0], scalars={"row": np.arange(10_000)}, up="+Y")
    upper = cloud[cloud.positions[:, 2] > 0]
    assert (upper.positions == sphere[0][sphere[0][:, 2] > 0]).all() and upper.up == "+Y"
    assert cloud[[5, 3, -1]].scalars["row"].tolist() == [5, 3, 9_999]
    assert len(cloud[::10]) == 1_000
    with pytest.raises(sfumato.Error, match="a mask of 3, expected 10000"):
        cloud[[True, False, True]]
    with pytest.raises(sfumato.Error, match="outside the 10000 points"):
        cloud[[10_000]]


def test_structured_arrays_both_ways(scan):
    cloud = sfumato.read(scan)
    records = cloud.to_structured()
    assert records.dtype["x"] == np.float64 and records.dtype["red"] == np.uint8 and records.dtype["classification"] == np.uint8
    again = sfumato.Cloud(records)
    for got, wanted in ((again.xyz, cloud.xyz), (again.colors, cloud.colors), (again.normals, cloud.normals)):
        assert (got == wanted).all()
    assert {name: values.tolist() for name, values in again.scalars.items()} == \
           {name: values.tolist() for name, values in cloud.scalars.items()}


def test_records_of_pdal_both_ways(scan):
    cloud = sfumato.read(scan)
    records = cloud.to_structured("pdal")
    assert {"X", "Y", "Z", "NormalX", "Red", "Classification"} <= set(records.dtype.names) and records["Red"].dtype == np.uint16
    assert (records["Red"] == cloud.colors[:, 0].astype(int) * 257).all()
    again = sfumato.Cloud(records)
    for got, wanted in ((again.xyz, cloud.xyz), (again.colors, cloud.colors), (again.normals, cloud.normals)):
        assert (got == wanted).all()
    assert set(again.scalars) == set(cloud.scalars)
    with pytest.raises(sfumato.Error, match="not one of plain, pdal"):
        cloud.to_structured("las")


@pytest.mark.parametrize("extension", ["ply", "las", "laz", "pcd", "npy", "csv"])
def test_written_files_are_read_again(tmp_path, scan, extension):
    cloud = sfumato.read(scan)
    sfumato.write(tmp_path / f"scan.{extension}", cloud)
    again = sfumato.read(tmp_path / f"scan.{extension}")
    step = 1e-3 if extension in ("las", "laz") else 1e-6  # LAS counts millimetres
    assert np.abs(again.xyz - cloud.xyz).max() <= step
    assert (again.colors[:, :3] == cloud.colors[:, :3]).all()
    assert (again.scalars["classification"] == cloud.scalars["classification"]).all()


def test_reading_parts(scan, tmp_path):
    cloud = sfumato.read(scan)
    assert len(sfumato.read(scan, max_points=1_000)) == 1_000
    low = sfumato.read(scan, crop_relative=((0, 0, 0), (1, 1, 0.5)))
    assert 0 < len(low) < len(cloud) and low.xyz[:, 2].max() < cloud.xyz[:, 2].mean() + 10
    ground = sfumato.read(scan, show_classes=[2])
    assert set(np.unique(ground.scalars["classification"])) == {2}
    high = sfumato.read(scan, filters="z 3..")
    assert high.xyz[:, 2].min() >= 3
    both = sfumato.read([scan, scan])
    assert len(both) == 2 * len(cloud) and set(np.unique(both.scalars["file"])) == {1, 2}


def test_synthetic_scans_are_the_command_s(command, tmp_path):
    command("synth", "tori", "--points", 5_000, "--seed", 4, "--sigma", 0.01, "-o", tmp_path / "tori.ply", "--quiet")
    cloud = sfumato.synth("tori", points=5_000, seed=4, sigma=0.01)
    assert cloud.positions.tobytes() == sfumato.read(tmp_path / "tori.ply").positions.tobytes()
    assert "tori" in sfumato.synth.scenes() and any(p.name == "sigma" for p in sfumato.synth.parameters())


def test_scalars_of_any_name(sphere):
    """Also those that columns of coordinates and colours have in files."""
    cloud = sfumato.Cloud(sphere[0], scalars={"x": sphere[0][:, 2], "red": sphere[0][:, 1], "a": sphere[0][:, 0]})
    assert (cloud.xyz == sphere[0]).all() and cloud.colors is None
    assert (cloud.scalars["x"] == sphere[0][:, 2]).all() and (cloud.scalars["a"] == sphere[0][:, 0]).all()


def test_large_scalars_keep_their_digits(sphere):
    times = 3.1e8 + np.arange(10_000) * 1e-3
    cloud = sfumato.Cloud(sphere[0], scalars={"gps_time": times})
    assert np.abs(cloud.scalars["gps_time"] - times).max() < 1e-6


def stand_in(**members):
    return types.SimpleNamespace(**members)


def test_clouds_of_other_libraries(sphere):
    """Stand-ins that have what the libraries' classes have; none of them is imported."""
    xyz, normals = sphere
    colors = np.abs(normals).astype(float)
    bytes_ = np.rint(255 * colors).astype(np.uint8)
    open3d = stand_in(points=xyz.astype(float), colors=colors, normals=normals.astype(float), has_colors=lambda: True,
                      has_normals=lambda: True)

    class Tensor:
        def __init__(self, values): self.values = values
        def cpu(self): return self
        def numpy(self): return self.values

    tensors = stand_in(point={"positions": Tensor(xyz), "colors": Tensor(bytes_), "reflectivity": Tensor(xyz[:, :1])}, to_legacy=None)
    pyvista = stand_in(points=xyz, point_data={"RGB": bytes_, "Normals": normals, "height": xyz[:, 2]})
    trimesh = stand_in(vertices=xyz, colors=bytes_)
    records = np.empty(len(xyz), [("X", float), ("Y", float), ("Z", float), ("Red", np.uint16), ("Green", np.uint16),
                                  ("Blue", np.uint16), ("Intensity", np.uint16), ("GpsTime", float), ("ReturnNumber", np.uint8)])
    for k, (axis, channel) in enumerate((("X", "Red"), ("Y", "Green"), ("Z", "Blue"))):
        records[axis], records[channel] = xyz[:, k], bytes_[:, k] * np.uint16(257)
    pyntcloud = stand_in(points=stand_in(to_records=lambda index: records))
    for thing in (open3d, tensors, pyvista, trimesh, records, pyntcloud):
        cloud = sfumato.Cloud(thing)
        assert (cloud.xyz == xyz).all()
        assert np.abs(cloud.colors[:, :3].astype(int) - bytes_).max() <= 1
    assert np.abs(sfumato.Cloud(open3d).normals - normals).max() < 1e-6
    assert (sfumato.Cloud(pyvista).scalars["height"] == xyz[:, 2]).all()
    assert set(sfumato.Cloud(records).scalars) == {"intensity", "gps_time", "return_number"}
    assert (sfumato.Cloud(records, colors=255 - bytes_).colors[:, :3] == 255 - bytes_).all()  # what is given wins


def test_analysis_of_a_sphere(sphere):
    xyz, normals = sphere
    found = sfumato.analysis.normals(xyz)
    # Over 24 of 10,000 points the sphere bends by 4 degrees; the worst lie where points are few.
    assert np.quantile(np.abs((found * normals).sum(1)), 0.01) > np.cos(np.radians(6))
    # The side of the square per point; sampling at random spreads it.
    assert sfumato.analysis.spacing(xyz) == pytest.approx(np.sqrt(4 * np.pi * 4 / len(xyz)), rel=0.1)
    noisy = xyz + np.where(xyz[:, :1] > 0, np.random.default_rng(5).normal(size=xyz.shape) * 0.1, 0)
    uncertain = sfumato.analysis.uncertainty(noisy)
    assert uncertain[xyz[:, 0] > 0.5].mean() > 1.3 * uncertain[xyz[:, 0] < -0.5].mean()
    two = np.concatenate([xyz, xyz + (20, 0, 0)])
    labels = sfumato.analysis.clusters(two)
    assert len(np.unique(labels)) == 2 and (labels[:10_000] == labels[0]).all() and labels[-1] != labels[0]


def test_analysis_answers_row_by_row(sphere):
    xyz = sphere[0].copy()
    xyz[10] = np.nan
    found = sfumato.analysis.normals(xyz)
    assert found.shape == (10_000, 3) and np.isnan(found[10]).all() and np.isfinite(np.delete(found, 10, 0)).all()
    assert sfumato.analysis.clusters(xyz)[10] == -1


def test_shadow_factors_are_drawn_as_stored():
    rng = np.random.default_rng(11)
    floor = np.column_stack([rng.uniform(-2, 2, (20_000, 2)), np.zeros(20_000)])
    table = np.column_stack([rng.uniform(-1, 1, (20_000, 2)), np.ones(20_000)])
    xyz = np.concatenate([floor, table])
    xyz[7] = np.nan
    factors = sfumato.analysis.shadow_factors(xyz, "dir:0,0,1", shadows="hard")
    assert factors.dtype == np.float32 and np.isnan(factors[7])
    edge = np.abs(xyz[:20_000, :2]).max(1)
    # Spacings of the table are 0.014, of the floor 0.028: the outline is off by a few of them.
    assert (factors[:20_000][edge < 0.9] == 0).all() and (factors[:20_000][edge > 1.1] == 1).all()
    assert (factors[20_000:] == 1).all()
    cloud = sfumato.Cloud(xyz)
    cloud.scalars["shadow"] = sfumato.analysis.shadow_factors(cloud, (3, 1, 4), light_samples=4)
    look = dict(technique="splats", light=(3, 1, 4), size=(96, 72), outputs=["rgba"])
    found = sfumato.render(cloud, shadows="soft", light_samples=4, **look)
    assert (sfumato.render(cloud, shadows="stored", **look).rgba == found.rgba).all()
    assert not (sfumato.render(cloud, **look).rgba == found.rgba).all()
    with pytest.raises(sfumato.Error, match="light_size"):
        sfumato.analysis.shadow_factors(cloud, "dir:0,0,1", light_sice=3)
    with pytest.raises(sfumato.Error, match="stands somewhere"):
        sfumato.analysis.shadow_factors(cloud, "headlight")


def test_stored_shadows_darken_where_they_are_zero(sphere):
    cloud = sfumato.Cloud(sphere[0])
    look = dict(technique="splats", light="dir:0,-1,1", size=(64, 48), outputs=["rgba"])
    lit = sfumato.render(cloud, **look).rgba
    with pytest.raises(sfumato.Error, match="no point has the scalar `shadow`"):
        sfumato.render(cloud, shadows="stored", **look)
    cloud.scalars["shadow"] = np.ones(len(cloud))
    assert (sfumato.render(cloud, shadows="stored", **look).rgba == lit).all()
    cloud.scalars["shadow"] = np.zeros(len(cloud))
    assert sfumato.render(cloud, shadows="stored", **look).rgba.mean() < lit.mean()


def test_distances_to_another_cloud():
    before = np.random.default_rng(1).uniform(0, 4, (4000, 3)) * (1, 1, 0)
    after = before + (0, 0, 0.5)
    assert np.allclose(sfumato.analysis.distances(after, before), 0.5, atol=1e-6)
    assert np.allclose(sfumato.analysis.distances(after, before, scale=0.5), 0.5, atol=1e-5)
    assert np.allclose(sfumato.analysis.distances(before, after, scale=0.5), -0.5, atol=1e-5)
    with pytest.raises(sfumato.Error, match="scale"):
        sfumato.analysis.distances(after, before, scale=-1)
