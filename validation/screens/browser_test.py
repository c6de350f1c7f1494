#!/usr/bin/env python3
"""Opens the gallery's reports in headless Chromium and uses them as a reader would.

For each: nothing on the console and no request beside the page itself; size and time to open; the first number within the
first 40 % of a screen of 900 px and on the first screen of a phone; curves zoom by mouse and by keyboard, their neighbours
with them, and show the nearest sample; the picture in space turns by mouse, touch and keyboard, its scrubber moves the
cursor of the curves, and it stands still where motion is to be reduced; the printed PDF has every section and begins with the answer; words for every picture, headings in order, contrast in
light and dark; no violation found by axe-core. Screens (desktop, phone, dark, print) are those of validation/screens within a
tolerance, and a planted change is found. Each line says the figures. Pictures and PDFs stay beside the reports.

Skipped with a line: all of it where there is no Chromium (Debian: apt-get install chromium), axe-core where there is no npm. The
built book (target/book) is opened page by page.

    scripts/browser-test [--poinsot PATH] [FOLDER ...]   folders with a report.html; default: the gallery
    scripts/browser-test --renew                         writes validation/screens, the thumbnails of docs/gallery.md, docs/assets/report.png

POINSOT_CHROMIUM   the browser, if it is not on the path
"""

import argparse
import json
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

import chromium
import gallery
import screens

ROOT = Path(__file__).resolve().parents[2]
AXE_VERSION = "4.10.3"
AXE = ROOT / "target/axe/package/axe.min.js"
THUMBNAILS = ROOT / "docs/assets/gallery"
# Width of a thumbnail over that of the screen.
THUMBNAIL = 0.2
# The report that README shows: name, picture, its width over that of the screen.
SHOWN = ("determined", ROOT / "docs/assets/report.png", 0.65)
# Largest report of shipped data, and of any, bytes.
LARGEST = 1_000_000
LARGEST_OF_ANY = 3_000_000
SCREEN = (1400, 900)
PHONE = (390, 844)
# Share of the first screen within which the first number stands.
FIRST_NUMBER = 0.4
# Most screens of a folded page, and most seconds to open it.
SCREENS = 8
OPEN_S = 1.0

# Contrast (WCAG 2.1) of every piece of text against what is painted behind it.
CONTRAST = r"""
(() => {
  const parse = c => { const n = c.match(/[\d.]+/g).map(Number); return [n[0], n[1], n[2], n.length > 3 ? n[3] : 1]; };
  const over = (a, b) => [0, 1, 2].map(k => a[k] * a[3] + b[k] * (1 - a[3])).concat(1);
  const light = c => { const f = x => { x /= 255; return x <= 0.03928 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4; };
    return 0.2126 * f(c[0]) + 0.7152 * f(c[1]) + 0.0722 * f(c[2]); };
  const behind = e => { const stack = []; for (; e; e = e.parentElement) stack.push(parse(getComputedStyle(e).backgroundColor));
    const dark = matchMedia("(prefers-color-scheme: dark)").matches;
    return stack.reverse().reduce((b, a) => over(a, b), dark ? [18, 18, 18, 1] : [255, 255, 255, 1]); };
  const low = {};
  const walk = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (walk.nextNode()) {
    const e = walk.currentNode.parentElement, text = walk.currentNode.textContent.trim();
    if (!text || !e.getClientRects().length || ["SCRIPT", "STYLE"].includes(e.tagName)) continue;
    const style = getComputedStyle(e), ground = behind(e);
    const ink = over(parse(e instanceof SVGElement ? style.fill : style.color), ground);
    const [a, b] = [light(ink), light(ground)].sort((x, y) => y - x);
    const ratio = (a + 0.05) / (b + 0.05), size = parseFloat(style.fontSize);
    const needed = size >= 24 || (size >= 18.66 && +style.fontWeight >= 700) ? 3 : 4.5;
    if (ratio < needed) low[e.tagName + "." + (e.className.baseVal ?? e.className) + " " + ratio.toFixed(2)] = text.slice(0, 30);
  }
  return low;
})()
"""

WORDLESS = """
[...document.querySelectorAll("img, svg[role=img], .stage canvas, .canvas")].filter(e =>
  !(e.getAttribute("alt") || e.getAttribute("aria-label") || "").trim()).map(e => e.outerHTML.slice(0, 80))
"""

