"""EPT, Potree 2 and virtual point clouds through the command, on disk and by HTTP: written here by their descriptions alone."""
import functools
import http.server
import json
import os
import random
import shutil
import struct
import subprocess
import sys
import tempfile
import threading

sys.path.insert(0, os.path.join(os.path.dirname(__file__), "../serve"))
from server import COMMAND, check, failures  # noqa: E402


def command(*words):
    return subprocess.run([COMMAND, *words], capture_output=True, text=True, env={**os.environ, "no_proxy": "*"})


def rows_of(source, folder, *words):
    """x y z red green blue intensity classification gps_time, sorted."""
    name = os.path.join(folder, "rows.xyz")
    done = command("convert", source, "-o", name, *words)
    if done.returncode != 0:
        return done.stderr
    with open(name) as file:
        names = file.readline().split()[1:]
        rows = [dict(zip(names, map(float, line.split()))) for line in file]
    os.remove(name)
    return sorted(tuple(round(row[key], 3) for key in ("x", "y", "z", "red", "intensity", "classification", "gps_time")) for row in rows)


def agree(found, truth):
    """Times of a scalar are floats around an offset."""
    return not isinstance(found, str) and len(found) == len(truth) and all(
        abs(a - b) <= (.02 if k == 6 else .0011) for one, other in zip(found, truth) for k, (a, b) in enumerate(zip(one, other)))


class Point:
    def __init__(self, rng):
        self.steps = [rng.randrange(0, 100000) for _ in range(3)]
        self.intensity, self.kind, self.time = rng.randrange(0, 65536), rng.randrange(1, 6), round(rng.random() * 1e5, 3)
        self.rgb = [257 * rng.randrange(0, 256) for _ in range(3)]

    def row(self):
        place = [s * k + o for s, k, o in zip(self.steps, SCALE, OFFSET)]
        return tuple(round(v, 3) for v in (*place, self.rgb[0] / 257, self.intensity, self.kind, self.time))


SCALE, OFFSET, SIZE = [.001, .001, .002], [500000.0, 4100000.0, 100.0], 200


def write_ept(folder, nodes, kind):
    os.makedirs(os.path.join(folder, "ept-data")), os.makedirs(os.path.join(folder, "ept-hierarchy"))
    schema = [{"name": name, "type": "signed", "size": 4, "scale": k, "offset": o} for name, k, o in zip("XYZ", SCALE, OFFSET)]
    schema += [{"name": "Intensity", "type": "unsigned", "size": 2}, {"name": "Classification", "type": "unsigned", "size": 1}]
    schema += [{"name": name, "type": "unsigned", "size": 2} for name in ("Red", "Green", "Blue")] + [{"name": "GpsTime", "type": "float", "size": 8}]
    for key, points in nodes.items():
        data = b"".join(struct.pack("<3iHB3Hd", *p.steps, p.intensity, p.kind, *p.rgb, p.time) for p in points)
        file = os.path.join(folder, "ept-data", key + (".zst" if kind == "zstandard" else ".bin"))
        if kind == "zstandard":
            data = subprocess.run(["zstd", "-c"], input=data, capture_output=True, check=True).stdout
        with open(file, "wb") as tile:
            tile.write(data)
    # The last node stands on a page of its own.
    *first, last = nodes
    for page, keys in (("0-0-0-0", first), (last, [last])):
        counts = {key: len(nodes[key]) for key in keys}
        if page != last:
            counts[last] = -1
        with open(os.path.join(folder, "ept-hierarchy", page + ".json"), "w") as file:
            json.dump(counts, file)
    with open(os.path.join(folder, "ept.json"), "w") as file:
        json.dump({"version": "1.0.0", "dataType": kind, "hierarchyType": "json", "points": sum(map(len, nodes.values())), "span": 128,
                   "bounds": [*OFFSET, *(o + SIZE for o in OFFSET)], "boundsConforming": [*OFFSET, *(o + SIZE for o in OFFSET)], "srs": {"wkt": 'LOCAL_CS["somewhere"]'}, "schema": schema}, file)


