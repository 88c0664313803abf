"""Scans of one place at several times as numbered pictures of one view.

    pvbatch time_series.py Sfumato.so pictures/step.png scans/scan_*.laz    in the order in which they are given
"""
import os
import sys

from paraview.simple import *

plugin, pictures, *scans = sys.argv[1:]
LoadPlugin(plugin, remote=False, ns=globals())

series = OpenDataFile(scans)
series.UpdatePipeline()
view = CreateView("RenderView")
view.ViewSize = [1280, 720]
display = Show(series, view)
display.Representation = "Sfumato"
display.SfumatoTechnique = "splats"
if "RGB" in series.PointData.keys():
    ColorBy(display, ("POINTS", "RGB"))
    display.MapScalars = 0
else:
    ColorBy(display, ("POINTS", "Points", "Z"))
view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = [0, -0.77, 0.64], [0, 0, 0], [0, 0, 1]
ResetCamera(view)
view.GetActiveCamera().Zoom(1.4)  # ParaView leaves room for scenes that turn
os.makedirs(os.path.dirname(pictures) or ".", exist_ok=True)
GetAnimationScene().UpdateAnimationUsingDataTimeSteps()
SaveAnimation(pictures, view, FrameWindow=[0, len(scans) - 1])
