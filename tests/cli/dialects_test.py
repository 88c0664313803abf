"""Files as strangers send them, in other dialects than those of the unit tests, and joins of files whose colours have 8, 12, 16 bits
or are absent: what the command makes of them. Prints a table."""
import csv
import json
import math
import os
import random
import struct
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(__file__), "../serve"))
from server import COMMAND, check, failures  # noqa: E402

folder = tempfile.TemporaryDirectory()


def at(name):
    return os.path.join(folder.name, name)


def run(*words):
    return subprocess.run([COMMAND, *words], capture_output=True, text=True, cwd=folder.name)


def info(*files):
    done = run("info", "--json", "--stats", *files)
    if done.returncode not in (0, 3):
        return {"error": done.stderr, "attributes": {}}
    found = json.loads(done.stdout)
    found["said"] = done.stderr
    return found


def attribute(found, name):
    return found["attributes"].get(name)


def is_box(found, low, high, slack=0.6):
    if "bounds_min" not in found:
        return False
    pairs = zip(found["bounds_min"] + found["bounds_max"], list(low) + list(high))
    return all(abs(a - b) <= slack for a, b in pairs)


def table(*files, more=()):
    """Rows of `convert` as dicts of numbers."""
    done = run("convert", *files, "-o", "table.csv", *more)
    assert done.returncode == 0, done.stderr
    with open(at("table.csv"), newline="") as text:
        return [{name.lower().lstrip("/# "): float(value) for name, value in row.items()} for row in csv.DictReader(text)]


# A hill 20 x 12 and 6 high; a colour each stripe.
random.seed(11)
STRIPES = [(210, 40, 40), (40, 160, 50), (40, 70, 220), (150, 120, 80)]
HILL = []
for n in range(900):
    u, v = random.random(), random.random()
    HILL.append((20 * u, 12 * v, 6 * math.sin(3 * u) * math.sin(3 * v), STRIPES[int(4 * u)]))
LOW = [min(p[k] for p in HILL) for k in range(3)]
HIGH = [max(p[k] for p in HILL) for k in range(3)]
EAST, NORTH, UP = 389120, 5819300, 34


def moved(low, high):
    return [low[0] + EAST, low[1] + NORTH, low[2] + UP], [high[0] + EAST, high[1] + NORTH, high[2] + UP]


def text(name, lines, head=""):
    with open(at(name), "w") as file:
        file.write(head + "\n".join(lines) + "\n")
    return name


def las(name, points, colors=None, bits=16, extra=None, format=7):
    """LAS 1.4, written here; `extra`: (name, type, bytes of no_data, packed values)."""
    vlrs = b""
    if extra:
        title, kind, no_data, values = extra
        record = struct.pack("<2sBB32s4s", b"", kind, 1, title.encode(), b"") + no_data.ljust(8, b"\0") + b"\0" * 16 + b"\0" * 24 * 3
        record = record.ljust(192, b"\0")
        vlrs = struct.pack("<H16sHH32s", 0, b"LASF_Spec", 4, 192, b"") + record
    size = {6: 30, 7: 36}[format] + (len(extra[3][0]) if extra else 0)
    xs, ys, zs = zip(*[(p[0], p[1], p[2]) for p in points])
    low, high = (min(xs), min(ys), min(zs)), (max(xs), max(ys), max(zs))
    head = b"LASF" + struct.pack("<HH16sBB32s32sHHHIIBHI5I", 0, 16, b"", 1, 4, b"by hand", b"dialects", 1, 2026, 375, 375 + len(vlrs), 1 if extra else 0,
                                 format, size, 0, 0, 0, 0, 0, 0)
    head += struct.pack("<12d", .001, .001, .001, EAST, NORTH, 0, high[0], low[0], high[1], low[1], high[2], low[2])
    head += struct.pack("<QQIQ15Q", 0, 0, 0, len(points), len(points), *[0] * 14)
    assert len(head) == 375
    with open(at(name), "wb") as file:
        file.write(head + vlrs)
        for i, p in enumerate(points):
            file.write(struct.pack("<iiiHBBBBhHd", *[round((v - o) * 1000) for v, o in zip(p, (EAST, NORTH, 0))], 100 + i, 0x11, 0, 2, 0, 0, 0, float(i)))
            if format == 7:
                file.write(struct.pack("<HHH", *(colors[i] if colors else (0, 0, 0))))
            if extra:
                file.write(extra[3][i])
    return name


