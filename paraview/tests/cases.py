"""The plugin in ParaView beside the command: pvbatch cases.py SFUMATO PLUGIN SCRATCH CASE [ARGUMENT...]

Each case ends with "PASSED". On several ranks, the first runs it. Clouds are made here; the command reads them from a file.
The case "server" needs pvpython: pvbatch is its own server.
"""
import atexit
import ctypes
import glob
import json
import os
import re
import subprocess
import sys
import tempfile

import numpy as np
from paraview import simple as pv
from paraview.modules.vtkRemotingCore import vtkProcessModule
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import VTK_UNSIGNED_CHAR
from vtkmodules.vtkCommonSystem import vtkTimerLog
from vtkmodules.vtkIOImage import vtkPNGReader

COMMAND, PLUGIN, SCRATCH, CASE = sys.argv[1:5]
ARGUMENTS = sys.argv[5:]
controller = vtkProcessModule.GetProcessModule().GetGlobalController()
RANKS = controller.GetNumberOfProcesses()
os.makedirs(SCRATCH, exist_ok=True)
SIZE = [320, 240]
CAMERA = {"position": [3.0, -4.0, 2.5], "target": [0.0, 0.0, 0.0], "up": [0.0, 0.0, 1.0], "fov_y_deg": 30.0,
          "projection": "perspective"}

# What each rank makes of the cloud: `mine` picks its points.
CLOUD = '''
import numpy as np
def cloud(n):
    random = np.random.default_rng(7)
    a, b = random.uniform(0, 2 * np.pi, (2, n))
    ring = 1 + 0.4 * np.cos(b)
    places = np.stack([ring * np.cos(a), ring * np.sin(a), 0.4 * np.sin(b)], 1).astype(np.float32)
    normals = np.stack([np.cos(b) * np.cos(a), np.cos(b) * np.sin(a), np.sin(b)], 1).astype(np.float32)
    colors = np.stack([127 + 120 * np.sin(a), 127 + 120 * np.cos(3 * b), 127 + 120 * np.sin(5 * a + b)], 1).astype(np.uint8)
    return places, normals, colors
def mine(places, how, rank, ranks):
    i = np.arange(len(places))
    if how == "tile": return i[np.minimum(((np.arctan2(places[:, 1], places[:, 0]) / np.pi + 1) / 2 * ranks).astype(int), ranks - 1) == rank]
    if how == "slab": return i[np.searchsorted(np.quantile(places[:, 2], np.arange(1, ranks) / ranks), places[:, 2]) == rank]
    if how == "round": return i[i % ranks == rank]
    if how == "empty": return i[i % (ranks - 1) == rank] if rank < ranks - 1 else i[:0]
    if how == "uneven": return i[i >= 100] if rank == 0 else i[:100] if rank == 1 else i[:0]
'''
exec(CLOUD)


def launched(ranks, *words):
    """Another program, on so many ranks."""
    return [*(["mpirun", "--allow-run-as-root", "--oversubscribe", "-np", str(ranks)] if ranks > 1 else []), *words]


# This program is an MPI process itself: what it was told is not for others.
ENVIRONMENT = {name: value for name, value in os.environ.items() if not name.startswith(("OMPI_", "PMIX_"))}


def connect(ranks):
    """To a server of its own, on so many ranks, which ends with the connection, or with this program."""
    server = subprocess.Popen(launched(ranks, "pvserver", "--server-port=0"), env=ENVIRONMENT, stdout=subprocess.PIPE, text=True)
    atexit.register(server.terminate)
    line = next((line for line in server.stdout if "Accepting" in line), "nothing")
    pv.Connect("localhost", int(re.search(r":(\d+)$", line)[1]))
    pv.LoadPlugin(PLUGIN, remote=True, ns=globals())


if CASE == "server": connect(int(ARGUMENTS[1]))
pv.LoadPlugin(PLUGIN, remote=False, ns=globals())


