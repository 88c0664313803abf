"""Whatever a hand does in a window, the picture that it keeps is that of the command which it is given, byte for byte."""
import json
import os
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.dirname(__file__))
from server import COMMAND, check, failures, make_scan  # noqa: E402

LINES = os.environ["SFUMATO_LINES"]

#: What is done one after the other; a picture is taken after each.
STEPS = [
    ("the first view", []),
    ("technique and parameters", [{"do": "technique", "name": "surface"}, {"do": "set", "name": "disc_scale", "value": "1.5"}]),
    ("shadows and light", [{"do": "technique", "name": "points"}, {"do": "set", "name": "shadows", "value": "hard"},
                           {"do": "grab", "kind": "light", "x": 160, "y": 100}, {"do": "drag", "dx": 40, "dy": 10}]),
    ("turned, moved and nearer", [{"do": "grab", "kind": "rotate", "x": 160, "y": 100}, {"do": "drag", "dx": 60, "dy": 20},
                                  {"do": "grab", "kind": "pan", "x": 160, "y": 100}, {"do": "drag", "dx": -20, "dy": 5},
                                  {"do": "zoom", "x": 160, "y": 100, "steps": 2}]),
    ("colours", [{"do": "color", "name": "color_by", "value": "elevation"}, {"do": "color", "name": "colormap", "value": "turbo"},
                 {"do": "color", "name": "color_range", "value": "0.25,1.5"}]),
    ("in the picture", [{"do": "legend", "on": True}, {"do": "option", "name": "title", "value": "Site 4"}]),
    ("a box", [{"do": "clip", "box": [-0.5, -1, 0, 1, 1, 1]}]),
    ("items", [{"do": "draw", "rows": [{"rule": "z 0.4..: splats"}, {"rule": "x ..-0.2: points", "visible": False}]}]),
    ("one colour over white", [{"do": "color", "name": "point_color", "value": "steelblue"},
                               {"do": "color", "name": "background_color", "value": "white"}]),
    ("from above", [{"do": "view", "name": "top"}]),
    ("undone", [{"do": "undo"}]),
]


class Front:
    def __init__(self, folder, *words):
        self.folder = folder
        self.process = subprocess.Popen([LINES, *words], cwd=folder, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def do(self, **message):
        self.process.stdin.write(json.dumps(message) + "\n")
        self.process.stdin.flush()
        answer = json.loads(self.process.stdout.readline())
        if "errors" in answer:
            failures.append(f"{message}: {answer['errors']}")
        return answer

    def keep(self, name):
        """The bytes of a picture, and those that its command writes."""
        command = self.do(do="shoot", width=160, height=100, file=name)["command"]
        other = os.path.join(self.folder, "command")
        os.makedirs(other, exist_ok=True)
        done = subprocess.run([COMMAND, *command[1:-2], "--quiet", "-o", os.path.join(other, name)], cwd=self.folder,
                              capture_output=True, text=True)
        if done.returncode:
            failures.append(f"{command}: {done.stderr}")
            return b"picture", b"none"
        return pixels(os.path.join(self.folder, name)), pixels(os.path.join(other, name))


def pixels(file):
    """The parts of a PNG that are its picture: what was asked for is said otherwise."""
    with open(file, "rb") as opened:
        data, at, kept = opened.read(), 8, b""
    while at < len(data):
        length = int.from_bytes(data[at:at + 4], "big")
        if data[at + 4:at + 8] in (b"IHDR", b"IDAT"):
            kept += data[at + 4:at + 8 + length]
        at += length + 12
    return kept


with tempfile.TemporaryDirectory() as folder:
    make_scan(folder)
    front, seen = Front(folder, "scan.ply", "-t", "points"), {}
    for number, (what, messages) in enumerate(STEPS):
        for message in messages:
            front.do(**message)
        kept, made = front.keep(f"{number}.png")
        check(what + ": the command makes the same", kept == made)
        check(what + ": it is another picture", kept not in seen.values() or what == "undone")
        seen[what] = kept
    check("undone is what was before", seen["undone"] == seen["one colour over white"])
    front.do(do="save", file="look.json")
    front.do(do="save", file="all.json", with_files=True)
    front.do(do="technique", name="strokes")
    front.do(do="clip", box=None)
    front.do(do="preset", file="all.json")
    check("a scene brings everything back", front.keep("back.png")[0] == seen["undone"])
    front.process.stdin.close()
    front.process.wait(30)
    other = Front(folder, "--scene", "all.json")
    other.do(do="size", width=320, height=200)
    check("also to another window", other.keep("again.png")[0] == seen["undone"])
    other.process.stdin.close()
    other.process.wait(30)

sys.exit(f"{len(failures)} failed: {failures}" if failures else 0)