HEADINGS = """[...document.querySelectorAll("h1, h2, h3, h4")].map(h => [+h.tagName[1], h.textContent])"""

# Lowest edge of the first number of the answer, px.
NUMBER = r"""
(() => {
  const walk = document.createTreeWalker(document.querySelector("main"), NodeFilter.SHOW_TEXT);
  while (walk.nextNode()) {
    const e = walk.currentNode.parentElement;
    if (!/\d/.test(walk.currentNode.textContent) || !e.getClientRects().length || e.tagName === "SCRIPT") continue;
    const range = document.createRange();
    range.selectNodeContents(walk.currentNode);
    return range.getBoundingClientRect().bottom + scrollY;
  }
})()
"""

# Whatever answers to a click or a drag must also be reached by the tabulator.
UNREACHABLE = """
[...document.querySelectorAll(".canvas, .stage canvas, a[href], button, input, select")].filter(e =>
  e.tabIndex < 0 || (["BUTTON", "INPUT", "SELECT"].includes(e.tagName) && !(e.textContent || e.getAttribute("aria-label"))))
  .map(e => e.outerHTML.slice(0, 80))
"""


# Links into the page that lead nowhere.
DEAD = """
[...document.querySelectorAll('a[href^="#"]')].map(a => a.getAttribute("href").slice(1)).filter(id => !document.getElementById(id))
"""


