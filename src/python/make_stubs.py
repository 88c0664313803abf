#!/usr/bin/python3
"""Writes __init__.pyi and py.typed beside the built package: signatures and docstrings as they are, and every parameter of every
technique with its type, from the technique's own list.   usage: make_stubs.py BUILD/python/sfumato"""
import inspect
import os
import sys

TYPES = {"bool": "bool", "int": "int", "float": "float", "string": "str", "float_list": "Sequence[float]", "vec3": "Sequence[float]"}
#: By name, since one name means one thing.
ANNOTATIONS = {
    "points": "Points", "colors": "Union[ArrayLike, str, None]", "technique": "TechniqueName", "camera": "CameraLike",
    "size": "Optional[Tuple[int, int]]", "normals": "Optional[ArrayLike]", "scalars": "Optional[Mapping[str, ArrayLike]]",
    "radii": "Optional[ArrayLike]", "background": "Color", "up": "Optional[str]", "color": "Optional[Color]",
    "color_by": "Optional[str]", "colormap": "Optional[str]", "range": "Optional[Tuple[float, float]]",
    "hide_classes": "Optional[Sequence[int]]", "show_classes": "Optional[Sequence[int]]", "outputs": "Sequence[Output]",
    "progress": "Progress", "file": "Path", "files": "Union[Path, Sequence[Path]]", "xyz": "Any", "crs": "str",
    "position": "Sequence[float]", "target": "Sequence[float]", "fov": "float", "frames": "int", "degrees": "float",
    "start": "CameraLike", "keys": "Union[Path, Sequence[Camera]]", "cameras": "Iterable[CameraLike]", "fps": "float",
    "quality": "int", "side": "Optional[str]", "azimuth": "Optional[float]", "elevation": "Optional[float]", "zoom": "float",
    "roll": "float", "look_at": "Optional[Sequence[float]]", "distance": "Optional[float]", "orthographic": "bool",
    "pose": "ArrayLike", "convention": "Literal['opencv', 'opengl']", "camera_matrix": "ArrayLike", "rotation": "ArrayLike",
    "translation": "ArrayLike", "depth": "ArrayLike", "intrinsics": "Optional[ArrayLike]", "height_world": "Optional[float]",
    "columns": "Sequence[str]", "max_points": "Optional[int]", "crop": "Optional[Sequence[float]]",
    "crop_relative": "Optional[Sequence[float]]", "filters": "Union[str, Sequence[str]]", "every_attribute": "bool", "vertices": "bool", "scene": "str",
    "mesh": "Optional[Path]", "name": "Optional[str]", "neighbors": "int", "min_size": "int", "point_threshold": "float",
    "region_threshold": "float", "gap": "Optional[float]", "angle": "float", "bend": "float", "text": "str", "width": "int",
    "height": "int", "whole": "bool", "draw": "Union[str, Sequence[str]]", "more": "Path", "which": "Any", "exposure": "Optional[float]", "class_colors": "Optional[str]",
    "memory": "Union[int, str, None]", "preset": "Union[Path, Dict[str, Any], None]", "panorama": "bool", "legend": "Optional[bool]",
    "direction": "Optional[Sequence[float]]", "view_up": "Optional[Sequence[float]]", "shadows": "bool", "items": "Any", "camera": "CameraLike",
    "transform": "Optional[ArrayLike]", "pictures": "Iterable[Picture]", "port": "int", "folder": "str", "words": "Sequence[str]", "labels": "Optional[Sequence[str]]", "count": "int"}
RETURNS = {
    "render": "Picture", "read": "Cloud", "synth": "Cloud", "write": "List[str]", "formats": "List[Dict[str, Any]]",
    "colormaps": "List[str]", "techniques": "Any", "analysis_parameters": "List[Parameter]", "orbit": "List[Camera]",
    "path": "List[Camera]", "view": "Camera", "frames": "Iterator[Picture]", "look_at": "Camera", "from_pose": "Camera",
    "from_opencv": "Camera", "from_json": "Camera", "load": "Camera", "resized": "Camera", "replace": "Camera", "pose": "Array",
    "matrix": "Array", "project": "Array", "unproject": "Array", "to_structured": "Array", "__len__": "int", "__getitem__": "Cloud",
    "__enter__": "Any", "serve": "Server", "open": "Levels", "colormap": "Array", "contact_sheet": "Picture",
    "rules": "List[str]", "to_json": "str", "spacing": "float", "normals": "Array", "uncertainty": "Array", "clusters": "Array"}