def script(n, how, cells):
    return CLOUD + f'''
import vtk
from vtk.numpy_interface import dataset_adapter as dsa
from vtk.util.numpy_support import numpy_to_vtk
from paraview.modules.vtkRemotingCore import vtkProcessModule
ranks = vtkProcessModule.GetProcessModule().GetGlobalController()
places, normals, colors = cloud({n})
keep = mine(places, "{how}", ranks.GetLocalProcessId(), ranks.GetNumberOfProcesses())
points = vtk.vtkPoints()
points.SetData(numpy_to_vtk(np.ascontiguousarray(places[keep]), deep=1))
out = self.GetPolyDataOutput()
out.SetPoints(points)
if {cells}:
    out.AllocateExact(1, len(keep) or 1)
    out.InsertNextCell(vtk.VTK_POLY_VERTEX, len(keep), list(range(len(keep))))
n = numpy_to_vtk(np.ascontiguousarray(normals[keep]), deep=1); n.SetName("Normals"); out.GetPointData().SetNormals(n)
c = numpy_to_vtk(np.ascontiguousarray(colors[keep]), deep=1); c.SetName("RGB"); out.GetPointData().AddArray(c)
h = numpy_to_vtk(np.ascontiguousarray(places[keep][:, 2]), deep=1); h.SetName("height"); out.GetPointData().AddArray(h)
'''


def source(n, how="round", cells=False):
    """Points in ParaView, on each rank a part; `cells`: they are vertices of a cell."""
    out = pv.ProgrammableSource()
    out.OutputDataSetType = "vtkPolyData"
    out.Script = script(n, how, cells)
    return out


def scan_file(n):
    """The same points for the command."""
    name = os.path.join(SCRATCH, f"cloud{n}.ply")
    places, normals, colors = cloud(n)
    rows = np.zeros(n, dtype=[("p", "<f4", 3), ("n", "<f4", 3), ("c", "u1", 3)])
    rows["p"], rows["n"], rows["c"] = places, normals, colors
    head = "".join(f"property float {k}\n" for k in ("x", "y", "z", "nx", "ny", "nz"))
    head += "".join(f"property uchar {k}\n" for k in ("red", "green", "blue"))
    part = f"{name}.{os.getpid()}"  # other tests read and write the same at the same time
    with open(part, "wb") as file:
        file.write(f"ply\nformat binary_little_endian 1.0\nelement vertex {n}\n{head}end_header\n".encode())
        file.write(rows.tobytes())
    os.replace(part, name)
    return name


def pixels(name):
    reader = vtkPNGReader()
    reader.SetFileName(name)
    reader.Update()
    image = reader.GetOutput()
    width, height, _ = image.GetDimensions()
    values = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(height, width, -1)[::-1].astype(float)
    if values.shape[2] < 4: return values
    cover = values[..., 3:] / 255  # over white, as a host blends: values, and not light
    return cover * values[..., :3] + (1 - cover) * 255


def view_of(size=SIZE):
    view = pv.CreateView("RenderView")
    view.ViewSize = size
    view.UseColorPaletteForBackground = 0
    view.Background = [1, 1, 1]
    view.OrientationAxesVisibility = 0
    view.UseFXAA = 0  # smooths the finished picture once more
    return view


def show(points, view, technique, **parameters):
    display = pv.Show(points, view)
    display.Representation = "Sfumato"
    display.SfumatoTechnique = technique
    pv.ColorBy(display, ("POINTS", "RGB"))
    display.MapScalars = 0
    for name, value in parameters.items():
        setattr(display, name, value)
    return display


def shot(view, name):
    file = os.path.join(SCRATCH, f"{CASE}_{'_'.join([*ARGUMENTS, str(RANKS), name])}.png")
    # Only now: the first thing that a view shows moves its camera.
    view.CameraPosition, view.CameraFocalPoint = CAMERA["position"], CAMERA["target"]
    view.CameraViewUp, view.CameraViewAngle = CAMERA["up"], CAMERA["fov_y_deg"]
    pv.SaveScreenshot(file, view)
    return pixels(file)


