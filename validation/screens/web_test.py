#!/usr/bin/env python3
"""Uses target/web/poinsot.html in headless Chromium, from file:// and without a network, as a visitor would.

Each example: the verdict, the exit code and every null are those of the command, and the numbers within 0.01 sigma; the page
of the report shows them. A broken file and a broken model: the codes and lines of the command. A file of 50 MB: the page
answers while it is read, and the run can be cancelled. 100,000 rows: an answer, and its time. No request, nothing on the console,
no violation found by axe-core, contrast in light and dark. The page holds the licences of its parts. Screens lie in target/web.

    scripts/web && python3 validation/screens/web_test.py [--poinsot PATH] [--quick]     # quick: without the 100,000 rows

POINSOT_CHROMIUM   the browser, if it is not on the path
"""

import argparse
import base64
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import browser_test
import chromium

ROOT = Path(__file__).resolve().parents[2]
OUT = ROOT / "target/web"
PAGE = OUT / "poinsot.html"
SCREEN = (1400, 900)
PHONE = (390, 844)
# The numbers of an example agree within this share of their sigma.
SIGMAS = 0.01
# Most seconds for 100,000 rows, and for the page to answer while it works.
ROWS_S = 20.0
ANSWERS_S = 1.0
MODEL, CASE = "data/stsat3/model.toml", "data/cases/stsat3_three_slews.toml"


class Visit:
    """The page in a tab without a network."""

    def __init__(self, browser, size=SCREEN, dark=False):
        self.page = browser.open(PAGE.as_uri(), *size, dark=dark)
        self.page.call("Network.emulateNetworkConditions", offline=True, latency=0, downloadThroughput=-1, uploadThroughput=-1)

    def at(self, name, what="textContent"):
        return self.page.value(f"document.getElementById({name!r}).{what}")

    def click(self, name):
        self.page.value(f"document.getElementById({name!r}).click()")

    def until(self, script, seconds=600.0):
        """Waits for a condition; gives the longest time that the page took to answer."""
        begun, slowest = time.monotonic(), 0.0
        while True:
            asked = time.monotonic()
            if self.page.value(script):
                return slowest
            slowest = max(slowest, time.monotonic() - asked)
            if asked - begun > seconds:
                raise TimeoutError(f"{script}: not within {seconds:.0f} s; the page says {self.at('said')!r}")
            time.sleep(0.02)

    def checked(self):
        self.until("document.getElementById('checked').textContent !== ''")
        return self.at("checked")

    def example(self, number):
        self.page.value(f"document.querySelectorAll('.cards button')[{number}].click()")
        self.until("!document.getElementById('run').disabled")
        self.checked()

    def files(self, *paths):
        """Chooses files of the disk."""
        self.page.value("[...document.querySelectorAll('#files button')].forEach(b => b.click())")
        node = self.page.call("DOM.getDocument")["root"]["nodeId"]
        node = self.page.call("DOM.querySelector", nodeId=node, selector="#choose")["nodeId"]
        self.page.call("DOM.setFileInputFiles", nodeId=node, files=[str(p) for p in paths])
        self.until(f"document.querySelectorAll('#files li').length === {sum(p.suffix != '.toml' for p in paths)}")

    def write(self, text):
        """Types a model."""
        self.page.value("document.getElementById('checked').textContent = ''")
        self.page.value(f"{{ const m = document.getElementById('model'); m.value = {json.dumps(text)}; m.dispatchEvent(new Event('input')); }}")
        return self.checked()

    def run(self):
        """Identifies; gives the seconds, or the errors."""
        self.click("run")
        self.until("document.getElementById('cancel').hidden")
        if self.at("answer", "hidden"):
            return self.page.value("[...document.querySelectorAll('#refused li')].map(e => e.textContent)")
        return float(self.at("answer", "dataset.seconds"))

    def processor_s(self):
        """Processor time of all pages so far."""
        of = self.page.browser.call("SystemInfo.getProcessInfo")["processInfo"]
        return sum(p["cpuTime"] for p in of if p["type"] == "renderer")

    def saved(self):
        """The files that the buttons save, by name."""
        return self.page.value(
            """(async () => { const held = [], make = URL.createObjectURL, files = {};
            URL.createObjectURL = blob => { held.push(blob); return make(blob); };
            for (const b of document.querySelectorAll('#save button')) b.click();
            URL.createObjectURL = make;
            for (const [k, b] of [...document.querySelectorAll('#save button')].entries())
              files[b.textContent.replace('Save ', '')] = await held[k].text();
            return files; })()"""
        )

    def screen(self, name):
        """What the window shows: a picture of the whole page has no frames."""
        self.page.settle()
        made = self.page.call("Page.captureScreenshot", format="png")
        (OUT / f"{name}.png").write_bytes(base64.b64decode(made["data"]))


