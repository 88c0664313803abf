"""Looks as keywords: presets of the command, and what is written as one."""
import os

from . import _engine
from ._camera import Camera
from ._error import Error
from ._techniques import is_parameter, text_of


def _bool(name, text):
    if text in ("true", "on", "yes", "1"):
        return True
    if text in ("false", "off", "no", "0"):
        return False
    raise Error(f"{name}: '{text}' is not true or false", "bad_input")


def _number(name, text):
    try:
        return float(text)
    except ValueError:
        raise Error(f"{name}: '{text}' is not a number", "bad_input") from None


def _numbers(name, text):
    return tuple(_number(name, word) for word in text.split(","))


def _integers(name, text):
    return [] if text in ("", "none") else [int(_number(name, word)) for word in text.split(",")]


def _text(_, text):
    return text


def _size(name, text):
    width, x, height = text.partition("x")
    if not (x and width.isdigit() and height.isdigit()):
        raise Error(f"{name}: '{text}' is not WIDTHxHEIGHT", "bad_input")
    return int(width), int(height)


def _words(_, text):
    return text.split(",")


def count_of(name, value):
    """A whole number of at least 1, also as the command takes it: "250k", "4G"."""
    if value is None:
        return None
    found = _engine.parse_count(value) if isinstance(value, str) else value
    if found is None or found < 1 or found != int(found):
        raise Error(f"{name}: '{value}' is not a whole number of at least 1 (1000, \"250k\", \"2M\")")
    return int(found)


#: What is drawn into pictures, as keywords.
FURNITURE = tuple(name.replace("-", "_") for name in _engine.furniture_options())


def furniture_of(keywords):
    """Names and texts of those keywords that are given."""
    return [(name.replace("_", "-"), text_of(name, keywords[name])) for name in FURNITURE
            if keywords.get(name) is not None]


#: Options of the command as keywords of `Renderer`.
_OPTIONS = {
    "color-by": ("color_by", _text), "color": ("color", _text), "colormap": ("colormap", _text), "color-range": ("range", _numbers),
    "exposure": ("exposure", _number), "background-color": ("background", _text), "up": ("up", _text), "whole": ("whole", _bool),
    "crop": ("crop", _numbers), "crop-relative": ("crop_relative", _numbers), "show-classes": ("show_classes", _integers),
    "hide-classes": ("hide_classes", _integers), "max-points": ("max_points", count_of), "vertices": ("vertices", _bool), "columns": ("columns", _words),
    "vertical-exaggeration": ("vertical_exaggeration", _number)}
_REPEATED = {"draw": "draw", "filter": "filters"}
#: And of `Renderer.view`.
_VIEWS = {
    "view": ("side", _text), "zoom": ("zoom", _number), "roll": ("roll", _number), "distance": ("distance", _number),
    "camera-azimuth-angle": ("azimuth", _number), "camera-elevation-angle": ("elevation", _number),
    "camera-view-angle": ("fov", _number), "camera-orthographic": ("orthographic", _bool), "camera-position": ("position", _numbers),
    "camera-focal-point": ("look_at", _numbers), "camera-direction": ("direction", _numbers), "camera-view-up": ("view_up", _numbers),
    "resolution": ("size", _size), "pixel-size": ("pixel_size", _number), "scale": ("scale", _text), "dpi": ("dpi", _number)}
#: What says how a file is written, not how a picture looks.
_OF_FILES = ("quality", "world-file")