PROPERTIES = {
    "Cloud": {"positions": "Array", "xyz": "Array", "origin": "Tuple[float, float, float]", "colors": "Optional[Array]",
              "normals": "Optional[Array]", "radii": "Optional[Array]", "scalars": "Scalars", "up": "Optional[str]", "crs": "str",
              "bounds": "Tuple[Tuple[float, float, float], Tuple[float, float, float]]", "kept": "Optional[Array]",
              "notes": "List[str]"},
    "Picture": {"rgba": "Array", "linear": "Array", "depth": "Array", "normal": "Array", "index": "Array", "alpha": "Array", "camera": "Camera",
                "size": "Tuple[int, int]", "technique": "str", "reason": "str", "parameters": "Dict[str, Any]",
                "analysis_parameters": "Dict[str, Any]", "color_by": "str", "background": "Tuple[float, float, float]",
                "legend": "Optional[Dict[str, Any]]", "notes": "List[str]"},
    "Levels": {"bounds": "Tuple[Tuple[float, float, float], Tuple[float, float, float]]", "levels": "List[Tuple[int, float]]", "crs": "str"},
    "Renderer": {"technique": "str", "up": "str"},
    "Server": {"address": "str", "running": "bool"}}
HEAD = '''# Written by src/python/make_stubs.py when the package was built.
import os
from typing import Any, Callable, Dict, Iterable, Iterator, List, Literal, Mapping, MutableMapping, Optional, Sequence, Tuple, Union

from . import analysis as analysis
from ._techniques import Parameter as Parameter, Technique as Technique

Array = Any  # numpy.ndarray
ArrayLike = Any
Path = Union[str, "os.PathLike[str]"]
Points = Any  # array (N, 3), path, Cloud, or a point cloud of another library
Color = Union[str, Sequence[float]]
Progress = Any  # None, a function of (share, text), or a tqdm bar
'''


def type_of(parameter):
    kind = "Literal[" + ", ".join(map(repr, parameter.choices)) + "]" if parameter.choices else TYPES[parameter.kind]
    return f"Union[{kind}, Literal['auto'], None]" if parameter.auto else kind


def all_parameters(sfumato):
    """By name: its types in all techniques, and what it does in the first that has it."""
    found = {}
    for technique in sfumato.techniques():
        for parameter in technique.parameters + technique.shared_parameters:
            found.setdefault(parameter.name, []).append((type_of(parameter), parameter.help))
    for parameter in sfumato.analysis_parameters():
        found.setdefault(parameter.name, []).append((type_of(parameter), parameter.help))
    return found


def quoted(text, indent):
    return "" if not text else f'{indent}"""' + text.replace("\\", "\\\\").replace('"""', "'''") + '"""\n'


def signature(function, parameters, owner=None):
    words = []
    for name, value in inspect.signature(function).parameters.items():
        if name in ("self", "cls"):
            words.append(name)
            continue
        if value.kind is value.VAR_KEYWORD:
            taken = set(inspect.signature(function).parameters)
            for each, kinds in parameters.items():
                if each not in taken:
                    types = list(dict.fromkeys(kind for kind, _ in kinds))
                    words.append(f"{each}: {types[0] if len(types) == 1 else 'Union[' + ', '.join(types) + ']'} = ...")
            words.append("**more_parameters: Any" if parameters else f"**{name}: Any")
            continue
        star = "*" if value.kind is value.VAR_POSITIONAL else ""
        default = "" if value.default is value.empty else f" = {value.default!r}"
        annotation = ANNOTATIONS.get(name, "Any")
        if name == "technique" and value.default is None:
            annotation = f"Optional[{annotation}]"
        if value.kind is value.KEYWORD_ONLY and not any(word.startswith("*") for word in words):
            words.append("*")
        words.append(f"{star}{name}: {annotation}{default}")
    return ", ".join(words)


def function_stub(name, function, parameters, indent="", decorator=""):
    returns = RETURNS.get(name, "None")
    text = f"{indent}{decorator}" if decorator else ""
    text += f"{indent}def {name}({signature(function, parameters)}) -> {returns}:\n"
    return text + (quoted(inspect.getdoc(function), indent + "    ") or "") + f"{indent}    ...\n"


