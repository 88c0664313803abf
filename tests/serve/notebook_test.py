"""sfumato.serve in a real notebook, in a real browser: the frame shows the scan, a hand turns it, and it ends with the notebook's word."""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.dirname(__file__))
import chromium  # noqa: E402
from server import COMMAND, check, failures, free_port, make_scan  # noqa: E402

JUPYTER = "/usr/bin/jupyter-notebook"
MODULE = os.path.join(os.environ.get("PYTHONPATH", ""), "sfumato", "__init__.py")
reason = chromium.missing() or ("" if os.path.exists(JUPYTER) else "there is no jupyter-notebook (scripts/install-deps --all)")
if not reason and not os.path.exists(MODULE):
    reason = "the Python package is not built"
if reason:
    print("SKIPPED: " + reason)
    sys.exit(0)


def write_notebook(file, *cells):
    json.dump({"nbformat": 4, "nbformat_minor": 4, "metadata": {"kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"}},
               "cells": [{"cell_type": "code", "metadata": {}, "execution_count": None, "outputs": [], "source": cell} for cell in cells]},
              open(file, "w"))


class Frame:
    """What the frame of an output holds, of another origin than the notebook."""

    def __init__(self, tab, address):
        self.tab = tab
        end = time.monotonic() + 60
        while True:
            frames = [each["frame"] for each in tab.call("Page.getFrameTree")["frameTree"].get("childFrames", [])]
            found = [each["id"] for each in frames if each["url"] == address]
            if found:
                break
            if time.monotonic() > end:
                raise AssertionError(f"no frame of {address}: {frames}")
            time.sleep(0.2)
        self.context = tab.call("Page.createIsolatedWorld", frameId=found[0])["executionContextId"]

    def run(self, script):
        result = self.tab.call("Runtime.evaluate", expression=script, contextId=self.context, returnByValue=True)
        if "exceptionDetails" in result:
            raise AssertionError(f"{script}: {result['exceptionDetails']}")
        return result["result"].get("value")

    def wait(self, script, seconds=120):
        end = time.monotonic() + seconds
        while not (value := self.run(script)):
            if time.monotonic() > end:
                raise AssertionError(f"it did not come true: {script}")
            time.sleep(0.1)
        return value


def main(folder):
    scan, port, token = make_scan(folder), free_port(), "secret"
    write_notebook(os.path.join(folder, "scan.ipynb"),
                   f"import sfumato\nserver = sfumato.serve({scan!r}, technique='points', height=420)\nserver",
                   "server.stop()\nserver")
    environment = {**os.environ, "PATH": "/usr/bin:/bin", "HOME": folder, "JUPYTER_ALLOW_INSECURE_WRITES": "true"}
    notebook = subprocess.Popen([JUPYTER, "--no-browser", "--allow-root", "--ip=127.0.0.1", f"--port={port}", f"--NotebookApp.token={token}",
                                 f"--notebook-dir={folder}"], env=environment, stdout=subprocess.DEVNULL,
                                stderr=open(os.path.join(folder, "log"), "w"))
    try:
        end = time.monotonic() + 90
        while "is running at" not in open(os.path.join(folder, "log")).read():
            if time.monotonic() > end or notebook.poll() is not None:
                raise AssertionError("the notebook does not start: " + open(os.path.join(folder, "log")).read())
            time.sleep(0.2)
        with chromium.Browser() as browser:
            tab = browser.open(f"http://127.0.0.1:{port}/notebooks/scan.ipynb?token={token}", 1100, 800)
            tab.wait("!!window.Jupyter?.notebook?.kernel?.is_connected()")
            tab.run("Jupyter.notebook.execute_cells([0])")
            address = tab.wait("document.querySelector('.output iframe')?.src")
            check("the output is a frame with the page's address", re.fullmatch(r"http://127\.0\.0\.1:\d+/[0-9a-f]{32}/", address), address)
            check("as high as was wished", tab.run("document.querySelector('.output iframe').clientHeight") == 420)
            frame = Frame(tab, address)
            picture = "document.getElementById('picture')"
            exact = f"{picture}?.dataset.exact === 'true'"
            pixels = f"""(() => {{ const c = {picture}, d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;
                let h = 0; for (let i = 0; i < d.length; ++i) h = (Math.imul(h, 31) + d[i]) | 0; return h; }})()"""
            frame.wait(exact)
            check("it begins with the scan, panels closed", frame.run(f"{picture}.clientWidth === document.documentElement.clientWidth"))
            first = frame.run(pixels)
            where = tab.run("(() => { const b = document.querySelector('.output iframe').getBoundingClientRect(); return [b.left, b.top]; })()")
            frame.run(f"{picture}.dataset.exact = 'waits'")
            tab.drag(where[0] + 200, where[1] + 200, 80, 10)
            frame.wait(exact)
            check("a drag in the frame turns the scan", frame.run(pixels) != first)
            if os.environ.get("SFUMATO_PAGE_PICTURES"):
                tab.screenshot(os.path.join(os.environ["SFUMATO_PAGE_PICTURES"], "notebook.png"))
            check("no complaint of the frame", not [each for each in tab.complaints if address in each], tab.complaints)
            tab.run("Jupyter.notebook.execute_cells([1])")
            check("a stopped server says so", tab.wait("[...document.querySelectorAll('.output')].some(each => each.textContent.includes('has ended'))"))
    finally:
        notebook.terminate()
        notebook.wait(30)


if __name__ == "__main__":
    place = tempfile.mkdtemp()
    try:
        main(place)
    finally:
        shutil.rmtree(place, ignore_errors=True)
    if failures:
        sys.exit(f"{len(failures)} failed: {failures}")
