"""Seconds a frame of 1280 x 720 beside Point Gaussian, of so many points of a torus or of a scan:

    with_display [mpirun -np N] pvbatch bench.py PLUGIN POINTS|FILE [NAME...]
"""
import re
import sys
import time

PLUGIN, SCENE = sys.argv[1:3]
NAMES = sys.argv[3:] or ["Point Gaussian", "points", "splats"]
sys.argv = [sys.argv[0], "", PLUGIN, "/tmp", "bench"]
with open(__file__.replace("bench.py", "cases.py")) as file:
    exec(file.read().rsplit("globals()[CASE]()", 1)[0])


def merged_bytes():
    """That this rank sent since it was asked last: of pixels, for each frame."""
    texts = [vtkTimerLog.GetEventString(i) or "" for i in range(vtkTimerLog.GetNumberOfEvents())]
    sent = [int(found[1]) for found in (re.match(r"sfumato: (\d+) bytes", text) for text in texts) if found]
    vtkTimerLog.ResetLog()
    return int(np.median(sent)) if sent else 0


view = view_of([1280, 720])
if SCENE[0].isdigit():
    display = pv.Show(source(int(float(SCENE)), "slab", cells=True), view)
    display.GaussianRadius = 0.005
    view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = CAMERA["position"], CAMERA["target"], CAMERA["up"]
else:
    started = time.perf_counter()
    display = pv.Show(pv.OpenDataFile(SCENE), view)
    print(f"{SCENE}, {RANKS} ranks: read in {time.perf_counter() - started:.2f} s", flush=True)
    view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = [0, -0.77, 0.64], [0, 0, 0], [0, 0, 1]
    pv.ResetCamera(view)
pv.ColorBy(display, ("POINTS", "RGB"))
display.MapScalars = 0
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
    print(f"{SCENE}, {RANKS} ranks, {name}: first {first:.2f} s, then {np.median(frames):.3f} s", flush=True)
    if merged := merged_bytes(): print(f"bytes merged a frame: {merged}", flush=True)
