"""The page in a real browser: what hands do, what is seen, and that both are what the file and the command say."""
import json
import os
import shlex
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.dirname(__file__))
import chromium  # noqa: E402
from server import COMMAND, Server, check, failures, make_scan, points_of  # noqa: E402

if chromium.missing():
    print("SKIPPED: " + chromium.missing())
    sys.exit(0)

PICTURES = os.environ.get("SFUMATO_PAGE_PICTURES")  # a folder: screenshots are kept there, for eyes
EXACT = "document.getElementById('picture')?.dataset.exact === 'true'"
CANVAS = "document.getElementById('picture')"
HASH = """(() => { const c = document.getElementById('picture');
  const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;
  let h = 0; for (let i = 0; i < d.length; ++i) h = (Math.imul(h, 31) + d[i]) | 0; return h; })()"""


def settle(tab, deed=lambda: None):
    """Does something that changes the picture, and waits for the exact one of all that was done: on a busy machine
    one of before, or of the middle of a drag, comes first. What hands do is sent at the next frame of the page."""
    tab.run(f"{CANVAS}.dataset.exact = 'waits'")
    deed()
    tab.run("Promise.race([new Promise(requestAnimationFrame), new Promise(done => setTimeout(done, 1000))]).then(() => 0)")
    tab.wait(f"{EXACT} && Number({CANVAS}.dataset.heard) >= {tab.run(f'Number({CANVAS}.dataset.said)')}")
    return tab.run(HASH)


def settle_to(tab, deed, is_there):
    """The same where other points are read first: an exact picture of those before may come in between."""
    found = settle(tab, deed)
    for _ in range(50):
        if is_there(found):
            break
        time.sleep(0.2)
        tab.wait(EXACT)
        found = tab.run(HASH)
    return found


def picture(tab, name):
    if PICTURES:
        tab.screenshot(os.path.join(PICTURES, name + ".png"))


def command_picture(command, folder):
    words = shlex.split(command)
    assert words[0] == "sfumato", command
    subprocess.run([COMMAND, *words[1:]], check=True, cwd=folder, stderr=subprocess.DEVNULL)
    with open(os.path.join(folder, "picture.png"), "rb") as data:
        return data.read()


def shot_bytes(tab):
    tab.wait("!!window.lastShot")
    return bytes(json.loads(tab.run("""(async () => JSON.stringify([...new Uint8Array(await window.lastShot.arrayBuffer())]))()""")))


def comes_to(tab, wanted):
    """Whether the tab shows that exact picture before long."""
    for _ in range(150):
        if tab.run(f"{EXACT} && {HASH}") == wanted:
            return True
        time.sleep(0.2)
    return False


def look_together(folder, browser):
    """--share: one view for all, and pointers."""
    with Server(os.path.join(folder, "scan.ply"), "-t", "points", "--share", "--quiet") as server:
        one, two = browser.open(server.address, 900, 560), browser.open(server.address, 900, 560)
        for each in (one, two):
            each.wait(EXACT)
        check("pages that look together begin with one view", two.run(HASH) == one.run(HASH))
        one.call("Page.bringToFront")
        turned = settle(one, lambda: one.drag(300, 300, 90, 30))
        two.call("Page.bringToFront")
        check("what one turns, the other sees", comes_to(two, turned))
        settle(two, lambda: two.run("[...document.querySelectorAll('.techniques button')].find(b => b.textContent === 'splats').click()"))
        one.call("Page.bringToFront")
        one.wait(f"{CANVAS}.dataset.technique === 'splats'")
        check("what the other draws with, one sees", comes_to(one, two.run(HASH)))
        one.mouse("mouseMoved", 310, 320, 0)
        box = two.run("(() => { const b = document.getElementById('picture').getBoundingClientRect(); return [b.left, b.top]; })()")
        where = "document.querySelector('#marks .pointer')?.getAttribute('d')"
        for _ in range(50):
            at = [float(v) for v in (two.run(where) or "M0,0l")[1:].split("l")[0].split(",")]
            near = abs(at[0] + box[0] - 310) < 30 and abs(at[1] + box[1] - 320) < 30
            if near:
                break
            time.sleep(0.1)
        check("a pointer is where the other points", near, (at, box))
        third = browser.open(server.address, 900, 560)
        third.wait(EXACT)
        check("who comes later sees the same", comes_to(third, two.run(HASH)))
        one.close()
        check("who leaves takes the pointer along", two.wait("!document.querySelector('#marks .pointer')"))
        two.close()
        third.close()