def ply(name, points, colors=None, kind="float"):
    head = f"ply\nformat ascii 1.0\nelement vertex {len(points)}\n" + "".join(f"property {kind} {axis}\n" for axis in "xyz")
    if colors:
        head += "".join(f"property uchar {c}\n" for c in ("red", "green", "blue"))
    rows = [" ".join(map(repr, p[:3])) + (" %d %d %d" % colors[i] if colors else "") for i, p in enumerate(points)]
    return text(name, rows, head + "end_header\n")


def ptx(name, scans):
    lines = []
    for points, colors in scans:
        lines += [str(len(points)), "1", "0 0 0", "1 0 0", "0 1 0", "0 0 1", "1 0 0 0", "0 1 0 0", "0 0 1 0", "0 0 0 1"]
        lines += ["%.4f %.4f %.4f 0.5" % tuple(p[:3]) + (" %d %d %d" % colors[i] if colors else "") for i, p in enumerate(points)]
    return text(name, lines)


def dialects():
    rgb = [p[3] for p in HILL]
    utm = [(p[0] + EAST, p[1] + NORTH, p[2] + UP) for p in HILL]

    found = info(text("ids.txt", ["%d;%.3f;%.3f;%.3f;%d;%d;%d" % (7 * i, *p[:3], *p[3]) for i, p in enumerate(HILL)],
                      "# POINT_ID; X; Y; Z; R; G; B\n"))
    check("1 semicolons, a comment names the columns, the id is none", is_box(found, LOW, HIGH) and attribute(found, "R")["max"] == 210, found)
    found = info(text("swapped.asc", ["%.3f %.3f %.3f" % (p[1], p[0], p[2]) for p in utm], "//Northing Easting Elevation\n"))
    check("2 // and northing first", is_box(found, *moved(LOW, HIGH)), found)
    found = info(text("german.csv", ["%d;%s;%s;%s" % (i, *("%.3f" % v for v in p)) for i, p in enumerate(utm)], "Punktnummer;Rechtswert;Hochwert;Hoehe\n"))
    check("3 Rechtswert and Hochwert", is_box(found, *moved(LOW, HIGH)), found)
    found = info(text("latitude.csv", ["%.8f,%.8f,%.3f" % (52.5 + p[1] / 111280, 13.4 + p[0] / 67900, p[2]) for p in HILL], "Lat,Lon,Height\n"))
    check("4 latitude first", is_box(found, (13.4, 52.5, LOW[2]), (13.4003, 52.5002, HIGH[2]), 0.1), found)
    found = info(text("numbered.txt", ["%d,%.3f,%.3f,%.3f" % (1001 + i, p[1], p[0], p[2]) for i, p in enumerate(utm)]))
    check("5 number, north, east, height with commas", is_box(found, *moved(LOW, HIGH)), found)
    found = info(text("words.xyz", ["%.3f\t%.3f\t%.3f\troof" % p[:3] for p in HILL]))
    check("6 a word behind each line", is_box(found, LOW, HIGH), found)
    done = run(ply("degrees.ply", [(13.38 + p[0] / 67900, 52.51 + p[1] / 111280, p[2]) for p in HILL], rgb, "double"), "-o", "degrees.png",
               "--resolution", "64x48")
    check("7 degrees in a PLY of doubles", done.returncode == 0 and "degrees" in done.stderr, done.stderr)
    names = [las("odd.las", utm, [tuple(300 if (i, k) == (5, 1) else v for k, v in enumerate(c)) for i, c in enumerate(rgb)])]
    rows = table(*names)
    check("8 one 300 among 8-bit colours", max(row["red"] for row in rows) in (210, 210 * 257), max(row["red"] for row in rows))
    found = info(las("nodata.las", utm, rgb, extra=("Height", 9, struct.pack("<d", -9999.0), [struct.pack("<f", -9999.0 if i % 9 == 0 else 1 + i / 900)
                                                                                         for i in range(900)])))
    one = attribute(found, "Height")
    check("9 no_data of floats, -9999", one and 1 <= one["min"] and one["max"] <= 2, one)
    found = info(las("nodata16.las", utm, rgb, extra=("Echo", 3, struct.pack("<Q", 65535), [struct.pack("<H", 65535 if i % 7 == 0 else i) for i in range(900)])))
    one = attribute(found, "Echo")
    check("10 no_data of 16 bits, 65535", one and one["max"] == 899, one)
    scan = [(p[0] - 10, p[1] - 6, p[2] - 2) for p in HILL]
    order = sorted(range(900), key=lambda i: math.atan2(scan[i][1], scan[i][0]))
    for number, name, columns in (("11", "six.bin", lambda i, n: (float(i * 37 % 256), float(n % 32), n * 0.0001)), ("12", "livox.bin", lambda i, n: (float(i * 37 % 256), 16.0))):
        with open(at(name), "wb") as file:
            for n, i in enumerate(order):
                file.write(struct.pack("<%df" % (3 + len(columns(i, n))), *scan[i], *columns(i, n)))
        found = info(name)
        check(f"{number} bare floats, {3 + len(columns(0, 0))} a point", is_box(found, (LOW[0] - 10, LOW[1] - 6, LOW[2] - 2), (HIGH[0] - 10, HIGH[1] - 6, HIGH[2] - 2)),
              found)
    found = info(text("labels.txt", ["%.3f\t%.3f\t%.3f\t%d\t%d\t%d\t%d" % (*p[:3], *[257 * c for c in p[3]], int(p[0] / 5)) for p in HILL]))
    check("13 x y z r g b label of 16 bits, by tabs", attribute(found, "red") and attribute(found, "red")["max"] == 210 * 257 and attribute(found, "label"), found["attributes"])
    with open(at("centres.asc"), "w") as file:
        file.write("NCOLS 30\nNROWS 20\nXLLCENTER 389120\nYLLCENTER 5819300\nCELLSIZE 2\nNODATA_VALUE -3.4028235e+38\n")
        for row in range(20):
            file.write(" ".join("-3.4028235e+38" if (row * 30 + c) % 50 == 0 else "%.2f" % (34 + c / 10) for c in range(30)) + "\n")
    found = info("centres.asc")
    check("14 an ESRI grid by its centres", is_box(found, (389120, 5819300, 34), (389178, 5819338, 36.9), 0.01) and found["points_finite"] == 588, found)
    with open(at("fog.splat"), "wb") as file:
        for i, p in enumerate(HILL):
            file.write(struct.pack("<6f8B", *p[:3], .1, .1, .1, *p[3], 255, 128, 128, 128, 128))
        for i in range(300):
            file.write(struct.pack("<6f8B", 500 + i, 0, 90, .1, .1, .1, 255, 255, 255, 0, 128, 128, 128, 128))
    found = info("fog.splat")
    check("15 .splat without opacity", is_box(found, LOW, HIGH) and found["points_finite"] == 900, found)
    with open(at("zeros.bin"), "wb") as file:
        for i in order:
            file.write(struct.pack("<8f", *scan[i], 0.5, 0, 0, 0, 0))
    found = info("zeros.bin")
    check("16 zeros at the scanner", found.get("points_finite") == 900 and "0 0 0" in found["said"], found)
    rows = table(ptx("half.ptx", [(HILL[:450], rgb[:450]), (HILL[450:], None)]))
    check("17 PTX, one scan without colours: not black", min(row["red"] + row["green"] + row["blue"] for row in rows) > 0 and len(rows) == 900, len(rows))
    rows = table(las("zero.las", utm), ply("colored.ply", [tuple(p) for p in utm], rgb, "double"))
    check("18 LAS of zeros beside a coloured PLY: not black", len(rows) == 1800 and min(r["red"] + r["green"] + r["blue"] for r in rows) > 0, len(rows))
    rows = table(ply("black.ply", HILL, [(0, 0, 0) if i % 3 == 0 else c for i, c in enumerate(rgb)]))
    check("19 black beside colours is black", sum(r["red"] + r["green"] + r["blue"] == 0 for r in rows) == 300)
    for name, lift in (("one.ply", 0), ("two.ply", 30)):
        ply(name, [(p[0], p[1], p[2] + (lift if p[0] > 15 else 0)) for p in HILL])
    same = run("one.ply", "one.ply", "--sequence", "--color-by", "elevation", "--up", "+Z", "-o", "same{n}.png", "--resolution", "64x48", "-t", "points")
    other = run("one.ply", "two.ply", "--sequence", "--color-by", "elevation", "--up", "+Z", "-o", "other{n}.png", "--resolution", "64x48", "-t", "points")
    pixels = [open(at(name), "rb").read() for name in ("same0.png", "other0.png")] if same.returncode == other.returncode == 0 else [b"IDAT", b"IDAT"]
    check("20 a sequence has one range", pixels[0][pixels[0].index(b"IDAT"):] != pixels[1][pixels[1].index(b"IDAT"):], other.stderr)


