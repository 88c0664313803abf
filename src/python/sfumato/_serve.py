"""A scan in a notebook or a browser, drawn by the command `sfumato serve`."""
import html
import os
import shutil
import signal
import subprocess
import tempfile
import weakref

from . import _cloud
from ._error import Error

#: By exit code of the command.
_CODES = {2: "bad_input", 4: "no_gl", 5: "out_of_memory", 6: "io", 70: "internal"}


def _command():
    found = os.environ.get("SFUMATO_COMMAND") or shutil.which("sfumato")
    if not found:
        raise Error("serve: there is no command `sfumato` on the PATH; install it, or name it in SFUMATO_COMMAND")
    return found


def _word(name, value):
    option = "--" + name.replace("_", "-")
    if value is True:
        return [option]
    if isinstance(value, (list, tuple)):
        # A rule each; of numbers one list.
        return [f"{option}={each}" for each in value] if name == "draw" else [f"{option}={','.join(map(str, value))}"]
    return [] if value is None or value is False else [f"{option}={value}"]


def _end(process, folder):
    if process.poll() is None:
        process.send_signal(signal.SIGTERM)
        try:
            process.wait(10)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
    process.stdout.close()
    shutil.rmtree(folder, ignore_errors=True)


class Server:
    """A running `sfumato serve`: what `serve` returns. A notebook shows its page; it ends with `stop`, at the end of a ``with``, when
    nobody refers to it any more, and with Python."""

    def __init__(self, words, folder, height):
        self._height = height
        with open(os.path.join(folder, "said"), "w+", encoding="utf-8", errors="replace") as said:
            self._process = subprocess.Popen([_command(), "serve", *words], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=said,
                                             text=True, start_new_session=True)
            self._address = self._process.stdout.readline().strip()
            if not self._address:
                code = self._process.wait()
                said.seek(0)
                text = (said.read().strip().splitlines() or [f"serve ended with code {code}"])[-1]
                _end(self._process, folder)
                raise Error(text.removeprefix("sfumato: "), _CODES.get(code, "usage"))
        self._end = weakref.finalize(self, _end, self._process, folder)

    @property
    def address(self):
        """Of the page, with the token that lets in."""
        return self._address

    @property
    def running(self):
        """Whether it answers."""
        return self._process.poll() is None

    def stop(self):
        """Ends the server; a second time nothing happens."""
        self._end()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.stop()

    def _repr_html_(self):
        if not self.running:
            return "<p>This server has ended.</p>"
        address = html.escape(self._address, quote=True)
        return (f'<iframe src="{address}" title="point cloud" width="100%" height="{self._height}" style="border: 0" '
                f'allow="clipboard-write; fullscreen"></iframe><p><a href="{address}" target="_blank" rel="noopener">in a tab</a></p>')

    def __repr__(self):
        return f"<Server {self._address if self.running else 'that has ended'}>"


def serve(points, technique="auto", port=0, height=600, **options):
    """Shows points in the browser, drawn here: all techniques, parameters, picking and measuring, as `sfumato serve`.

    >>> sfumato.serve("scan.laz", color_by="elevation")        # a notebook shows the page
    >>> with sfumato.serve(xyz) as server:
    ...     print(server.address)

    `points` is a file, a list of files, or anything that `Cloud` takes, which is then written to a temporary file; `port` 0 takes a free
    one; `height` is that of the frame in the notebook, in pixels. `options` are those of the command with underscores
    (``bind="0.0.0.0"``, ``point_size=2``, ``hide_classes=[7, 18]``). The notebook's browser must reach this machine: through ssh with
    ``-L PORT:127.0.0.1:PORT``. Needs the command `sfumato` on the PATH, or its name in the variable SFUMATO_COMMAND.

    Returns a `Server`. Raises `Error` with the command's line.
    """
    folder = tempfile.mkdtemp(prefix="sfumato-serve-")
    try:
        if isinstance(points, (str, os.PathLike)):
            files = [os.fspath(points)]
        elif isinstance(points, (list, tuple)) and points and all(isinstance(each, (str, os.PathLike)) for each in points):
            files = [os.fspath(each) for each in points]
        else:
            files = [os.path.join(folder, "points.ply")]
            _cloud.write(files[0], points)
        words = [f"--technique={technique}", f"--port={int(port)}"]
        for name, value in options.items():
            words += _word(name, value)
        return Server([*words, "--", *files], folder, int(height))
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        raise
