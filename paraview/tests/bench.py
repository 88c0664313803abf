"""Seconds a frame of 1280 x 720 beside Point Gaussian: with_display [mpirun -np N] pvbatch bench.py PLUGIN POINTS [NAME...]"""
import re
import sys
import time

PLUGIN, POINTS = sys.argv[1], int(float(sys.argv[2]))
NAMES = sys.argv[3:] or ["Point Gaussian", "points", "splats"]
sys.argv = [sys.argv[0], "", PLUGIN, "/tmp", "bench"]
with open(__file__.replace("bench.py", "cases.py")) as file:
    exec(file.read().rsplit("globals()[CASE]()", 1)[0])

from vtkmodules.vtkCommonSystem import vtkTimerLog


def merged_bytes():
    """That this rank sent since it was asked last: of pixels, for each frame."""
    texts = [vtkTimerLog.GetEventString(i) or "" for i in range(vtkTimerLog.GetNumberOfEvents())]
    sent = [int(found[1]) for found in (re.match(r"sfumato: (\d+) bytes", text) for text in texts) if found]
    vtkTimerLog.ResetLog()
    return int(np.median(sent)) if sent else 0


view = view_of([1280, 720])
points = source(POINTS, "slab", cells=True)
display = pv.Show(points, view)
pv.ColorBy(display, ("POINTS", "RGB"))
display.MapScalars = 0
display.GaussianRadius = 0.005
view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = CAMERA["position"], CAMERA["target"], CAMERA["up"]
for name in NAMES:
    display.Representation = "Sfumato" if name != "Point Gaussian" else name
    if name != "Point Gaussian": display.SfumatoTechnique = name
    started = time.perf_counter()
    pv.Render(view)
    first = time.perf_counter() - started
    frames = []
    for _ in range(5):
        view.GetActiveCamera().Azimuth(7)
        started = time.perf_counter()
        pv.Render(view)
        frames.append(time.perf_counter() - started)
    print(f"{POINTS} points, {RANKS} ranks, {name}: first {first:.2f} s, then {np.median(frames):.3f} s", flush=True)
    if merged := merged_bytes(): print(f"bytes merged a frame: {merged}", flush=True)