def write_las(file, points, scale=.001):
    """LAS 1.2 of point format 3."""
    header = struct.pack("<4sHHIHH8sBB32s32sHHHIIBHI5I", b"LASF", 0, 0, 0, 0, 0, b"", 1, 2, b"", b"", 1, 2026, 227, 227, 0, 3, 34, len(points), len(points),
                         0, 0, 0, 0)
    header += struct.pack("<12d", scale, .001, .002, *OFFSET, OFFSET[0] + 100, OFFSET[0], OFFSET[1] + 100, OFFSET[1], OFFSET[2] + 200, OFFSET[2])
    with open(file, "wb") as las:
        las.write(header)
        for p in points:
            las.write(struct.pack("<3iHBBbBHd3H", *p.steps, p.intensity, 9, p.kind, 0, 0, 1, p.time, *p.rgb))


def write_potree(folder, nodes, encoding, hierarchy=None):
    os.makedirs(folder)
    octree, places = b"", {}
    spread = lambda values: sum((value >> bit & 1) << 3 * bit + k for k, value in enumerate(values) for bit in range(16))  # noqa: E731
    for name, points in nodes.items():
        if encoding == "DEFAULT":
            body = b"".join(struct.pack("<3iHB3Hd", *p.steps, p.intensity, p.kind, *p.rgb, p.time) for p in points)
        else:
            import brotli
            body = b"".join(struct.pack("<QQ", spread([s >> 16 for s in p.steps]), spread([s & 65535 for s in p.steps])) for p in points)
            body += b"".join(struct.pack("<H", p.intensity) for p in points) + b"".join(struct.pack("<B", p.kind) for p in points)
            body += b"".join(struct.pack("<Q", spread(p.rgb)) for p in points) + b"".join(struct.pack("<d", p.time) for p in points)
            body = brotli.compress(body)
        places[name] = (len(points), len(octree), len(body))
        octree += body
    row = lambda kind, children, name: struct.pack("<BBIQQ", kind, children, *places[name])  # noqa: E731
    pages = hierarchy(places) if hierarchy else row(0, 0b10000001, "r") + struct.pack("<BBIQQ", 2, 0, places["r0"][0], 66, 44) + row(1, 0, "r7") + row(0, 0b10, "r0") + row(1, 0, "r01")
    attributes = [("position", 3, "int32", 4), ("intensity", 1, "uint16", 2), ("classification", 1, "uint8", 1), ("rgb", 3, "uint16", 2),
                  ("gps-time", 1, "double", 8)]
    for name, data in (("octree.bin", octree), ("hierarchy.bin", pages)):
        with open(os.path.join(folder, name), "wb") as file:
            file.write(data)
    with open(os.path.join(folder, "metadata.json"), "w") as file:
        json.dump({"version": "2.0", "name": "scan", "points": sum(map(len, nodes.values())), "projection": "", "encoding": encoding,
                   "hierarchy": {"firstChunkSize": len(pages) if hierarchy else 66, "stepSize": 1, "depth": 2}, "offset": OFFSET, "scale": SCALE, "spacing": SIZE / 128,
                   "boundingBox": {"min": OFFSET, "max": [o + SIZE for o in OFFSET]},
                   "attributes": [{"name": n, "numElements": k, "elementSize": s, "size": k * s, "type": t} for n, k, t, s in attributes]}, file)


def plane(rng, deepest):
    """Nodes of EPT and of Potree of a plane, four times as many in each level, and each node of as many points."""
    ept, potree = {}, {}
    for level in range(deepest + 1):
        for x in range(1 << level):
            for y in range(1 << level):
                points = [Point(rng) for _ in range(100)]
                edge = SIZE / (1 << level)
                for p in points:
                    p.steps = [int((k + rng.random()) * edge / s) for k, s in zip((x, y), SCALE)] + [0]
                ept[f"{level}-{x}-{y}-0"] = points
                digits = (4 * (x >> bit & 1) + 2 * (y >> bit & 1) for bit in reversed(range(level)))
                potree["r" + "".join(map(str, digits))] = points
    return ept, potree


