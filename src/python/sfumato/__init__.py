"""sfumato: point clouds to pictures.

>>> import sfumato
>>> sfumato.render("scan.laz").save("scan.png")
>>> sfumato.render(xyz, rgb, technique="surface", shadows="soft").save("points.png")

No display and no GPU needed: what draws is OpenGL 4.5, also in software. docs/python.md is the guide.
"""
import atexit as _atexit

from . import _driver

_driver.prepare()
from . import _engine, analysis
from ._camera import Camera, orbit, path
from ._cloud import Cloud, Levels, Scalars, formats, open, read, synth, write
from ._error import Error, PartialWarning
from ._render import Picture, Renderer, colormap, colormaps, contact_sheet, render
from ._scene import Item, Scene
from ._serve import Server, serve
from ._techniques import Parameter, Technique, analysis_parameters, techniques

__version__ = _engine.version()
# `open` is left out: "from sfumato import *" would hide Python's own.
__all__ = ["Camera", "Cloud", "Error", "Item", "Levels", "Parameter", "PartialWarning", "Picture", "Renderer", "Scalars", "Scene", "Server", "Technique",
           "analysis", "analysis_parameters", "colormap", "colormaps", "contact_sheet", "formats", "orbit", "path", "read", "render", "serve", "synth",
           "techniques", "write"]

# The driver wants its context closed before the process ends.
_atexit.register(_engine.stop)