def joins():
    """Each pair in both orders: colours of every file are what it holds, in 8 bits."""
    rgb = [p[3] for p in HILL]
    west = [(p[0] + EAST, p[1] + NORTH, p[2] + UP) for p in HILL]
    makers = {}
    for bits, factor in (("8", 1), ("12", 16), ("16", 257)):
        values = [tuple(min(v * factor, 4095) if factor == 16 else v * factor for v in c) for c in rgb]
        las(f"c{bits}.las", west, values)
        makers["LAS " + bits] = f"c{bits}.las"
    las("c0.las", west)
    makers["LAS none"] = "c0.las"
    makers["PLY 8"], makers["PLY none"] = ply("c8.ply", west, rgb, "double"), ply("c0.ply", west, None, "double")
    for name in ("8", "16", "0"):
        assert run("convert", f"c{name}.las", "-o", f"c{name}.laz").returncode == 0
        assert run("build", f"c{name}.las", "-o", f"c{name}.copc.laz").returncode == 0
        makers["LAZ " + (name if name != "0" else "none")] = f"c{name}.laz"
        makers["COPC " + (name if name != "0" else "none")] = f"c{name}.copc.laz"
    shared = os.environ.get("SFUMATO_TEST_DATA")
    e57 = shared and os.path.join(shared, "strangers", "17_zeros_at_the_scanner.e57")
    if e57 and os.path.exists(e57):
        makers["E57 8"] = e57
    names = list(makers)
    print("\njoins by convert, first file down, second across (+ right, x wrong)\n" + " " * 10 + " ".join(n.rjust(9) for n in names))

    def mean_of(rows):
        return [sum(row[c] for row in rows) / max(len(rows), 1) for c in ("red", "green", "blue")]

    def as_bytes(mean):
        return [v / 257 for v in mean] if max(mean) > 255 else mean

    truth = {name: [255] * 3 if name.endswith("none") else None for name in names}
    for name in names:
        if truth[name] is None:
            truth[name] = [sum(c[k] for c in rgb) / 900 for k in range(3)]
    if "E57 8" in makers:
        truth["E57 8"] = [140.5, 97, 77.5]
    wrong = 0
    for first in names:
        line = first.ljust(10)
        for second in names:
            if first.endswith("none") and second.endswith("none"):
                line += "        -" + " "
                continue
            rows = table(makers[first], makers[second])
            parts = [[row for row in rows if row["file"] == n] for n in (1, 2)]
            holds = all(part and all(abs(a - b) < 1.5 for a, b in zip(as_bytes(mean_of(part)), truth[name])) for part, name in zip(parts, (first, second)))
            wrong += not holds
            line += ("+" if holds else "x").rjust(9) + " "
        print(line, flush=True)
    check("joins in both orders", wrong == 0, f"{wrong} of {len(names) ** 2}")
    for first, second in (("c8.las", "c16.las"), ("c16.las", "c8.las"), ("c12.las", "c16.laz"), ("c8.ply", "c16.copc.laz"), ("c0.las", "c16.las"), ("c16.las", "c0.ply")):
        done = run("build", first, second, "-o", "joined.copc.laz")
        rows = table("joined.copc.laz") if done.returncode == 0 else [{"red": 0, "green": 0, "blue": 0}]
        expected = [(sum(c[k] for c in rgb) / 900 + (255 if "c0" in first + second else sum(c[k] for c in rgb) / 900)) / 2 for k in range(3)]
        check(f"build {first} {second}", all(abs(a - b) < 1.5 for a, b in zip(as_bytes(mean_of(rows)), expected)), (as_bytes(mean_of(rows)), expected, done.stderr))


if __name__ == "__main__":
    dialects()
    joins()
    folder.cleanup()
    print(f"{len(failures)} wrong")
    sys.exit(1 if failures else 0)
