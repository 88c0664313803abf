"""The one exception of sfumato."""


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
