"""openapi.json says what the server does: each path, each option of a picture, each answer."""
import json
import os
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.dirname(__file__))
from server import COMMAND, Server, check, failures, make_scan  # noqa: E402

TYPES = {"object": dict, "array": list, "string": str, "integer": int, "number": (int, float), "boolean": bool}
#: A value of each option of a picture that is none of the types' own.
VALUES = {"technique": "points", "resolution": "48x32", "draw": "z 0..: splats", "view": "top", "look-at": "0,0,0", "distance": "9",
          "camera-position": "5,5,5", "camera-focal-point": "0,0,0", "camera-view-up": "0,0,1", "camera-direction": "0,1,0",
          "camera-elevation-angle": "20", "camera-view-angle": "30", "crop": "-9,-9,-9,9,9,9", "crop-relative": "0,0,0,1,1,1",
          "show-classes": "66", "hide-classes": "7", "filter": "z -9..9", "max-points": "1000", "up": "+Z", "color-by": "elevation",
          "color": "red", "colormap": "viridis", "color-range": "0,1", "background-color": "white", "exposure": "1.5"}
#: What goes only with another.
BESIDE = {"colormap": {"color-by": "elevation"}, "color-range": {"color-by": "elevation"}, "legend": {"color-by": "elevation"}}


def faults(value, schema, where=""):
    """Where a value is not what a schema says, and what it holds that the schema does not name."""
    kind = schema.get("type")
    if not isinstance(value, TYPES[kind]) or isinstance(value, bool) != (kind == "boolean"):
        return [f"{where} is no {kind}"]
    found = []
    if kind == "object" and "properties" in schema:
        found += [f"{where}/{name} is missing" for name in schema.get("required", []) if name not in value]
        found += [f"{where}/{name} is not described" for name in value if name not in schema["properties"]]
        for name, inner in schema["properties"].items():
            if name in value:
                found += faults(value[name], inner, f"{where}/{name}")
    if kind == "array":
        for i, each in enumerate(value):
            found += faults(each, schema["items"], f"{where}/{i}")
    return found


def main():
    with tempfile.TemporaryDirectory() as folder, Server(make_scan(folder, 3000), "-t", "points", "--selections", "50", "--quiet") as server:
        server.wait_ready()
        api = json.loads(server.get("openapi.json")[2])
        error = api["components"]["responses"]["error"]["content"]["application/json"]["schema"]

        def answers(path, query=""):
            """Status and body, both as described."""
            status, headers, body = server.get(path.lstrip("/") + query)
            described = api["paths"][path]["get"]["responses"]
            good = str(status) in described
            answer = described.get(str(status), {})
            if "$ref" in answer:
                answer = {"content": {"application/json": {"schema": error}}}
            kind = headers["Content-Type"]
            good = good and kind in answer["content"]
            wrong = faults(json.loads(body), answer["content"][kind]["schema"]) if good and kind == "application/json" else []
            check(f"{path}{query}: {status} is described", good and not wrong, (status, kind, wrong, body[:200]))
            return status, headers, body

        check("/info is as described", answers("/info")[0] == 200)
        status, headers, body = answers("/render", "?resolution=48x32&technique=points")
        described = api["paths"]["/render"]["get"]["responses"]["200"]["headers"]
        check("/render is a picture with its headers", status == 200 and body.startswith(b"\x89PNG") and all(name in headers for name in described))
        check("wrong options are as described", answers("/render", "?nonsense=1")[0] == 400)
        for path in api["paths"]:
            status = server.get(path.lstrip("/"), token=False)[0]
            check(f"{path} without a token is as described", status == 403 and "403" in api["paths"][path]["get"]["responses"], status)
        check("what is not described is not there", server.get("nothing")[0] == 404)

        listed = {each["name"]: each["schema"] for each in api["paths"]["/render"]["get"]["parameters"]}
        for name, schema in listed.items():
            value = VALUES.get(name, "true" if schema["type"] == "boolean" else "1")
            query = {"resolution": "48x32", "technique": "points", **BESIDE.get(name, {}), name: value}
            status, _, body = answers("/render", "?" + "&".join(f"{key}={text}" for key, text in query.items()).replace(" ", "%20").replace("+", "%2B"))
            check(f"option {name} is taken", status == 200, (status, body[:200]))
        # No other option of the command is one here; parameters are.
        words = subprocess.run([COMMAND, "--help", "all"], capture_output=True, text=True).stdout
        fixed = words[:words.index("\nParameters of")]
        options = {word.strip(",")[2:] for word in fixed.split() if word.startswith("--") and len(word) > 3}
        taken = [name for name in sorted(options - set(listed)) if "is no option of a picture" not in server.get(f"render?{name}=")[2].decode()]
        check("options that are not described are refused", not taken and len(options) > 60, (taken, len(options)))
    if failures:
        sys.exit(f"{len(failures)} failed: {failures}")


main()