class Test:
    def __init__(self, poinsot):
        self.poinsot = poinsot
        self.faults = 0

    def need(self, holds, what):
        if not holds:
            self.faults += 1
            print(f"    FAULT: {what}", flush=True)

    def command(self, *words):
        begun = time.monotonic()
        ran = subprocess.run([self.poinsot, *words], cwd=ROOT, capture_output=True, text=True, check=False)
        return ran, time.monotonic() - begun

    def example(self, visit, number, shipped):
        """One example against the command."""
        visit.example(number)
        seconds = visit.run()
        if not isinstance(seconds, float):
            return self.need(False, f"{shipped['title']}: {seconds}")
        files = visit.saved()
        page = json.loads(files["estimate.json"])
        with tempfile.TemporaryDirectory() as folder:
            ran, took = self.command(
                "identify", "--model", shipped["model"]["name"], "--telemetry", shipped["telemetry"]["name"], "--out", folder
            )
            command = json.loads((Path(folder) / "estimate.json").read_text())
        gap, count = compared(page, command)
        verdict = ran.stdout.splitlines()[0]
        printed = ran.stdout.split("\n\n")[:-1]
        same = visit.at("printed").strip().startswith("\n\n".join(printed).strip())
        print(
            f"{shipped['title']}: {seconds:.1f} s in the page, {took:.1f} s by the command; {count} numbers within {gap:.1g} sigma, "
            f"printed text {'equal' if same else 'differs in digits'}",
            flush=True,
        )
        self.need(gap < SIGMAS, f"a number is {gap:.3g} sigma off")
        self.need(visit.at("verdict") == verdict, f"the page says {visit.at('verdict')!r}, the command {verdict!r}")
        self.need(page["status"] == command["status"], "the status differs")
        self.need([i for i in page["inputs"]] == [i for i in command["inputs"]], "the inputs differ, or their hashes")
        self.need("Mass properties of" in files["report.html"], "the report is no page")
        self.need(visit.at("report", "srcdoc") == files["report.html"], "the report is not shown")

    def refused(self, visit, folder):
        """Broken files and models: codes and lines of the command."""
        text = (ROOT / "data/stsat3/paper/telemetry_noisy.csv").read_text().splitlines()
        text[100] = text[100].replace(text[100].split(",")[1], "12..5", 1)
        whole = (ROOT / "data/xu2017/C1/telemetry_noisy.parquet").read_bytes()
        broken = {"cell.csv": "\n".join(text).encode(), "cut.parquet": whole[: len(whole) // 2], "none.csv": b"", "noise.csv": whole[4:4000]}
        visit.write((ROOT / MODEL).read_text())
        for name, content in broken.items():
            path = folder / name
            path.write_bytes(content)
            visit.files(path)
            found = visit.run()
            ran, _ = self.command("identify", "--model", MODEL, "--telemetry", str(path))
            expected = ran.stderr.strip().replace("error: ", "").replace(str(path), name).splitlines()
            print(f"broken file {name}: {found}")
            self.need(found and found[0][:5] == expected[0][:5], f"the command says {expected}")
        model = (ROOT / MODEL).read_text().replace("mass_kg", "mass_lb")
        (folder / "wrong.toml").write_text(model)
        said = visit.write(model)
        lines = visit.page.value("[...document.querySelectorAll('#wrong button')].map(b => b.textContent)")
        marks = visit.page.value("document.querySelectorAll('#gutter i').length")
        ran, _ = self.command("check", str(folder / "wrong.toml"))
        print(f"broken model: {said}, {lines}")
        first = next(k for k, line in enumerate(model.splitlines(), 1) if "mass_lb" in line)
        self.need(f"Line {first}" in lines and marks == len(lines), f"no mark at line {first}")
        self.need(f":{first}:" in ran.stderr and len(lines) == ran.stderr.count("E01"), f"the command says {ran.stderr}")
        visit.screen("errors")

    def large(self, visit, folder):
        """50 MB: the page answers while it works, and a run is cancelled."""
        path = self.simulated(folder, "large", 750.0)
        visit.write((ROOT / MODEL).read_text())
        visit.files(path)
        begun = time.monotonic()
        visit.click("run")
        slowest = visit.until("/fit/.test(document.getElementById('said').textContent) || document.getElementById('cancel').hidden")
        read = time.monotonic() - begun
        visit.click("cancel")
        visit.until("document.getElementById('cancel').hidden")
        print(f"{path.stat().st_size / 1e6:.0f} MB: read and checked in {read:.1f} s, answers within {slowest:.2f} s; {visit.at('said')!r}", flush=True)
        self.need(path.stat().st_size > 50e6, "the file is smaller than 50 MB")
        self.need(slowest < ANSWERS_S, "the page stands still")
        self.need(visit.at("said") == "Cancelled.", f"the page says {visit.at('said')!r}")

    def rows(self, visit, folder):
        """100,000 rows within 20 s of processor time, which is the time of a free core."""
        path = self.simulated(folder, "rows", 100_000 / 350.0)
        visit.write((ROOT / MODEL).read_text())
        visit.files(path)
        before = visit.processor_s()
        seconds = visit.run()
        used = visit.processor_s() - before
        _, took = self.command("identify", "--model", MODEL, "--telemetry", str(path))
        print(
            f"100,000 rows ({path.stat().st_size / 1e6:.0f} MB): {seconds} s in the page, {used:.1f} s of processor time; "
            f"{took:.1f} s by the command",
            flush=True,
        )
        self.need(isinstance(seconds, float) and min(seconds, used) < ROWS_S, f"more than {ROWS_S:.0f} s")

    def simulated(self, folder, name, rate_hz):
        case = (ROOT / CASE).read_text().replace("rate_hz = 10", f"rate_hz = {rate_hz!r}")
        (folder / f"{name}.toml").write_text(case.replace("stsat3_truth.toml", str(ROOT / "data/cases/stsat3_truth.toml")))
        ran, _ = self.command("simulate", str(folder / f"{name}.toml"), "--out", str(folder / name))
        if ran.returncode:
            raise RuntimeError(ran.stderr)
        return folder / name / "telemetry.csv"

    def looks(self, browser):
        """Accessibility, contrast, width; with an answer on the page."""
        for name, size, dark in [("light", SCREEN, False), ("dark", SCREEN, True), ("phone", PHONE, False)]:
            visit = Visit(browser, size, dark)
            visit.example(1)
            visit.screen(f"{name}_inputs")
            seconds = visit.run()
            visit.page.value("document.getElementById('verdict').scrollIntoView({ behavior: 'instant' })")
            visit.page.value("new Promise(r => setTimeout(r, 1500))")
            visit.screen(f"{name}_answer")
            page = visit.page
            self.need(isinstance(seconds, float), f"{name}: no answer, {seconds}")
            self.need(not page.value(browser_test.CONTRAST), f"{name}: contrast {page.value(browser_test.CONTRAST)}")
            self.need(page.value("document.documentElement.scrollWidth") <= size[0], f"{name}: wider than the screen")
            found = axe(page)
            print(f"{name}: axe {found if found is not None else 'not run'}; {len(page.complaints())} messages, {len(page.requests())} requests")
            self.need(not found, f"{name}: axe {found}")
            self.need(not page.complaints() and not page.requests(), f"{name}: {page.complaints()} {page.requests()}")


def axe(page):
    """Violations found by axe-core, without the frame, which is a report and has its own test; None where it is not there."""
    if not browser_test.AXE.is_file():
        return None
    page.value("document.querySelectorAll('details').forEach(d => { d.open = true; }); 0")
    page.value(browser_test.AXE.read_text() + "; 0")
    return page.value(
        """axe.run({ exclude: [["iframe"]] }, { resultTypes: ["violations"], iframes: false }).then(r => r.violations.map(v =>
        v.id + ": " + v.nodes[0].html.slice(0, 90)))"""
    )


def compared(page, command, gap=0.0, count=0):
    """Largest difference over sigma of all numbers with a sigma, at the same places; and how many there are."""
    if isinstance(command, dict):
        if page.keys() != command.keys():
            raise ValueError(f"keys differ: {page.keys() ^ command.keys()}")
        sigma = command.get("sigma")
        if sigma and isinstance(command.get("value"), float):
            off = [abs(page[k] - command[k]) / sigma for k in ("value", "sigma")]
            gap, count = max(gap, *off), count + 1
        elif "value" in command and (page["value"] is None) != (command["value"] is None):
            raise ValueError(f"{page} and {command}")
        pairs = [(page[k], command[k]) for k in command]
    elif isinstance(command, list):
        pairs = list(zip(page, command)) if len(page) == len(command) else []
    else:
        return gap, count
    for one, other in pairs:
        gap, count = compared(one, other, gap, count)
    return gap, count


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--poinsot", default=str(ROOT / "target/release/poinsot"), help="the command to compare with")
    parser.add_argument("--quick", action="store_true", help="without the 100,000 rows")
    arguments = parser.parse_args()
    program = chromium.find()
    if not program:
        print("web test skipped: no Chromium (apt-get install chromium, or set POINSOT_CHROMIUM)")
        return
    browser_test.fetch_axe()
    begun = time.monotonic()
    test = Test(str(Path(arguments.poinsot).resolve()))
    with tempfile.TemporaryDirectory() as folder, chromium.Browser(program, patience=600.0) as browser:
        visit = Visit(browser)
        for number, shipped in enumerate(json.loads(visit.at("shipped"))):
            test.example(visit, number, shipped)
        test.refused(visit, Path(folder))
        test.large(visit, Path(folder))
        if not arguments.quick:
            test.rows(visit, Path(folder))
        test.need("Copyright (c) 2022 Leon Sorokin" in visit.page.value("document.querySelector('footer').textContent"), "no licence of uPlot")
        test.need(not visit.page.complaints(), f"the console says {visit.page.complaints()}")
        test.need(not visit.page.requests(), f"asked for {visit.page.requests()}")
        test.looks(browser)
    print(f"web test {'FAILED' if test.faults else 'passed'} in {time.monotonic() - begun:.0f} s; screens in {OUT.relative_to(ROOT)}")
    sys.exit(test.faults > 0)


if __name__ == "__main__":
    main()