#: What objects have beside their properties.
FIELDS = {"Renderer": {"legend": "bool"}, "Item": {"points": "Any", "transform": "Any", "technique": "Optional[str]",
          "parameters": "Dict[str, Any]"}, "Scene": {"items": "List[Item]", "draw": "List[str]", "camera": "Optional[Camera]",
          "look": "Dict[str, Any]"}}


def class_stub(name, kind, parameters):
    base = {"Error": "Exception", "Scalars": "MutableMapping[str, Array]"}.get(name)
    text = f"class {name}{'(' + base + ')' if base else ''}:\n" + quoted(inspect.getdoc(kind), "    ")
    if name == "Error":
        return text + "    code: Literal['usage', 'bad_input', 'partial', 'no_gl', 'out_of_memory', 'io', 'internal', 'interrupted']\n" \
            "    def __init__(self, message: str, code: str = ...) -> None: ...\n"
    if name == "Camera":
        text += "".join(f"    {field}: {of}\n" for field, of in (
            ("position", "Tuple[float, float, float]"), ("target", "Tuple[float, float, float]"), ("up", "Tuple[float, float, float]"),
            ("fov", "float"), ("size", "Tuple[int, int]"), ("orthographic", "bool"), ("height_world", "float"),
            ("custom_intrinsics", "Optional[Tuple[float, float, float, float]]")))
        text += "    @property\n    def intrinsics(self) -> Tuple[float, float, float, float]: ...\n"
        text += "    @property\n    def direction(self) -> Tuple[float, float, float]: ...\n"
        text += "    def view_matrix(self) -> Array: ...\n    def to_json(self) -> str: ...\n"
    text += "".join(f"    {field}: {of}\n" for field, of in FIELDS.get(name, {}).items())
    for member, value in vars(kind).items():
        if isinstance(value, property):
            if member.startswith("_"):
                continue
            returns = PROPERTIES[name][member]
            text += f"    @property\n    def {member}(self) -> {returns}:\n" + quoted(value.__doc__, "        ") + "        ...\n"
            if value.fset:
                text += f"    @{member}.setter\n    def {member}(self, value: Any) -> None: ...\n"
        elif isinstance(value, classmethod):
            stub = function_stub(member, value.__func__, {}, "    ", "@classmethod\n")
            text += stub.replace("-> Camera", f"-> {name}")
        elif inspect.isfunction(value) and (not member.startswith("_") or member in ("__init__", "__len__", "__getitem__", "__enter__")):
            if name == "Scalars":
                continue
            takes_all = name in ("Renderer", "Scene", "Item")
            stub = function_stub(member, value, parameters if takes_all else {}, "    ")
            text += stub.replace("-> Any", f"-> {name}") if member == "__enter__" else stub
    return text if text.endswith("\n") else text + "    ...\n"


def main():
    package = os.path.abspath(sys.argv[1])
    sys.path.insert(0, os.path.dirname(package))
    import sfumato

    parameters = all_parameters(sfumato)
    names = ["auto"] + [technique.name for technique in sfumato.techniques()]
    text = HEAD
    text += "TechniqueName = Literal[" + ", ".join(map(repr, names)) + "]\n"
    text += "Output = Literal['rgba', 'linear', 'depth', 'normal']\n\n__version__: str\n\n"
    for name in sfumato.__all__:
        thing = getattr(sfumato, name)
        if inspect.isclass(thing) and name not in ("Parameter", "Technique"):
            text += class_stub(name, thing, parameters) + "\n"
    text += "CameraLike = Union[Camera, str, 'os.PathLike[str]', Dict[str, Any], None]\n\n"
    for name in [*sfumato.__all__, "open"]:
        thing = getattr(sfumato, name)
        if inspect.isfunction(thing):
            text += function_stub(name, thing, parameters if name in ("render", "serve") else {}) + "\n"
    compile(text, "__init__.pyi", "exec")  # stubs that do not parse help nobody
    for name, content in (("__init__.pyi", text), ("py.typed", "")):
        with open(os.path.join(package, name), "w", encoding="utf-8") as file:
            file.write(content)


if __name__ == "__main__":
    main()
