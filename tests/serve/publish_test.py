"""A published folder: complete or not there, and in a real browser, from the disk, what the file says."""
import json
import math
import os
import re
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.dirname(__file__))
import chromium  # noqa: E402
from server import COMMAND, check, failures, make_scan, points_of  # noqa: E402

PICTURES = os.environ.get("SFUMATO_PAGE_PICTURES")  # a folder: screenshots are kept there, for eyes


def publish(*words):
    return subprocess.run([COMMAND, "publish", *words], capture_output=True, text=True)


def files_of(folder):
    return sorted(os.path.relpath(os.path.join(at, name), folder) for at, _, names in os.walk(folder) for name in names)


def check_folders(folder, scan):
    web = os.path.join(folder, "web")
    small = ["--views", "4", "--resolution", "64x48", "-t", "points"]
    done = publish(scan, "-o", web, *small)
    check("a folder is written", done.returncode == 0 and "8 views" in done.stderr, done)
    files = files_of(web)
    check("with pictures, depth, pages and their list", {"index.html", "details.html", "data.js", "page.js", "page.css", "published.txt",
          "views/007.webp", "depth/007.js"} <= set(files), files)
    with open(os.path.join(web, "published.txt")) as listed:
        check("the list is complete", set(listed.read().splitlines()[1:]) | {"published.txt"} == set(files))
    check("nothing else is left", sorted(os.listdir(folder)) == ["scan.ply", "web"], os.listdir(folder))
    outside = [(name, found) for name in files if not name.endswith(".webp") for found in
               re.findall(r"https?://[^\s\"'<]*|//[a-z]+\.[a-z]+", open(os.path.join(web, name), encoding="utf-8").read())
               if "www.w3.org/2000/svg" not in found and not name.startswith("depth/")]
    check("nothing is loaded from elsewhere", not outside, outside)
    done = publish(scan, "-o", web + "/", *small, "--elevations", "5,20,60")
    check("it replaces what it wrote", done.returncode == 0 and len(files_of(os.path.join(web, "views"))) == 12, done)
    again = os.path.join(folder, "again")
    publish(scan, "-o", again, *small, "--elevations", "5,20,60")
    same = [name for name in files_of(web) if name != "details.html" and open(os.path.join(web, name), "rb").read() != open(os.path.join(again, name), "rb").read()]
    check("twice the same bytes", not same and files_of(web) == files_of(again), same)

    before = {name: os.path.getmtime(os.path.join(web, name)) for name in files_of(web)}
    for words, code, said in (
            ([scan], 1, "-o FOLDER"),
            ([scan, "-o", "-"], 1, "-o FOLDER"),
            ([scan, "-o", scan], 1, "no folder"),
            ([scan, "-o", folder], 1, "holds"),
            ([scan, "-o", os.path.join(folder, "no", "such")], 6, "no folder can be made"),
            ([scan + "x", "-o", web], 6, "scan.plyx"),
            ([scan, "-o", web, "--views", "2"], 1, "--views"),
            ([scan, "-o", web, "--views", "5000"], 1, "--views"),
            ([scan, "-o", web, "--elevations", "100"], 1, "--elevations"),
            ([scan, "-o", web, "--elevations", "a"], 1, "--elevations"),
            ([scan, "-o", web, "-t", "points,splats"], 1, "one technique"),
            ([scan, "-o", web, "--path", "orbit"], 1, "--path"),
            ([scan, "-o", web, "--output-depth", "x.npy"], 1, "--output-depth"),
            ([scan, "-o", web, "--color-by", "nonsense"], 1, "nonsense")):
        done = publish(*words)
        check("refused: " + " ".join(words)[-40:], done.returncode == code and said in done.stderr and done.stderr.count("\n") == 1, done)
    with open(os.path.join(web, "notes.txt"), "w") as notes:
        notes.write("mine")
    done = publish(scan, "-o", web, *small)
    check("a file of somebody else's is never lost", done.returncode == 1 and "notes.txt" in done.stderr, done)
    os.remove(os.path.join(web, "notes.txt"))
    check("an older folder stays as it was", before == {name: os.path.getmtime(os.path.join(web, name)) for name in files_of(web)})
    running = subprocess.Popen([COMMAND, "publish", scan, "-o", web, "--views", "300", "-t", "points"], stderr=subprocess.PIPE)
    while running.poll() is None and not any(name.startswith(".web.part") for name in os.listdir(folder)):
        time.sleep(0.02)
    time.sleep(0.5)
    running.send_signal(signal.SIGINT)
    running.communicate(timeout=60)
    check("Ctrl-C leaves nothing half done", running.returncode == 130 and sorted(os.listdir(folder)) == ["again", "scan.ply", "web"], (running.returncode, os.listdir(folder)))