class Check:
    """One report, its findings."""

    def __init__(self, browser, name, file, limits):
        self.browser, self.name, self.file = browser, name, file
        self.folder = file.parent
        self.largest = limits
        self.faults = []

    def need(self, holds, what):
        if not holds:
            self.faults.append(what)

    def run(self):
        size = self.file.stat().st_size
        self.need(size < self.largest, f"{size} bytes are too many")
        # The best of three, since other programs may use the machine; the last one is before the others.
        pages = [self.browser.open(self.file.as_uri(), *SCREEN) for _ in range(3)]
        page, opened = pages[-1], min(p.loaded_s for p in pages)
        self.need(opened < OPEN_S, f"opens in {opened:.2f} s")
        number = page.value(NUMBER)
        self.need(number < FIRST_NUMBER * SCREEN[1], f"the first number ends at {number:.0f} px")
        screens = page.value("document.documentElement.scrollHeight") / SCREEN[1]
        self.need(screens < SCREENS, f"{screens:.1f} screens long")
        self.need(not page.value(CONTRAST), f"too little contrast: {page.value(CONTRAST)}")
        (self.folder / "light.png").write_bytes(page.picture())
        self.zoom(page)
        self.turn(page)
        axe = self.axe(page)
        self.words(page)
        self.paper(page)
        self.need(not page.complaints(), f"the console says: {page.complaints()}")
        self.need(not page.requests(), f"asked for: {page.requests()}")
        dark = self.browser.open(self.file.as_uri(), *SCREEN, dark=True)
        self.need(not dark.value(CONTRAST), f"too little contrast in the dark: {dark.value(CONTRAST)}")
        self.need(not dark.complaints(), f"the console says in the dark: {dark.complaints()}")
        (self.folder / "dark.png").write_bytes(dark.picture())
        self.need(self.turns_by_itself(), "the picture does not turn until it is touched")
        narrow = self.browser.open(self.file.as_uri(), *PHONE)
        wide = narrow.value("document.documentElement.scrollWidth")
        self.need(wide <= PHONE[0], f"{wide} px wide on a screen of {PHONE[0]}")
        on_phone = narrow.value(NUMBER)
        self.need(on_phone < PHONE[1], f"the first number ends at {on_phone:.0f} px of a phone")
        (self.folder / "narrow.png").write_bytes(narrow.picture())
        verdict = "good" if not self.faults else "FAULTS"
        print(
            f"{self.name}: {verdict}; {size} bytes, open in {opened:.2f} s, {screens:.1f} screens, "
            f"first number at {number:.0f} of {SCREEN[1]} px and {on_phone:.0f} of {PHONE[1]} px, "
            f"{len(page.complaints())} messages, {len(page.requests())} requests, axe {axe}",
            flush=True,
        )
        for fault in self.faults:
            print(f"    {fault}")
        return not self.faults

    def axe(self, page):
        """Accessibility by axe-core, where it lies; folds are open. What it found, in words."""
        if not AXE.is_file():
            return "not run"
        page.value("document.querySelectorAll('details').forEach(d => { d.open = true; }); 0")
        page.value(AXE.read_text() + "; 0")
        passed, found = page.value(
            """axe.run(document, { resultTypes: ["violations"] }).then(r => [r.passes.length, r.violations.map(v =>
            v.id + " (" + v.nodes.length + "): " + v.nodes[0].html.slice(0, 90))])"""
        )
        for violation in found:
            self.faults.append(f"axe: {violation}")
        return f"{len(found)} violations, {passed} rules passed"

    def middle(self, page, place, share):
        """A point of an element that is brought into view, by its shares of width and height."""
        box = page.value(
            f"""(() => {{ const e = {place}; e.scrollIntoView({{ block: "center", behavior: "instant" }});
            const r = e.getBoundingClientRect(); return [r.left, r.top, r.width, r.height]; }})()"""
        )
        return [box[0] + share[0] * box[2], box[1] + share[1] * box[3]]

    def zoom(self, page):
        """Opens the first fold with two plots of a record; zoom, cursor, keyboard."""
        page.value(
            """[...document.querySelectorAll("#trust details, #flown details")].filter(d => d.querySelector(".curves-data") &&
            !d.closest("[hidden]")).forEach(d => { d.open = true; })"""
        )
        charts = '[...document.querySelectorAll(".canvas")].filter(c => c.clientWidth)'
        count = page.value(f"{charts}.length")
        if not count:
            self.need(not page.value('!!document.querySelector(".curves-data")'), "no curves")
            return
        page.settle()
        page.value(f"for (const c of {charts}) {{ c.scrollIntoView({{ behavior: 'instant' }}); dispatchEvent(new Event('scroll')); }}")
        self.need(page.value(f"{charts}.every(c => c.dataset.from)"), "curves are not drawn")
        field = f"[{charts}[0].dataset.from, {charts}[0].dataset.to]"
        home = page.value(field)
        start = self.middle(page, f"{charts}[0].querySelector('.u-over')", (0.4, 0.5))
        end = [start[0] + 150, start[1]]
        page.drag(start, end)
        seen = page.value(field)
        self.need(seen != home, "curves do not zoom by mouse")
        mates = f"new Set({charts}.filter(c => c.dataset.group === {charts}[0].dataset.group).map(c => c.dataset.from)).size"
        self.need(page.value(mates) == 1, "the curves of a record do not zoom together")
        self.need(page.value(f'{charts}[0].dataset.sample !== ""'), "no sample is shown")
        page.value(f"{charts}[0].focus()")
        page.key("0")
        self.need(page.value(field) == home, "0 does not show all")
        page.key("+")
        self.need(page.value(field) != home, "curves do not zoom by keyboard")
        page.key("0")
        before = page.value(f"{charts}[0].dataset.sample")
        page.key("ArrowRight")
        self.need(page.value(f"{charts}[0].dataset.sample") != before, "the cursor does not move by keyboard")

    def turn(self, page):
        count = page.value('document.querySelectorAll("figure.scene").length')
        for k in range(count):
            figure = f'document.querySelectorAll("figure.scene")[{k}]'
            page.value(
                f"""(() => {{ const d = {figure}.closest("details"); if (d) d.open = true;
                {figure}.scrollIntoView({{ behavior: "instant" }}); }})()"""
            )
            canvas = f'{figure}.querySelector(".stage canvas")'
            page.settle()
            self.need(page.value(f"!!{canvas}"), f"picture {k} is not live")
            if not page.value(f"!!{canvas}"):
                continue
            page.settle()
            start = self.middle(page, canvas, (0.5, 0.5))
            pixels = f"{canvas}.toDataURL()"
            page.settle()
            first = page.value(pixels)
            self.need(len(first) > 5000, f"picture {k} is empty")
            page.settle()
            self.need(page.value(pixels) == first, f"picture {k} moves by itself")
            page.drag(start, [start[0] + 90, start[1] + 40])
            turned = page.value(pixels)
            self.need(turned != first, f"picture {k} does not turn by mouse")
            page.touch(start, [start[0] + 60, start[1]])
            touched = page.value(pixels)
            self.need(touched != turned, f"picture {k} does not turn by touch")
            page.value(f"{canvas}.focus()")
            page.key("ArrowLeft")
            self.need(page.value(pixels) != touched, f"picture {k} does not turn by keyboard")
        if page.value('!!document.querySelector(".controls input")'):
            shared = '[...document.querySelectorAll(".canvas")].map(c => c.dataset.sample || "").join()'
            samples = page.value(shared)
            canvas = 'document.querySelector(".controls input").closest("figure").querySelector(".stage canvas")'
            before = page.value(f"{canvas}.toDataURL()")
            page.value(
                """(() => { const i = document.querySelector(".controls input"); i.value = Math.floor(i.max * 0.2);
                i.dispatchEvent(new Event("input")); })()"""
            )
            page.settle()
            after = page.value(f"{canvas}.toDataURL()")
            self.need(before != after, "the scrubber does not move the picture")
            self.need(page.value(shared) != samples, "the scrubber does not move the cursor of the curves")
        page.value('[...document.querySelectorAll("button")].filter(b => b.textContent === "reset").forEach(b => b.click())')

    def turns_by_itself(self):
        """Where motion is not to be reduced, the first picture on view turns, and stops when it is touched."""
        page = self.browser.open(self.file.as_uri(), *SCREEN, still=False)
        canvas = 'document.querySelector("figure.scene .stage canvas")'
        if not page.value(f"!!{canvas}"):
            return True
        place = self.middle(page, canvas, (0.5, 0.5))
        shots = []
        for touched in (False, True):
            for _ in range(2):
                page.value("new Promise(r => setTimeout(r, 400))")
                page.settle()
                shots.append(page.value(f"{canvas}.toDataURL()"))
            if not touched:
                page.drag(place, [place[0] + 30, place[1]])
        page.close()
        return shots[0] != shots[1] and shots[2] == shots[3]

    def words(self, page):
        wordless = page.value(WORDLESS)
        self.need(not wordless, f"pictures without words: {wordless}")
        unreachable = page.value(UNREACHABLE)
        self.need(not unreachable, f"not for the keyboard: {unreachable}")
        self.need(not page.value(DEAD), f"links lead nowhere: {page.value(DEAD)}")
        levels = [h[0] for h in page.value(HEADINGS)]
        self.need(levels.count(1) == 1 and levels[0] == 1, f"headings of the first level: {levels.count(1)}")
        steps = [b - a for a, b in zip(levels, levels[1:])]
        self.need(max(steps, default=0) <= 1, "a level of headings is skipped")
        self.need(page.value("document.documentElement.lang") == "en", "the page does not say its language")
        self.need(page.value('!!document.querySelector("main") && !!document.querySelector("nav[aria-label]")'), "no landmarks")

    def paper(self, page):
        sections = [text for level, text in page.value(HEADINGS) if level == 2]
        self.need(sections and sections[0] == "Answer", f"the first section is {sections[:1]}")
        pdf = page.pdf()
        (self.folder / "report.pdf").write_bytes(pdf)
        titles = outline(pdf)
        lost = [s for s in sections if s not in titles]
        self.need(not lost, f"not in the PDF: {lost}")


