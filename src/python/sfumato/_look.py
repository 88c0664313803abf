"""Looks as keywords: presets of the command, and what is written as one."""
import math
import numbers
import os
import sys

from . import _engine
from ._camera import Camera
from ._error import Error
from ._techniques import is_parameter, text_of


def _numbers(text):
    return tuple(map(float, text.split(",")))


def _integers(text):
    return [] if text in ("", "none") else list(map(int, text.split(",")))


def _size(text):
    return tuple(map(int, text.split("x")))


def count_of(name, value):
    """A whole number of at least 1, also as the command takes it: "250k", "4G"."""
    if value is None:
        return None
    found = _engine.parse_count(value) if isinstance(value, str) else value
    if found is None or found < 1 or found != int(found):
        raise Error(f"{name}: '{value}' is not a whole number of at least 1 (1000, \"250k\", \"2M\")")
    return int(found)


#: Of the text that the table of options writes.
_KINDS = {"flag": lambda text: text == "true", "number": float, "numbers": _numbers, "integers": _integers,
          "count": lambda text: int(_engine.parse_count(text)), "size": _size, "words": lambda text: text.split(","),
          "text": str, "texts": str, "furniture": str}
_ALL = _engine.options()
#: What is drawn into pictures, as keywords.
FURNITURE = tuple(keyword for _, keyword, kind, _ in _ALL if kind == "furniture")


def furniture_of(keywords):
    """Names and texts of those keywords that are given."""
    return [option for name in FURNITURE for option in texts_of(name, keywords.get(name))]


#: Options of the command: keyword, kind and reader, of `Renderer` and of `Renderer.view`.
_OPTIONS = {name: (keyword, kind, _KINDS[kind]) for name, keyword, kind, of in _ALL if of == "look" and kind}
_VIEWS = {name: (keyword, kind, _KINDS[kind]) for name, keyword, kind, of in _ALL if of == "view" and kind}
_NAMES = {keyword: name for name, (keyword, _, _) in {**_OPTIONS, **_VIEWS}.items()}
#: What says how a file is written, not how a picture looks.
_OF_FILES = tuple(name for name, _, _, of in _ALL if of == "file")


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
            where = f"{look.file}: options: {name}"
            if name in _OPTIONS or name in _VIEWS or name == "no-background":
                text = _engine.option_text(where, name, text)
            if text is None:  # as by default, also where a scene says otherwise
                if name in _OPTIONS:
                    look.keywords[_OPTIONS[name][0]] = KEYWORDS[_OPTIONS[name][0]]
            elif name in _OPTIONS and _OPTIONS[name][1] == "texts":
                look.keywords.setdefault(_OPTIONS[name][0], []).append(text)
            elif name in _OPTIONS or name in _VIEWS:
                keyword, _, parse = _OPTIONS.get(name) or _VIEWS[name]
                (look.keywords if name in _OPTIONS else look.view)[keyword] = parse(text)
            elif name == "no-background":
                if text == "true":
                    look.keywords["background"] = "transparent"
            elif is_parameter(name):  # of a technique: as good among the options
                own.append((name.replace("-", "_"), text))
            elif name not in _OF_FILES:
                near = _engine.nearest_word(name, [*_OPTIONS, *_VIEWS, "no-background"])
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
KEYWORDS = {"technique": "auto", **{keyword: {"flag": False, "texts": (), "words": ()}.get(kind) for keyword, kind, _ in _OPTIONS.values()},
            "background": "auto", "hide_classes": (7, 18)}


def is_default(name, value):
    """Whether a keyword is as when nobody says otherwise. Arrays of numpy never are, nor no classes to hide."""
    if name == "hide_classes" and value is None:
        return False
    if isinstance(value, (list, tuple)):
        return tuple(value) == KEYWORDS[name]
    return value is None or (isinstance(value, (str, bool, int, float)) and value == KEYWORDS[name])


def texts_of(keyword, value):
    """Options of the command and their texts, which say what a keyword does; none for None, and for what is off."""
    name = _NAMES.get(keyword, keyword)
    if keyword == "hide_classes" and value is None:
        value = ()
    if keyword in ("max_points", "memory") and isinstance(value, numbers.Integral):
        value = min(value, 9 * 10**15)  # the most that the command takes
    if value is None or value is False:
        return []
    if keyword == "background" and isinstance(value, str) and value == "transparent":
        return [("no-background", "true")]
    if keyword in ("draw", "filters"):
        return [(name, str(rule)) for rule in ([value] if isinstance(value, str) else value)]
    if keyword in ("crop", "crop_relative") and not isinstance(value, str):
        return [(name, text_of(keyword, _six(value)))]
    return [(name, text_of(keyword, value) or ("none" if keyword == "hide_classes" else ""))]


def _six(values):
    """Six numbers, maybe given as two corners; open ends are as far as numbers reach, for the command knows no infinite ones."""
    ends = [end for each in values for end in (each if hasattr(each, "__iter__") and not isinstance(each, str) else (each,))]
    return [math.copysign(sys.float_info.max, end) if hasattr(end, "__float__") and math.isinf(end) else end for end in ends]


def options_of(keywords):
    """Keywords as options of the command and their texts, for a preset or a scene; what is as always is left out."""
    return [option for name, value in keywords.items() if name != "technique" and not is_default(name, value)
            for option in texts_of(name, value)]


def request_of(options=(), start=None, **keywords):
    """What the engine is asked for: these options and those of keywords. A view begins from the camera `start`."""
    return _engine.Request([*options, *(option for name, value in keywords.items() for option in texts_of(name, value))], start)