class Look:
    """What a preset says: `keywords` of `Renderer`, `parameters` as names and texts, `view` for `Renderer.view`, and `camera`."""

    def __init__(self):
        self.file = ""
        self.keywords, self.parameters, self.view, self.camera, self.files = {}, [], {}, None, []

    @classmethod
    def load(cls, file):
        """Of a preset or a scene; raises `Error` ("bad_input")."""
        look = cls()
        look.file = os.fspath(file)
        found = _engine.load_preset(look.file)
        if found["technique"]:
            look.keywords["technique"] = found["technique"]
        look.parameters, look.files = found["parameters"], found["files"]
        if found["camera"] is not None:
            look.camera = Camera._of(found["camera"])
        own = []
        for name, text in found["options"]:
            if name in _REPEATED:
                look.keywords.setdefault(_REPEATED[name], []).append(text)
            elif name.replace("-", "_") in FURNITURE:
                look.keywords[name.replace("-", "_")] = text
            elif name in _OPTIONS:
                keyword, parse = _OPTIONS[name]
                look.keywords[keyword] = parse(f"{look.file}: options: {name}", text)
            elif name in _VIEWS:
                keyword, parse = _VIEWS[name]
                look.view[keyword] = parse(f"{look.file}: options: {name}", text)
            elif name == "no-background":
                if _bool(name, text):
                    look.keywords["background"] = "transparent"
            elif is_parameter(name):  # of a technique: as good among the options
                own.append((name.replace("-", "_"), text))
            elif name not in _OF_FILES:
                near = _engine.nearest_word(name, [*_OPTIONS, *_VIEWS, *_REPEATED, *_engine.furniture_options(), "no-background"])
                raise Error(f"{look.file}: options: there is no '{name}'" + (f"; did you mean '{near}'?" if near else ""), "bad_input")
        look.parameters = own + look.parameters
        return look

    @classmethod
    def of(cls, preset):
        """A file, or keywords of `render` as a dict."""
        if preset is None:
            return cls()
        if isinstance(preset, (str, os.PathLike)):
            look = cls.load(preset)
            if look.files:
                raise Error(f"{look.file} names files, so it is a scene: sfumato.Scene.load(\"{look.file}\")")
            return look
        look = cls()
        look.file = "preset"
        for name, value in dict(preset).items():
            if name == "camera" and not isinstance(value, dict):
                look.camera = value
            elif name == "camera":
                look.view.update(value)
            elif name == "size":
                look.view["size"] = value
            elif name in KEYWORDS:
                look.keywords[name] = value
            else:
                look.parameters.append((name, text_of(name, value)))
        return look


#: Keywords of `Renderer` with what they are when nobody says otherwise.
KEYWORDS = {"technique": "auto", "background": "auto", "up": None, "color": None, "color_by": None, "colormap": None, "range": None,
            "exposure": None, "hide_classes": (7, 18), "show_classes": None, "filters": (), "crop": None, "crop_relative": None,
            "max_points": None, "columns": (), "whole": False, "vertices": False, "draw": (), "vertical_exaggeration": None,
            **dict.fromkeys(FURNITURE)}


def is_default(name, value):
    """Whether a keyword is as when nobody says otherwise. Arrays of numpy never are."""
    if isinstance(value, (list, tuple)):
        return tuple(value) == KEYWORDS[name]
    return value is None or (isinstance(value, (str, bool, int, float)) and value == KEYWORDS[name])


def options_of(keywords, is_scene=False):
    """Keywords as options of the command, for a preset or a scene; what is as always is left out."""
    names = {keyword: option for option, (keyword, _) in _OPTIONS.items()}
    options = []
    for name, value in keywords.items():
        if name == "technique" or is_default(name, value):
            continue
        if name == "background" and isinstance(value, str) and value == "transparent":
            options.append(("no-background", "true"))
        elif name in ("draw", "filters"):
            options += [("draw" if name == "draw" else "filter", rule) for rule in value]
        elif name == "hide_classes":
            options.append(("hide-classes", ",".join(map(str, value)) or "none"))
        elif name == "crop" and not is_scene:
            raise Error("a preset holds no crop in world coordinates; crop_relative holds for any scan")
        elif name in ("crop", "crop_relative"):
            numbers = [number for each in value for number in (each if hasattr(each, "__iter__") else (each,))]  # maybe two corners
            options.append((names[name], text_of(name, numbers)))
        elif name in FURNITURE:
            options.append((name.replace("_", "-"), text_of(name, value)))
        elif name in names:
            options.append((names[name], text_of(name, value)))
    return options