def outline(pdf):
    """Titles of the outline of a PDF: literal strings, or UTF-16 where they begin with its mark."""
    titles = []
    for raw in re.findall(rb"/Title\s*\(((?:\\.|[^\\()])*)\)", pdf, re.DOTALL):
        text = re.sub(rb"\\([0-7]{3})", lambda m: bytes([int(m[1], 8)]), raw)
        text = re.sub(rb"\\(.)", lambda m: m[1], text, flags=re.DOTALL)
        titles.append(text[2:].decode("utf-16-be", "replace") if text[:2] == b"\xfe\xff" else text.decode("latin-1"))
    for raw in re.findall(rb"/Title\s*<([0-9A-Fa-f\s]*)>", pdf):
        text = bytes.fromhex(raw.decode())
        titles.append(text[2:].decode("utf-16-be", "replace") if text[:2] == b"\xfe\xff" else text.decode("latin-1"))
    return titles


def book(browser):
    """Every page of the built book: nothing from a network, nothing on the console."""
    folder = ROOT / "target/book"
    faults = []
    pages = sorted(p for p in folder.rglob("*.html") if p.name not in ("print.html", "toc.html", "404.html"))
    for file in pages:
        page = browser.open(file.as_uri())
        page.settle()
        strangers = [r for r in page.requests() if not r.startswith("file:")]
        for found in strangers + page.complaints():
            faults.append(f"{file.relative_to(folder)}: {found}")
    print(f"book: {'good' if not faults else 'FAULTS'}; {len(pages)} pages")
    for fault in faults:
        print(f"    {fault}")
    return not faults