def write_potree_in_one_page(folder, nodes):
    order = sorted(nodes, key=lambda name: (len(name), name))
    write_potree(folder, {name: nodes[name] for name in order}, "DEFAULT", lambda places: b"".join(
        struct.pack("<BBIQQ", 0, sum(1 << k for k in range(8) if f"{name}{k}" in nodes), *places[name]) for name in order))


def serve(folder, asked=None):
    class Quiet(http.server.SimpleHTTPRequestHandler):
        def log_message(self, *_):
            pass

        def do_GET(self):
            if asked is not None:
                asked.append(self.path)
            super().do_GET()
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Quiet, directory=folder))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    return f"http://127.0.0.1:{server.server_port}/"


def has_brotli():
    try:
        import brotli  # noqa: F401
    except ImportError:
        return False
    return True


def main():
    rng = random.Random(7)
    clouds = [[Point(rng) for _ in range(count)] for count in (60, 80, 50, 70)]
    truth = sorted(point.row() for cloud in clouds for point in cloud)
    with tempfile.TemporaryDirectory() as folder:
        at = lambda name: os.path.join(folder, name)  # noqa: E731
        url = serve(folder)
        nodes = dict(zip(("0-0-0-0", "1-0-0-0", "1-1-1-1", "2-3-3-3"), clouds))
        write_ept(at("binary"), nodes, "binary")
        kinds = ["binary/ept.json"]
        if shutil.which("zstd"):
            write_ept(at("zstandard"), nodes, "zstandard")
            kinds.append("zstandard/ept.json")
        write_ept(at("laszip"), nodes, "laszip")
        for key, points in nodes.items():
            write_las(at("tile.las"), points)
            done = command("convert", at("tile.las"), "-o", at(f"laszip/ept-data/{key}.laz"))
            check("tile " + key, done.returncode == 0, done)
            os.remove(at(f"laszip/ept-data/{key}.bin"))
        kinds.append("laszip/ept.json")
        octree = dict(zip(("r", "r0", "r7", "r01"), clouds))
        write_potree(at("potree"), octree, "DEFAULT")
        kinds.append("potree/metadata.json")
        if has_brotli():
            write_potree(at("brotli"), octree, "BROTLI")
            kinds.append("brotli/metadata.json")
        for kind in kinds:
            for what, source in (("the file", at(kind)), ("its folder", at(os.path.dirname(kind))), ("by HTTP", url + kind + "?token=1")):
                found = rows_of(source, folder)
                check(f"{kind}, {what}", agree(found, truth), found[:300] if isinstance(found, str) else found[:2])
            coarse = rows_of(at(kind), folder, "--max-points", "60")
            check(f"{kind}, coarse", agree(coarse, sorted(p.row() for p in clouds[0])), coarse[:2])
        # By view.
        ept, potree = plane(rng, 5)
        write_ept(at("wide"), ept, "binary")
        write_potree_in_one_page(at("deep"), potree)
        asked = []
        watched = serve(folder, asked)
        points = sum(map(len, ept.values()))
        for what, source, words in (("ept", at("wide"), ["--memory", "5M"]), ("potree", at("deep"), ["--memory", "5M"]),
                                    ("ept by HTTP", watched + "wide/ept.json", ["--memory", "2M"])):
            read = {}
            for view, more in (("whole", []), ("near", ["--zoom", "30"])):
                done = command(source, "-o", at("view.png"), "--view", "top", "-t", "points", "--resolution", "64x48", "--json", "--quiet", *words, *more)
                read[view] = json.loads(done.stdout)["levels"] if done.returncode == 0 else done.stderr
            check(f"{what}: a view reads what it shows", all(
                isinstance(one, dict) and one["points_in_files"] == points and one["points_read"] == one["points_needed"] < points / 4
                for one in read.values()), read)
        tiles = {path for path in asked if "ept-data" in path}
        check("of the server, few tiles", 1 <= len(tiles) < len(ept) / 4, len(tiles))
        for what, source in (("ept", at("wide")), ("potree", at("deep"))):
            done = command("info", source, "--json")
            levels = json.loads(done.stdout)["levels"]
            check(f"{what}: levels", [level["nodes"] for level in levels] == [4 ** k for k in range(6)] and levels[0]["points"] == 100
                  and abs(levels[5]["spacing"] - SIZE / 128 / 32) < 1e-9, levels)

        done = command("info", at("binary"))
        check("the coordinate system", 'LOCAL_CS["somewhere"]' in done.stdout, done.stdout)

        # Lists.
        command("convert", at("binary"), "-o", at("a.laz")), command("convert", at("potree"), "-o", at("b.laz"))
        item = lambda href: {"type": "Feature", "assets": {"data": {"href": href}, "thumbnail": {"href": "x.png"}}}  # noqa: E731
        with open(at("list.vpc"), "w") as file:
            json.dump({"type": "FeatureCollection", "features": [item("./a.laz"), item(url + "b.laz")]}, file)
        for what, source in (("a list", at("list.vpc")), ("a list by HTTP", url + "list.vpc")):
            found = rows_of(source, folder)
            check(what, agree(found, sorted(truth + truth)), found[:300] if isinstance(found, str) else len(found))

        # Damage: one line each.
        def damaged(what, source, name, change, said):
            shutil.copytree(at(source), at("damaged"))
            change(at("damaged/" + name))
            done = command("info", "--stats", at("damaged"))
            check(f"{what}: one line", done.returncode in (2, 5, 6) and said in done.stderr and done.stderr.count("\n") == 1, done)
            shutil.rmtree(at("damaged"))

        def cut(file):
            os.truncate(file, os.path.getsize(file) - 5)

        def put(data):
            return lambda file: open(file, "wb").write(data)

        damaged("a tile cut short", "binary", "ept-data/1-0-0-0.bin", cut, "1-0-0-0")
        damaged("a tile missing", "binary", "ept-data/1-0-0-0.bin", os.remove, "1-0-0-0.bin")
        damaged("a page missing", "binary", "ept-hierarchy/0-0-0-0.json", os.remove, "0-0-0-0.json")
        damaged("counts beyond belief", "binary", "ept-hierarchy/0-0-0-0.json", put(b'{"0-0-0-0": 4000000000000000}'), "")
        damaged("a page that is no JSON", "binary", "ept-hierarchy/0-0-0-0.json", put(b"<html>"), "counts of points")
        def rescale(file):
            write_las(at("tile.las"), clouds[1], .002)
            command("convert", at("tile.las"), "-o", file)

        damaged("LAZ tiles of two scales", "laszip", "ept-data/1-0-0-0.laz", rescale, "not that of the first")
        damaged("a LAZ tile cut short", "laszip", "ept-data/1-0-0-0.laz", lambda file: os.truncate(file, 400), "1-0-0-0.laz")
        damaged("a node cut off", "potree", "octree.bin", cut, "octree.bin")
        damaged("a page that leads to itself", "potree", "hierarchy.bin", put(struct.pack("<BBIQQ", 2, 0, 1, 0, 66) * 3), "")
        damaged("a hierarchy cut short", "potree", "hierarchy.bin", lambda file: os.truncate(file, 30), "hierarchy.bin")
        if os.path.exists(at("zstandard")):
            damaged("a damaged stream", "zstandard", "ept-data/0-0-0-0.zst", put(b"(\xb5/\xfd" + b"\1" * 90), "zstandard")
        if os.path.exists(at("brotli")):
            damaged("a damaged brotli stream", "brotli", "octree.bin", lambda file: put(b"\1" * os.path.getsize(file))(file), "brotli")
    print(f"{len(failures)} failures")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