def main():
    with tempfile.TemporaryDirectory() as folder, Server(make_scan(folder), "-t", "points", "--quiet") as server, \
            chromium.Browser() as browser:
        file = os.path.join(folder, "scan.ply")
        tab = browser.open(server.address, 1100, 640)
        tab.wait(EXACT)
        first = tab.run(HASH)
        picture(tab, "desktop")
        check("the title names the file", "scan.ply" in tab.run("document.title"))
        size = tab.run("[document.getElementById('picture').clientWidth, document.getElementById('picture').clientHeight]")
        box = tab.run("(() => { const b = document.getElementById('picture').getBoundingClientRect(); return [b.left, b.top]; })()")
        x, y = box[0] + size[0] / 2, box[1] + size[1] / 2

        turned = settle(tab, lambda: tab.drag(x, y, 120, 10))
        check("a drag turns", turned != first)
        check("it went through pictures of motion", int(tab.run(f"{CANVAS}.dataset.pictures")) >= 3)
        if tab.run("!!document.createElement('canvas').getContext('webgl2')"):
            check("between pictures the last one is bent", int(tab.run(f"{CANVAS}.dataset.warped ?? 0")) > 0)
        else:
            print("not tested: this browser has no WebGL 2, so that pictures are not bent")
        bent = tab.run("""(async () => { const { bend } = await import(location.href + 'warp.mjs');
            const from = { position: [500000, 0, 0], target: [500000, 10, 0], up: [0, 0, 1], fov_deg: 90, orthographic: false };
            const to = { ...from, position: [500001, 0, 0], target: [500001, 10, 0] };
            const depth = { width: 2, height: 2, values: new Float32Array([10, 10, 5, 0]) };
            return [from, to].map(camera => { const c = bend(depth, from, camera, 1); return [0, 1, 2, 3].map(i => [c[4 * i] / c[4 * i + 3], c[4 * i + 1] / c[4 * i + 3]]); }); })()""")
        wanted = [[[-1, 1], [1, 1], [-1, -1], [1, -1]], [[-1.1, 1], [0.9, 1], [-1.2, -1], [0.9, -1]]]
        check("a sheet is bent by its depth", all(abs(a - b) < 1e-5 for one, two in zip(bent, wanted) for p, q in zip(one, two) for a, b in zip(p, q)), bent)
        check("a wheel zooms", settle(tab, lambda: tab.wheel(x, y, 2)) != turned)
        check("undo goes back", settle(tab, lambda: tab.run("document.getElementById('undo').click()")) == turned)
        check("Home is the first view", settle(tab, lambda: tab.run("document.querySelector('[data-view=reset]').click()")) == first)

        names = tab.run("[...document.querySelectorAll('.techniques button')].map(b => b.textContent)")
        check("all seven techniques are there", len(names) == 7, names)
        seen = set()
        for name in names[1:] + names[:1]:
            seen.add(settle(tab, lambda: tab.run(
                f"[...document.querySelectorAll('.techniques button')].find(b => b.textContent === '{name}').click()")))
            tab.wait(f"document.querySelector('.techniques [aria-pressed=true]')?.textContent === '{name}' && {CANVAS}.dataset.technique === '{name}'")
            listed = subprocess.run([COMMAND, "techniques", name, "--json"], capture_output=True, text=True)
            if listed.returncode == 0 and listed.stdout.startswith("{"):
                own = [each["name"] for each in json.loads(listed.stdout).get("parameters", [])]
                there = tab.run("[...document.querySelectorAll('.control [id^=p-]')].map(e => e.id.slice(2))")
                check(f"{name}: every parameter has a control", set(own) <= set(there), set(own) - set(there))
        check("each technique has a picture of its own", len(seen) == 7, len(seen))

        larger = settle(tab, lambda: tab.run("""(() => { const s = document.getElementById('p-point_size-slider');
            s.value = 0.9; s.dispatchEvent(new Event('input')); })()"""))
        check("a slider changes the picture", larger != first)
        check("the number beside it follows", float(tab.run("document.getElementById('p-point_size').value")) > 2)
        settle(tab, lambda: tab.run("document.querySelector('#p-point_size').closest('.control').querySelector('[aria-label*=back]').click()"))

        tab.click(x, y)
        tab.wait("!document.getElementById('picked').hidden")
        rows = dict(tab.run("[...document.querySelectorAll('#picked tr')].map(r => [...r.cells].map(c => c.textContent))"))
        truth = points_of(file)[int(rows["point"])]
        check("a picked point is the file's", all(abs(float(rows[a]) - truth[a]) < 2e-3 for a in "xyz"), (rows, truth))
        tab.click(x + 60, y + 20, modifiers=2)
        tab.wait("[...document.querySelectorAll('#picked tr')].some(r => r.cells[0].textContent === 'distance')")
        again = dict(tab.run("[...document.querySelectorAll('#picked tr')].map(r => [...r.cells].map(c => c.textContent))"))
        other = points_of(file)[int(again["point"])]
        distance = sum((truth[a] - other[a]) ** 2 for a in "xyz") ** 0.5
        check("the distance is that of the file's points", abs(float(again["distance"].split()[0]) - distance) < 5e-3, (again, distance))
        picture(tab, "measured")

        tab.run("document.getElementById('panel-items').open = true")
        item = settle_to(tab, lambda: tab.run("""(() => { const panel = document.getElementById('panel-items');
            const text = panel.querySelector('input[placeholder]'); text.value = 'z 0..: splats';
            text.nextElementSibling.click(); })()"""), lambda found: found != first)
        check("an item is drawn", item != first)
        settle_to(tab, lambda: tab.run("document.getElementById('undo').click()"), lambda found: found == first)
        boxed = settle_to(tab, lambda: tab.run("""(() => { const fields = document.querySelectorAll('#panel-clip-box input');
            fields[3].value = String((Number(fields[0].value) + Number(fields[3].value)) / 2);
            fields[3].dispatchEvent(new Event('change')); })()"""), lambda found: found != first)
        check("a clip box clips", boxed != first)
        settle_to(tab, lambda: tab.run("document.getElementById('undo').click()"), lambda found: found == first)

        tab.run("document.getElementById('panel-save').open = true; window.lastShot = null; document.getElementById('shot-size').value = '320x200'; document.getElementById('shoot-size').click()")
        saved = shot_bytes(tab)
        text = saved[saved.index(b"tEXtCommand") + 12:]
        command = text[:text.index(b"tEXt") - 8].decode()
        check("a saved picture is the command's, byte for byte", command_picture(command, folder) == saved, command)
        tab.run("document.getElementById('copy').click()")
        command = tab.wait(f"{CANVAS}.dataset.command")
        tab.run("window.lastShot = null; document.getElementById('shoot').click()")
        saved = shot_bytes(tab)
        check("the copied command makes the saved picture", command_picture(command, folder) == saved, command)
        before = tab.run(HASH)
        check("an orthographic view is another", settle(tab, lambda: tab.run("document.querySelector('[data-view=parallel]').click()")) != before)
        tab.run("window.lastShot = null; document.getElementById('copy').click()")
        command = tab.wait(f"{CANVAS}.dataset.command.includes('orthographic') && {CANVAS}.dataset.command")
        tab.run("document.getElementById('shoot').click()")
        saved = shot_bytes(tab)
        check("so is its command's, byte for byte", command_picture(command, folder) == saved, command)
        settle(tab, lambda: tab.run("document.getElementById('undo').click()"))
        settle(tab, lambda: tab.run("""(() => { const s = document.getElementById('color-color_by'); s.value = 'elevation'; s.dispatchEvent(new Event('change')); })()"""))
        maps = tab.wait("document.getElementById('color-colormap') && [...document.getElementById('color-colormap').options].map(each => each.value)")
        check("colour maps are listed both ways", "viridis" in maps and "viridis_r" in maps, maps)
        settle(tab, lambda: tab.run("document.getElementById('undo').click()"))

        status, headers, body = server.get("render?technique=points&resolution=160x120&camera-azimuth-angle=40")
        check("GET /render is what its command makes", status == 200 and command_picture(headers["X-Sfumato-Command"], folder) == body, (status, body[:200]))

        # A second page has a view and a technique of its own, over the same points.
        points = server.info()["memory"]["points"]
        before = tab.run(HASH)
        other = browser.open(server.address, 900, 560)
        other.wait(EXACT)
        settle(other, lambda: other.run("[...document.querySelectorAll('.techniques button')].find(b => b.textContent === 'splats').click()"))
        settle(other, lambda: other.drag(300, 300, 80, 40))
        check("the first page keeps its technique", tab.run(f"{CANVAS}.dataset.technique") == "points")
        check("the first page keeps its picture", tab.run(HASH) == before)
        check("the second page has its own", other.run(f"{CANVAS}.dataset.technique") == "splats")
        tab.run("location.reload()")
        tab.wait("document.readyState === 'complete'")
        tab.wait(EXACT)
        check("a page that is loaded again shows the first view", tab.run(HASH) == first)
        check("points are in memory once", points > 0, points)

        tablet = browser.open(server.address, 820, 1100, 2, touch=True)
        tablet.wait(EXACT)
        picture(tablet, "tablet")
        narrow = browser.open(server.address, 360, 740, 2, touch=True)
        narrow.wait(EXACT)
        still = narrow.run(HASH)
        check("nothing is wider than a narrow screen", narrow.run("document.documentElement.scrollWidth <= 360"))
        picture(narrow, "narrow")

        def swipe():
            narrow.touch("touchStart", [(180, 200)])
            for i in range(1, 6):
                narrow.touch("touchMove", [(180 + 15 * i, 200)])
            narrow.touch("touchEnd", [])

        def pinch():
            narrow.touch("touchStart", [(150, 200), (210, 200)])
            for i in range(1, 6):
                narrow.touch("touchMove", [(150 - 8 * i, 200), (210 + 8 * i, 200)])
            narrow.touch("touchEnd", [])
        swiped = settle(narrow, swipe)
        check("one finger turns", swiped != still)
        check("two fingers zoom", settle(narrow, pinch) != swiped)
        before = narrow.run(HASH)
        middle = f"(() => {{ const b = {CANVAS}.getBoundingClientRect(); return (b.top + b.bottom) / 2; }})()"
        narrow.run("document.getElementById('toggle').click()")
        narrow.run("new Promise(done => setTimeout(done, 800))")
        narrow.wait(EXACT)
        check("panels leave the scan as large, in the middle of what remains", narrow.run(HASH) == before and
              abs(narrow.run(middle) - narrow.run("document.getElementById('view').clientHeight") / 2) < 2, narrow.run(middle))
        picture(narrow, "narrow_panels")
        unnamed = tab.run("""[...document.querySelectorAll('button,input,select')].filter(e => !(e.textContent.trim() && e.tagName === 'BUTTON') &&
            !e.labels?.length && !e.getAttribute('aria-label')).map(e => e.outerHTML.slice(0, 80))""")
        check("every control has a name for screen readers", not unnamed, unnamed)
        for each in (tab, other, tablet, narrow):
            each.run("1")
            check("no complaint of the browser", not each.complaints, each.complaints)
        for each in (tab, other, tablet, narrow):
            each.close()
        look_together(folder, browser)
    if failures:
        sys.exit(f"{len(failures)} failed: {failures}")


main()
