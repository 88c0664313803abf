"""A city of tiles on MPI ranks as one picture: each rank reads its part of every tile.

    mpirun -np 8 pvbatch city.py Sfumato.so city.png 3840x2160 tiles/*.laz
"""
import sys

from paraview.simple import *

plugin, picture, size, *tiles = sys.argv[1:]
LoadPlugin(plugin, remote=False, ns=globals())

city = AppendGeometry(Input=[OpenDataFile(tile) for tile in tiles])
city.UpdatePipeline()

view = CreateView("RenderView")
view.ViewSize = [int(side) for side in size.split("x")]
view.UseColorPaletteForBackground = 0
view.Background = [1, 1, 1]
view.OrientationAxesVisibility = 0

display = Show(city, view)
display.Representation = "Sfumato"
display.SfumatoTechnique = "splats"
if "RGB" in city.PointData.keys():
    ColorBy(display, ("POINTS", "RGB"))
    display.MapScalars = 0
else:
    ColorBy(display, ("POINTS", "Points", "Z"))

# From the south, 40 degrees above the plain.
view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = [0, -0.77, 0.64], [0, 0, 0], [0, 0, 1]
ResetCamera(view)
view.GetActiveCamera().Zoom(1.4)  # ParaView leaves room for scenes that turn
SaveScreenshot(picture, view)
