"""What techniques there are, and their parameters."""
from typing import Any, NamedTuple, Optional, Tuple

from . import _engine


class Parameter(NamedTuple):
    """One parameter, as ``render`` takes it by name."""

    name: str
    kind: str  #: "bool", "int", "float", "choice", "string", "float_list" or "vec3"
    default: Any
    choices: Tuple[str, ...]  #: of kind "choice"
    range: Optional[Tuple[Optional[float], Optional[float]]]  #: inclusive; None is no bound
    auto: bool  #: "auto" (or None) finds its own value
    unit: str
    help: str
    paper: str  #: the symbol in the technique's paper

    def __str__(self):
        values = "|".join(self.choices) if self.choices else self.kind
        if self.range:
            values += " [" + "..".join("" if end is None else f"{end:g}" for end in self.range) + "]"
        if self.auto:
            values += "|auto"
        unit = f" ({self.unit})" if self.unit else ""
        return f"{self.name}: {values} = {self.default}\n    {self.help}{unit}"


class Technique(NamedTuple):
    """A technique; ``print`` shows every parameter."""

    name: str
    summary: str
    needs: Tuple[str, ...]  #: computed from neighbours where the points lack it: "normal", "radius" ...
    parameters: Tuple[Parameter, ...]  #: its own
    shared_parameters: Tuple[Parameter, ...]  #: those of every technique

    def __str__(self):
        rows = [f"{self.name}: {self.summary}", "", "Parameters"] + [str(p) for p in self.parameters]
        return "\n".join(rows + ["", "Parameters of every technique"] + [str(p) for p in self.shared_parameters])


def _technique(row):
    own, shared = (tuple(Parameter(**p) for p in row[key]) for key in ("parameters", "shared_parameters"))
    return Technique(row["name"], row["summary"], tuple(row["needs"]), own, shared)


def techniques(name=None):
    """The techniques as a list of `Technique`, or the one of that name.

    >>> print(sfumato.techniques("points"))        # every parameter, its range and what it does

    Raises `Error` ("usage") that names the nearest technique.
    """
    if name is not None:
        name = _engine.find_technique(name)
    found = [_technique(row) for row in _engine.techniques() if name is None or row["name"] == name]
    return found if name is None else found[0]


def analysis_parameters():
    """Parameters of what is measured before rendering, as a list of `Parameter`: `render` and `Renderer` take them."""
    return [Parameter(**row) for row in _engine.analysis_parameters()]


def text_of(name, value):
    """A value as the command line spells it."""
    from ._error import Error

    if value is None:
        return "auto"
    if hasattr(value, "item") and getattr(value, "ndim", 0) == 0:  # a number of numpy
        value = value.item()
    if isinstance(value, str):
        return value
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return repr(value)
    if hasattr(value, "__float__") and not hasattr(value, "__iter__"):  # a fraction, or a number that is longer in numpy
        return repr(float(value))
    try:
        return ",".join(text_of(name, each) for each in value)
    except TypeError:
        raise Error(f"parameter '{name}': a {type(value).__name__} is no value; give a number, a text or a list of numbers") from None


_known = None


def is_parameter(name):
    """Whether a technique or the analysis has it, with underscores or dashes, maybe qualified by a technique."""
    global _known
    if _known is None:
        _known = {p["name"] for row in _engine.techniques() for key in ("parameters", "shared_parameters") for p in row[key]}
        _known |= {p["name"] for p in _engine.analysis_parameters()}
    return name.rpartition(".")[2].replace("-", "_") in _known


def settings_of(parameters, keywords=()):
    """Names and values as texts. Raises `Error` for a name that neither a technique nor a keyword has."""
    from ._error import Error

    for name in parameters:
        plain = name.rpartition(".")[2].replace("-", "_")
        if not is_parameter(name):
            near = _engine.nearest_word(plain, sorted(_known) + list(keywords))
            raise Error(f"no technique has a parameter '{name}'" + (f"; did you mean '{near}'?" if near else "; sfumato.techniques() lists them"))
    return [(name, text_of(name, value)) for name, value in parameters.items()]