def of_command(n, technique, size=SIZE, options=(), file=None):
    camera, picture = (os.path.join(SCRATCH, f"{CASE}_{'_'.join([*ARGUMENTS, str(RANKS), technique])}_command.{end}") for end in ("json", "png"))
    with open(camera, "w") as out:
        json.dump({**CAMERA, "width": size[0], "height": size[1]}, out)
    subprocess.run([COMMAND, file or scan_file(n), "-t", technique, "--camera", camera, "--exposure", "1", "--no-background",
                    "--whole", "--up", "z", "--quiet", "-o", picture, *options], check=True)
    return pixels(picture)


def differences(a, b):
    assert a.shape == b.shape, (a.shape, b.shape)
    return np.abs(a - b).max(axis=2)


def same(a, b, what, share=0.0, steps=1.5):
    """Equal, but for the rounding of what ParaView blends, in all but a share of the pixels."""
    d = differences(a, b)
    beyond = (d > steps).mean()
    print(f"{what}: {(d > 0.5).mean():.4%} of the pixels differ, {beyond:.4%} by more than {steps}, at most by {d.max():.1f}")
    assert (a.min(axis=2) < 250).mean() > 0.05, "nothing was drawn"
    assert beyond <= share, what


# Share of the pixels: of points at one depth that of the lower number is seen, and files number them otherwise.
OF_ONE_DEPTH = 3e-4


# Share of the pixels: sizes of discs that one process measures at all points, ranks measure at places.
ALIKE = 1e-3


# Of surfaces, spacings, by which outlines and gaps are a little wider or narrower: a stretch of the curve has the median
# of a hundred places, off by 3 %. Of this torus 1.7 % of the pixels differ by more than a step, .4 % by more than 8.
# Of layers they decide besides which of the discs that meet in a pixel is in front: 9.1 % and .4 %.
ALIKE_OF = {"points": OF_ONE_DEPTH, "splats": ALIKE, "surface": 0.03, "layers": 0.1, "denoise": ALIKE, "soft": ALIKE, "strokes": OF_ONE_DEPTH}
BY_MORE_THAN_8 = 0.01


def close_to_command(technique):
    view = view_of()
    show(source(40000), view, technique)
    same(shot(view, technique), of_command(40000, technique), technique, OF_ONE_DEPTH)


def picture():
    close_to_command(ARGUMENTS[0])


def parameters():
    view = view_of()
    display = show(source(20000), view, "points", SfumatoPointsPointSize=6, SfumatoPointsSizeMode="pixels",
                   SfumatoShading="normals")
    wide = shot(view, "wide")
    same(wide, of_command(20000, "points", options=["--point-size", "6", "--size-mode", "pixels", "--shading", "normals"]), "wide")
    display.SfumatoPointsPointSize = 2
    assert (differences(shot(view, "narrow"), wide) > 20).mean() > 0.02


def resize():
    view = view_of()
    show(source(20000), view, "points")
    for size in ([320, 240], [401, 123], [160, 200]):
        view.ViewSize = size
        same(shot(view, "x".join(map(str, size))), of_command(20000, "points", size), str(size), OF_ONE_DEPTH)


def sheet(view, distance, side, color):
    """A wall across the left (-1) or right (1) half of the picture, so far from the camera."""
    eye, target = np.array(CAMERA["position"]), np.array(CAMERA["target"])
    ahead = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(ahead, [0, 0, 1])
    right /= np.linalg.norm(right)
    up = np.cross(right, ahead)
    corner = eye + distance * ahead - 5 * up + (0 if side > 0 else -5) * right
    wall = pv.Plane(Origin=corner, Point1=corner + 5 * right, Point2=corner + 10 * up)
    display = pv.Show(wall, view)
    display.Representation = "Surface"
    display.AmbientColor = display.DiffuseColor = color
    display.Ambient, display.Diffuse, display.Specular = 1, 0, 0