def nearest_point(points, place):
    return min(points, key=lambda p: sum((p[a] - v) ** 2 for a, v in zip("xyz", place)))


def away(point, place):
    return math.dist([point[a] for a in "xyz"], place)


def check_page(folder, scan):
    web = os.path.join(folder, "web")
    plain, scan = scan, os.path.join(folder, "a & <b>.ply")
    os.rename(plain, scan)
    done = publish(scan, "-o", web, "--views", "12", "--resolution", "960x720", "-t", "surface", "--unit", "ft")
    check("published for the browser", done.returncode == 0, done)
    page = "file://" + os.path.join(web, "index.html")
    shown = "document.getElementById('picture')?.dataset.shown"
    with chromium.Browser() as browser:
        tab = browser.open(page, 1100, 700)
        begin = tab.wait(shown)
        check("it shows the first view", begin.startswith("0,"), begin)
        check("the title is plain text", tab.run("document.title") == "a & <b>")

        def picture(name, on=tab):
            if PICTURES:
                on.screenshot(os.path.join(PICTURES, name + ".png"))

        def shows(view, on=tab):
            return on.wait(f"{shown} === document.getElementById('picture')?.dataset.view && {shown} !== {json.dumps(view)} && {shown}")

        tab.drag(500, 300, 200, 0)
        turned = shows(begin)
        check("a drag turns", turned.split(",")[0] != "0" and turned.split(",")[1] == begin.split(",")[1], turned)
        tab.drag(500, 300, 0, 250)
        risen = shows(turned)
        check("a drag down looks from higher", float(risen.split(",")[1]) > float(turned.split(",")[1]), risen)
        tab.wait(f"location.hash === '#view={risen}'")
        linked = browser.open(page + "#view=" + turned + "&zoom=1.5,0.4,0.6", 1100, 700)
        linked.wait(f"{shown} === {json.dumps(turned)}")
        state = linked.run("publishedState()")
        check("an address leads to its view", abs(state["zoom"] - 1.5) < 1e-6 and abs(state["x"] - 0.4) < 0.05, state)
        tab.call("Page.bringToFront")  # pages behind others get no events of wheels
        for _ in range(30):
            tab.wheel(500, 300, 3)
        zoomed = tab.run("publishedState().zoom")
        check("the wheel zooms to the limit of the pictures", 1.5 < zoomed < 6, zoomed)
        tab.run("document.getElementById('home').click()")
        check("Home is the first view", tab.wait(f"{shown} === {json.dumps(begin)} && {shown}") == begin)
        for key, code in (("ArrowRight", 39), ("ArrowUp", 38)):
            tab.run("document.getElementById('picture').focus()")
            tab.call("Input.dispatchKeyEvent", type="keyDown", key=key, code=key, windowsVirtualKeyCode=code)
        keyed = shows(begin)
        check("arrow keys turn and rise", keyed.split(",")[0] == "30.0" or keyed.split(",")[0] == "30", keyed)

        # Two clicks where points of the file are drawn, against the file.
        points = points_of(scan)
        tab.run("document.getElementById('home').click()")
        tab.wait(f"{shown} === {json.dumps(begin)}")
        box = tab.run("(() => { const b = document.getElementById('picture').getBoundingClientRect(); return [b.left, b.top, b.width, b.height]; })()")
        found = []
        # Wherever the first view has the scan: a click beside it finds nothing.
        for x, y in ((0.5, 0.5), (0.42, 0.6), (0.58, 0.4), (0.42, 0.5), (0.58, 0.5), (0.5, 0.6)):
            tab.click(box[0] + box[2] * x, box[1] + box[3] * y)
            time.sleep(1)
            if tab.run("publishedState().points.length") > len(found):
                found.append(tab.run("publishedState().points")[-1])
            if len(found) == 2:
                break
        check("two clicks find points", len(found) == 2, found)
        picture("published")
        measured = tab.run("publishedState().measured")
        real = [nearest_point(points, place) for place in found]
        near = [away(point, place) for point, place in zip(real, found)]
        check("clicks find what the file holds", max(near) < 0.05, near)
        check("the distance is in metres", abs(measured["distance"] - 0.3048 * math.dist(*found)) < 1e-6, measured)
        between = 0.3048 * math.dist([real[0][a] for a in "xyz"], [real[1][a] for a in "xyz"])
        check("the distance is that of the file's points", abs(measured["distance"] - between) < 0.3048 * sum(near) + 1e-6, (measured, between))
        text = tab.run("document.getElementById('measured').textContent")
        check("it is told, with its error", measured["distanceText"] in text and measured["distanceText"].endswith(" m") and "±" in text, text)
        # The nearest points of the file lie where the page draws them: each is found by a click at its place.
        errors = []
        for point in sorted(points, key=lambda p: p["z"])[-1:] + real[:1]:
            tab.run("document.getElementById('clear').click()")
            place = tab.run(f"publishedPlace({[point[a] for a in 'xyz']})")
            tab.click(box[0] + place[0], box[1] + place[1])
            tab.wait("publishedState().points.length === 1")
            errors.append(away(point, tab.run("publishedState().points")[0]))
        check("a click on a point of the file is that point", max(errors) < 0.05, errors)
        tab.run("document.getElementById('clear').click()")
        tab.run("document.getElementById('picture').focus()")
        tab.call("Input.dispatchKeyEvent", type="keyDown", key="Enter", code="Enter", windowsVirtualKeyCode=13)
        check("Enter measures in the middle", tab.wait("publishedState().points.length === 1"))
        picture("published_keyboard")

        narrow = browser.open(page, 360, 740, 2, touch=True)
        still = narrow.wait(shown)
        check("nothing is wider than a narrow screen", narrow.run("document.documentElement.scrollWidth <= 360"))
        picture("published_narrow", narrow)
        narrow.touch("touchStart", [(180, 300)])
        for i in range(1, 6):
            narrow.touch("touchMove", [(180 + 20 * i, 300)])
        narrow.touch("touchEnd", [])
        check("one finger turns", shows(still, narrow) != still)
        narrow.touch("touchStart", [(150, 300), (210, 300)])
        for i in range(1, 6):
            narrow.touch("touchMove", [(150 - 10 * i, 300), (210 + 10 * i, 300)])
        narrow.touch("touchEnd", [])
        check("two fingers zoom", narrow.run("publishedState().zoom") > 1.5)
        narrow.call("Page.navigate", url="file://" + os.path.join(web, "details.html"))
        narrow.wait("document.readyState === 'complete' && !!document.querySelector('pre')")
        details = narrow.run("document.body.innerText")
        check("the details have the command, the facts and what it cannot do",
              all(each in details for each in ("sfumato publish", "a & <b>.ply", "surface", "What it cannot do", "MB")), details[:800])
        check("the details are no wider", narrow.run("document.documentElement.scrollWidth <= 360"))
        picture("published_details", narrow)
        wide = browser.open(page, 2560, 1440)
        wide.wait(shown)
        picture("published_wide", wide)
        dark = browser.open("about:blank", 1280, 800)
        dark.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark"}])
        dark.call("Page.navigate", url=page)
        dark.wait(shown)
        check("dark where the system is", dark.run("getComputedStyle(document.body).backgroundColor") == "rgb(30, 31, 33)")
        picture("published_dark", dark)
        for each in (tab, linked, narrow, wide, dark):
            each.run("1")
            check("no complaint of the browser", not each.complaints, each.complaints)


def main():
    with tempfile.TemporaryDirectory() as folder:
        scan = make_scan(folder, 20000)
        check_folders(folder, scan)
    if not failures and chromium.missing():
        print("SKIPPED: " + chromium.missing())  # the folder itself is right
        return
    if not chromium.missing():
        with tempfile.TemporaryDirectory() as folder:
            check_page(folder, make_scan(folder, 60000))
    if failures:
        sys.exit(f"{len(failures)} failed: {failures}")


main()
