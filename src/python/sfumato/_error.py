"""The one exception of sfumato, and its one warning."""


class Error(Exception):
    """What went wrong, in one line: what, where, what to do next. The text is that of the command.

    ``code`` is one of

    - ``"usage"``: a name or a value that does not exist, or things that do not go together
    - ``"bad_input"``: a file or an array is damaged, empty or not what it claims to be
    - ``"no_gl"``: no usable OpenGL 4.5 driver (software will do)
    - ``"out_of_memory"``: main or graphics memory
    - ``"io"``: reading or writing failed
    - ``"internal"``: a fault of sfumato; please report it

    Ctrl-C raises ``KeyboardInterrupt``, and what a ``progress`` callback raises comes out as it is.
    """

    def __init__(self, message, code="usage"):
        super().__init__(message)
        self.code = code

    def __reduce__(self):
        return type(self), (str(self), self.code)


class PartialWarning(UserWarning):
    """Parts of a file are damaged and left out; ``strict=True`` refuses such files. ``cloud.notes`` has every part."""


def warn_of_damage(engine):
    """Warns, on behalf of the code outside the package that asked, when parts of what was read are missing."""
    if engine is None or not engine.damage:
        return
    import sys
    import warnings

    frame, level = sys._getframe(1), 2
    while frame.f_back is not None and frame.f_globals.get("__name__", "").partition(".")[0] == "sfumato":
        frame, level = frame.f_back, level + 1
    more = f" (and {len(engine.damage) - 1} more)" if len(engine.damage) > 1 else ""
    warnings.warn(f"{engine.points_missing} of {engine.points_read} points are missing: they lie in damaged parts (strict=True refuses "
                  f"such files); {engine.damage[0]}{more}", PartialWarning, stacklevel=level)