def mesh():
    first = ARGUMENTS[0] == "after"  # whichever ParaView draws first
    view = view_of()
    if first: show(source(40000), view, "splats", SfumatoShading="albedo")
    sheet(view, 3.0, -1, [1, 0, 0])
    sheet(view, 8.0, 1, [0, 0, 1])
    if not first: show(source(40000), view, "splats", SfumatoShading="albedo")
    got, alone = shot(view, "both"), of_command(40000, "splats", options=["--shading", "albedo"])
    left, right = got[:, :158], got[:, 162:]
    assert (left == [255, 0, 0]).all(), "points show through a wall before them"
    behind = (alone[:, 162:] == 255).all(axis=2)
    inside = ~behind
    for shift in (-1, 1):  # outlines blend with what is behind
        inside &= np.roll(~behind, shift, 0) & np.roll(~behind, shift, 1)
    assert inside.mean() > 0.1
    d = np.abs(right - alone[:, 162:]).max(axis=2)
    assert (d[inside] <= 2).mean() > 0.98, (d[inside] <= 2).mean()
    assert (right[behind] == [0, 0, 255]).all(axis=1).mean() > 0.97


def opacity():
    view = view_of()
    display = show(source(40000), view, "splats", SfumatoShading="albedo", SfumatoSmoothOutlines="false")
    solid = shot(view, "solid")
    display.Opacity = 0.25
    sheet(view, 8.0, 1, [0, 0, 1])  # added later, and behind
    got = shot(view, "clear")
    wall = np.where(np.arange(SIZE[0])[None, :, None] >= SIZE[0] // 2, [0, 0, 255], [255, 255, 255])
    drawn = (solid < 250).any(axis=2)
    expected = np.where(drawn[..., None], 0.25 * solid + 0.75 * wall, wall)
    d = np.abs(got - expected).max(axis=2)
    assert drawn.mean() > 0.1 and (d[drawn] <= 3).mean() > 0.97, (d[drawn] <= 3).mean()


def colors():
    view = view_of()
    display = show(source(20000), view, "points", SfumatoShading="albedo", SfumatoEdl="false", SfumatoSmoothOutlines="false",
                   SfumatoAmbientOcclusion="0")
    display.MapScalars = 1
    pv.ColorBy(display, ("POINTS", "height"))
    table = pv.GetColorTransferFunction("height")
    table.RGBPoints = [-0.4, 1, 0, 0, 0.4, 0, 0, 1]
    table.ColorSpace = "RGB"
    got = shot(view, "ramp")
    drawn = got[(got != 255).any(axis=2)]
    assert len(drawn) > 5000 and (np.abs(drawn[:, 0] + drawn[:, 2] - 255) <= 2).all() and (drawn[:, 1] <= 1).all()
    table.RGBPoints = [-0.4, 0, 1, 0, 0.4, 0, 1, 0]
    got = shot(view, "green")
    assert (got[(got != 255).any(axis=2)] == [0, 255, 0]).all()


def state():
    """What ParaView draws beside points that nobody sees looks as it does without them."""
    view = view_of()
    points = source(5000)
    show(points, view, "points", Position=[1000, 0, 0])
    ball = pv.Show(pv.Sphere(Radius=0.8), view)
    ball.Representation, ball.EdgeColor = "Surface With Edges", [0, 0, 0]
    glass = pv.Show(pv.Sphere(Center=[0.5, 0, 0.5]), view)
    glass.Opacity = 0.4
    pv.Show(pv.Text(Text="text"), view)
    with_points = shot(view, "with")
    pv.Hide(points, view)
    d = differences(with_points, shot(view, "without"))
    print("differ:", (d > 0).sum(), d.max())
    # Depths have other steps where the view reaches farther.
    assert (d > 8).mean() < 0.001, "depths or state changed"


def host_state():
    """What ParaView believes of its OpenGL is true after a picture of points: vtkOpenGLState sets nothing twice."""
    view = view_of()
    show(source(5000), view, "points")
    shot(view, "points")
    window = view.GetRenderWindow()
    window.MakeCurrent()
    gl, state = ctypes.CDLL("libGL.so.1"), window.GetState()
    for name, value in {"BLEND": 0x0BE2, "DEPTH_TEST": 0x0B71, "CULL_FACE": 0x0B44, "SCISSOR_TEST": 0x0C11, "STENCIL_TEST": 0x0B90,
                        "MULTISAMPLE": 0x809D}.items():
        assert bool(gl.glIsEnabled(value)) == state.GetEnumState(value), name
    def integers(name, count):
        out = (ctypes.c_int * count)()
        gl.glGetIntegerv(name, out)
        return list(out)
    blend = [0, 0, 0, 0]
    state.GetBlendFuncState(blend)
    assert blend == [integers(k, 1)[0] for k in (0x80C9, 0x80C8, 0x80CB, 0x80CA)], blend
    viewport = [0, 0, 0, 0]
    state.vtkglGetIntegerv(0x0BA2, viewport)
    assert viewport == integers(0x0BA2, 4), viewport
    # Nothing of ours is left bound: program, vertex array, buffers of vertices and pixels, errors.
    for name, value in {"program": 0x8B8D, "vertex array": 0x85B5, "pixel pack": 0x88ED, "pixel unpack": 0x88EF}.items():
        assert integers(value, 1) == [0], (name, integers(value, 1))
    assert gl.glGetError() == 0


def resident_mb():
    with open("/proc/self/status") as status:
        return next(int(line.split()[1]) for line in status if line.startswith("VmRSS")) / 1024


def frames():
    view = view_of()
    show(source(20000, cells=True), view, ARGUMENTS[0] if ARGUMENTS else "splats")
    camera = view.GetActiveCamera()
    before = 0
    for frame in range(200):
        camera.Azimuth(1.8)
        pv.Render(view)
        if frame == 40: before = resident_mb()
    grown = resident_mb() - before
    print(f"160 frames: {before:.0f} MB, {grown:+.1f} MB")
    assert grown < 10


def ranks():
    technique, how = ARGUMENTS
    view = view_of()
    # A torus has no uncertain points.
    given, options = ({"SfumatoSoftField": "distance"}, ["--field", "distance"]) if technique == "soft" else ({}, [])
    display = show(source(40000, how, cells=True), view, technique, **given)
    got, expected = shot(view, "picture"), of_command(40000, technique, options=options)
    same(got, expected, f"{technique}, {how}, {RANKS} ranks", ALIKE_OF[technique])
    same(got, expected, "clearly", BY_MORE_THAN_8, 8)
    if technique != "surface": return
    display.SfumatoSurfacePointSpacing = "0.02"
    same(shot(view, "spaced"), of_command(40000, technique, options=["--point-spacing", "0.02"]), "of a known spacing", OF_ONE_DEPTH)


def switch():
    """One view of other techniques, and of other points under one: what was there before leaves no trace."""
    view = view_of()
    points = source(40000, "slab")
    display = show(points, view, "points")
    shots = []
    for technique in ("points", "splats", "soft", "surface", "layers", "denoise", "points"):
        display.SfumatoTechnique = technique
        shots.append(shot(view, f"{len(shots)}_{technique}"))
        same(shots[-1], of_command(40000, technique), technique, ALIKE_OF[technique])
    assert (shots[0] == shots[-1]).all(), "points after other techniques are others"
    for technique in ("splats", "soft", "surface", "layers", "denoise"):
        display.SfumatoTechnique = technique
        for n in (20000, 30000):
            points.Script = script(n, "slab", False)
            same(shot(view, f"{technique}_{n}"), of_command(n, technique), f"{technique} of {n} points", ALIKE_OF[technique])


def equal():
    """The pictures that ranks made, however points were spread; of points, surfaces and layers on 2 ranks and more alike, of
    splats, soft and denoise on so many (their neighbours' stretch of the curve has other ends, and sums round otherwise). One process
    measures the noise that relief leaves out at other places: of points one pixel is another by one step."""
    names = sorted(glob.glob(os.path.join(SCRATCH, f"ranks_{ARGUMENTS[0]}_*_picture.png")))
    assert len(names) == 8, names
    first = {}
    for name in names:
        ranks = int(re.search(r"_(\d)_picture", name)[1])
        other = first.setdefault(ranks if ARGUMENTS[0] in ("splats", "soft", "denoise") else min(ranks, 2), name)
        assert (pixels(name) == pixels(other)).all(), (name, other)
    for name in first.values():
        same(pixels(name), pixels(names[0]), name, max(ALIKE, ALIKE_OF[ARGUMENTS[0]]))


def reader():
    """Every point once, on however many ranks; what was read looks as it does in the command."""
    counts = 40000, 20000
    names = [os.path.join(SCRATCH, f"reader{RANKS}_{i}.laz") for i in range(2)]
    for count, name in zip(counts, names):
        subprocess.run([COMMAND, "convert", scan_file(count), "-o", name, "--quiet"], check=True)
    series = pv.OpenDataFile(names)
    assert series.GetXMLName() == "SfumatoReader", series.GetXMLName()
    series.UpdatePipeline()
    assert len(series.TimestepValues) == 2, series.TimestepValues
    types = {array.GetName(): array.GetDataType() for array in series.PointData.values()}
    assert "RGB" in types and types["classification"] == VTK_UNSIGNED_CHAR, types
    view = view_of()
    show(series, view, "points")
    for time, count in enumerate(counts):
        series.UpdatePipeline(time)
        assert series.GetDataInformation().GetNumberOfPoints() == count
        view.ViewTime = time
        same(shot(view, f"time{time}"), of_command(count, "points", file=names[time]), f"time {time}", OF_ONE_DEPTH)


def read_for_views():
    """Points of each view that was read since this was asked last."""
    texts = [vtkTimerLog.GetEventString(i) or "" for i in range(vtkTimerLog.GetNumberOfEvents())]
    vtkTimerLog.ResetLog()
    return [int(found[1]) for found in (re.match(r"sfumato: (\d+) points of", text) for text in texts) if found]


def levels():
    """Of a file with more points than the budget each view has what it needs, on however many ranks; filters have the
    coarse levels."""
    total, budget = 800000, 130000  # the coarsest level has 40,000, the next one 103,000
    name = os.path.join(SCRATCH, f"levels{RANKS}.copc.laz")
    subprocess.run([COMMAND, "build", scan_file(total), "-o", name, "--quiet"], check=True)
    points = pv.OpenDataFile(name)
    points.PointBudget = budget
    points.UpdatePipeline()
    coarse = points.GetDataInformation().GetNumberOfPoints()
    assert 30000 < coarse < 50000, coarse
    view = view_of()
    pixels_of_points = dict(SfumatoPointsPointSize=10, SfumatoPointsSizeMode="pixels")
    options = ["--point-size", "10", "--size-mode", "pixels"]
    show(points, view, "points", **pixels_of_points)
    read_for_views()
    far = shot(view, "far")
    assert 0 < max(read_for_views()) <= budget
    of_all = of_command(total, "points", file=name, options=options)
    d = differences(far, of_all)
    print(f"far: {(d > 8).mean():.2%} of the pixels differ from all points by more than 8")
    # So near the surface that only the finest level covers it.
    CAMERA.update(position=[1.35, 0.571, 0.587], target=[1.15, 0.486, 0.313])
    near = shot(view, "near")
    read = read_for_views()
    assert len(read) == 1 and read[0] <= budget, read
    of_all = of_command(total, "points", file=name, options=options)
    same(near, of_all, "near", 0.01, 8)
    # The tiles of a larger picture: one view of them all, and sizes alike.
    pv.SaveScreenshot(os.path.join(SCRATCH, f"levels_large_{RANKS}.png"), view, ImageResolution=[2 * side for side in SIZE])
    assert len(read_for_views()) <= 1
    assert (shot(view, "small") == near).all()
    read_for_views()
    # The same view once more, and one that somebody is on the way to: what is there stays.
    assert (shot(view, "again") == near).all()
    view.CameraPosition = [3.0, -4.0, 2.5]
    view.SMProxy.InteractiveRender()
    assert not read_for_views()
    # A filter's own points, which are those of the coarse levels.
    pv.Hide(points, view)
    moved = pv.Transform(points)
    moved.Transform.Translate = [0.0, 0.0, 0.0]
    show(moved, view, "points", **pixels_of_points)
    alone = shot(view, "coarse")
    d = differences(alone, of_all)
    print(f"the coarse levels alone: {(d > 8).mean():.2%} of the pixels differ by more than 8")
    assert (d > 8).mean() > 0.3
    pv.Hide(moved, view)
    # One that leaves the places as they are, and adds values that the file does not have.
    doubled = pv.Calculator(points)
    doubled.Function = "2 * coordsZ"
    show(doubled, view, "points", **pixels_of_points)
    assert (shot(view, "values") == alone).all()
    assert not read_for_views()
    pv.Hide(doubled, view)
    # All points, where they are asked for.
    points.PointBudget = 0
    points.UpdatePipeline()
    assert points.GetDataInformation().GetNumberOfPoints() == total
    show(points, view, "points", **pixels_of_points)
    same(shot(view, "all"), of_all, "all", OF_ONE_DEPTH)
    assert not read_for_views()


def levels_are_equal():
    for what in ("far", "near", "coarse"):
        one, two, four = (pixels(os.path.join(SCRATCH, f"levels_{ranks}_{what}.png")) for ranks in (1, 2, 4))
        assert (two == four).all(), what
        same(one, two, what, ALIKE)


def server():
    """What the ranks of a server draw, and what the client draws of their points: the command's picture."""
    technique = ARGUMENTS[0]
    view = view_of()
    show(source(40000), view, technique)
    for where, megabytes in {"server": 0, "client": 1e6}.items():
        view.RemoteRenderThreshold = megabytes
        pv.Render(view)
        assert bool(view.GetClientSideObject().GetUseDistributedRenderingForRender()) == (where == "server")
        same(shot(view, where), of_command(40000, technique), f"{technique}, by the {where}", ALIKE_OF[technique])


def examples():
    """Those of examples/paraview, as their first lines say; `in_situ`, where it is built, is the last argument."""
    folder = os.path.join(os.path.dirname(__file__), "../../examples/paraview")
    scratch = tempfile.TemporaryDirectory(dir=SCRATCH)
    def path(name): return os.path.join(scratch.name, name)
    def run(ranks, *words, **environment):
        subprocess.run(launched(ranks, *words), env=ENVIRONMENT | environment, check=True)
    def shows_something(name, size):
        picture = pixels(path(name))
        assert picture.shape[:2] == size, picture.shape
        background = picture[0, 0]
        assert (np.abs(picture - background).max(axis=2) > 8).mean() > 0.05, name
        return picture
    tiles = [path(f"tile_{i}.laz") for i in range(3)]
    for i, tile in enumerate(tiles):
        subprocess.run([COMMAND, "synth", "courtyard", "--points", str(20000 * (i + 1)), "--quiet", "-o", tile], check=True)
    run(2, "pvbatch", os.path.join(folder, "city.py"), PLUGIN, path("city.png"), "640x360", *tiles)
    shows_something("city.png", (360, 640))
    run(1, "pvbatch", os.path.join(folder, "time_series.py"), PLUGIN, path("series/step.png"), *tiles)
    steps = [shows_something(f"series/step.{i:04d}.png", (720, 1280)) for i in range(3)]
    assert (steps[0] != steps[2]).any()
    if ARGUMENTS:
        run(2, ARGUMENTS[0], os.path.join(folder, "in_situ.py"), "3", SFUMATO_PLUGIN=PLUGIN, PICTURES=scratch.name)
        first, last = (shows_something(f"step_{i:03d}.png", (480, 640)) for i in (0, 2))
        assert (first != last).any()


globals()[CASE]()
print("PASSED")
