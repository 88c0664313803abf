# script-version: 2.0
"""What ParaView's Catalyst draws of a simulation while it runs (in_situ.cpp): a picture of each step."""
import os

from paraview import catalyst
from paraview.simple import *

LoadPlugin(os.environ["SFUMATO_PLUGIN"], remote=False, ns=globals())

particles = TrivialProducer(registrationName="particles")
view = CreateView("RenderView")
view.ViewSize = [640, 480]
view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = [0, -6, 3], [0, 0, 0], [0, 0, 1]
display = Show(particles, view)
display.Representation = "Sfumato"
display.SfumatoTechnique = "splats"
ColorBy(display, ("POINTS", "speed"))

pictures = CreateExtractor("PNG", view, registrationName="pictures")
pictures.Writer.FileName = "step_{timestep:03d}.png"
pictures.Writer.ImageResolution = view.ViewSize

options = catalyst.Options()
options.ExtractsOutputDirectory = os.environ["PICTURES"]
