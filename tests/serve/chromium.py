"""Chromium without a display, driven by its DevTools protocol."""
import base64
import json
import os
import shutil
import subprocess
import tempfile
import time
import urllib.request

try:
    import websocket
except ImportError:
    websocket = None


def missing():
    """Why there is no browser to test with; empty: there is."""
    if not shutil.which("chromium"):
        return "there is no chromium (scripts/install-deps --all)"
    return "" if websocket else "there is no python3-websocket (scripts/install-deps --all)"


class Browser:
    def __init__(self):
        self.folder = tempfile.mkdtemp()
        words = ["chromium", "--headless=new", "--disable-gpu", "--remote-debugging-port=0", "--no-first-run",
                 "--remote-allow-origins=*", f"--user-data-dir={self.folder}", "--disable-background-networking",
                 "--disable-dev-shm-usage", "--enable-unsafe-swiftshader", "--hide-scrollbars"]
        if os.getuid() == 0:
            words.append("--no-sandbox")  # which it refuses to have as root
        self.process = subprocess.Popen([*words, "about:blank"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        end = time.monotonic() + 90
        port_file = os.path.join(self.folder, "DevToolsActivePort")
        while not os.path.exists(port_file) or not open(port_file).read().strip():
            if time.monotonic() > end or self.process.poll() is not None:
                raise AssertionError("chromium does not start")
            time.sleep(0.1)
        self.port = int(open(port_file).read().split()[0])

    def open(self, address, width=1280, height=800, scale=1, touch=False):
        request = urllib.request.Request(f"http://127.0.0.1:{self.port}/json/new?about:blank", method="PUT")
        with urllib.request.urlopen(request, timeout=60) as answer:
            tab = Tab(json.load(answer)["webSocketDebuggerUrl"])
        tab.call("Page.enable"), tab.call("Runtime.enable"), tab.call("Log.enable")
        tab.resize(width, height, scale, touch)
        tab.call("Page.navigate", url=address)
        return tab

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        try:
            self.process.wait(20)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        shutil.rmtree(self.folder, ignore_errors=True)


class Tab:
    def __init__(self, address):
        self.line = websocket.create_connection(address, timeout=120, max_size=None)
        self.number, self.complaints = 0, []

    def call(self, method, **params):
        self.number += 1
        self.line.send(json.dumps({"id": self.number, "method": method, "params": params}))
        while True:
            said = json.loads(self.line.recv())
            if said.get("method") == "Runtime.exceptionThrown":
                details = said["params"]["exceptionDetails"]
                self.complaints.append(details.get("exception", {}).get("description", details["text"]))
            elif said.get("method") == "Log.entryAdded" and said["params"]["entry"]["level"] == "error":
                self.complaints.append(said["params"]["entry"]["text"])
            if said.get("id") == self.number:
                if "error" in said:
                    raise AssertionError(f"{method}: {said['error']}")
                return said["result"]

    def run(self, script):
        result = self.call("Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in result:
            raise AssertionError(f"{script}: {result['exceptionDetails']}")
        return result["result"].get("value")

    def wait(self, script, seconds=120):
        end = time.monotonic() + seconds
        while True:
            try:
                value = self.run(script)
            except AssertionError as error:
                if "navigated or closed" not in str(error):
                    raise
                value = None  # the page before, which a reload takes away while it answers
            if value:
                return value
            if time.monotonic() > end:
                raise AssertionError(f"it did not come true: {script}; {self.complaints}")
            time.sleep(0.1)

    def resize(self, width, height, scale=1, touch=False):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=scale, mobile=touch)
        self.call("Emulation.setTouchEmulationEnabled", enabled=touch)

    def mouse(self, kind, x, y, buttons=1, modifiers=0, clicks=1):
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left" if kind != "mouseMoved" or buttons else "none",
                  buttons=buttons, clickCount=clicks, modifiers=modifiers)

    def drag(self, x, y, dx, dy, steps=5, modifiers=0):
        self.mouse("mousePressed", x, y, 1, modifiers)
        for i in range(1, steps + 1):
            self.mouse("mouseMoved", x + dx * i / steps, y + dy * i / steps, 1, modifiers)
        self.mouse("mouseReleased", x + dx, y + dy, 0, modifiers)

    def click(self, x, y, modifiers=0):
        self.mouse("mousePressed", x, y, 1, modifiers)
        self.mouse("mouseReleased", x, y, 0, modifiers)

    def wheel(self, x, y, steps):
        self.call("Input.dispatchMouseEvent", type="mouseWheel", x=x, y=y, deltaX=0, deltaY=-100 * steps)

    def touch(self, kind, points):
        self.call("Input.dispatchTouchEvent", type=kind, touchPoints=[{"x": x, "y": y} for x, y in points])

    def close(self):
        self.line.send(json.dumps({"id": 0, "method": "Page.close"}))
        self.line.close()

    def screenshot(self, file):
        data = base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"])
        with open(file, "wb") as out:
            out.write(data)