def fetch_axe():
    """axe-core of the pinned version from npm, once, into target/axe."""
    package = AXE.parent / "package.json"
    if package.is_file() and json.loads(package.read_text())["version"] == AXE_VERSION:
        return
    npm = shutil.which("npm")
    folder = AXE.parent.parent
    folder.mkdir(parents=True, exist_ok=True)
    command = [npm, "pack", "--silent", f"axe-core@{AXE_VERSION}"]
    if not npm or subprocess.run(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False).returncode:
        print(f"axe-core skipped: npm does not give axe-core {AXE_VERSION} (Debian: apt-get install npm, and a network)")
        return
    shutil.unpack_archive(folder / f"axe-core-{AXE_VERSION}.tgz", folder, filter="data")


def look(browser, name, file, renew):
    """The screens of one report against its references, or anew."""
    good, words = True, []
    for view in screens.VIEWS:
        found, path = screens.cells(browser, file, view), screens.reference(name, view)
        if renew:
            screens.write(path, found)
            continue
        gap = screens.difference(found, screens.read(path)) if path.is_file() else float("inf")
        words.append(f"{view} {gap:.2f}")
        if gap > screens.TOLERANCE:
            good = False
            screens.write(file.parent / path.name, found)
    if renew:
        page = browser.open(file.as_uri(), *SCREEN)
        page.settle()
        THUMBNAILS.mkdir(parents=True, exist_ok=True)
        box = {"x": 0, "y": 0, "width": SCREEN[0], "height": SCREEN[1]}
        (THUMBNAILS / f"{name}.png").write_bytes(page.picture(box, THUMBNAIL))
        if name == SHOWN[0]:
            SHOWN[1].write_bytes(page.picture(box, SHOWN[2]))
        return True
    print(f"    screens {'as kept' if good else 'DIFFER'}: {', '.join(words)} of {screens.TOLERANCE} levels", flush=True)
    return good


def planted(browser, name, file):
    """Whether the comparison sees a page without its lights."""
    gap = screens.difference(screens.cells(browser, file, "desktop", planted=True), screens.read(screens.reference(name, "desktop")))
    seen = gap > screens.TOLERANCE
    print(f"planted change (lights hidden in {name}): {'found' if seen else 'MISSED'}, {gap:.2f} of {screens.TOLERANCE} levels")
    return seen


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--poinsot", default="target/release/poinsot", help="program to use; scripts/browser-test builds the default")
    parser.add_argument("--renew", action="store_true", help="write the references instead of comparing")
    parser.add_argument("folders", nargs="*", help="folders with a report.html; default: the gallery")
    arguments = parser.parse_args()
    program = chromium.find()
    if not program:
        print("browser test skipped: no Chromium (apt-get install chromium, or set POINSOT_CHROMIUM)")
        return
    fetch_axe()
    own = not arguments.folders
    if own:
        files = gallery.gallery(arguments.poinsot)
    else:
        files = {Path(f).name: Path(f).resolve() / "report.html" for f in arguments.folders}
    begun = time.monotonic()
    good = True
    for name, file in files.items():
        # A fresh browser each: one that fell would take the others with it.
        with chromium.Browser(program) as browser:
            if not arguments.renew:
                good = Check(browser, name, file, LARGEST if own else LARGEST_OF_ANY).run() and good
            good = (not own or look(browser, name, file, arguments.renew)) and good
            if own and not arguments.renew and name == next(iter(files)):
                good = planted(browser, name, file) and good
    if own and (ROOT / "target/book/index.html").is_file():
        with chromium.Browser(program) as browser:
            good = book(browser) and good
    print(f"browser test {'passed' if good else 'FAILED'} in {time.monotonic() - begun:.0f} s; pictures beside the reports")
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
