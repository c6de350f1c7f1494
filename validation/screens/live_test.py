#!/usr/bin/env python3
"""Uses the page of `poinsot follow --serve` in headless Chromium while rows arrive, as somebody beside a test bench would.

The curves grow as lines arrive; a connection that drops comes back and no line is missing; a browser that does not read holds nothing up;
names are text and not markup; nothing is asked of another computer; no violation found by axe-core. A screen lies in target/web.

    python3 validation/screens/live_test.py [--poinsot PATH]

POINSOT_CHROMIUM   the browser, if it is not on the path
"""

import argparse
import json
import re
import socket
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import browser_test
import chromium

ROOT = Path(__file__).resolve().parents[2]
OUT = ROOT / "target/web"
CASE, MODEL = ROOT / "data/cases/pyramid.toml", ROOT / "data/cases/pyramid_truth.toml"
NAME = "<img src=x onerror=document.title='taken'>"


class Proxy:
    """Connections to a port of this computer, which can be cut."""

    def __init__(self, port):
        self.port, self.pairs = port, []
        self.listening = socket.create_server(("127.0.0.1", 0))
        self.own = self.listening.getsockname()[1]
        threading.Thread(target=self.accept, daemon=True).start()

    def accept(self):
        while True:
            try:
                one, _ = self.listening.accept()
                other = socket.create_connection(("127.0.0.1", self.port))
            except OSError:
                return
            self.pairs.append((one, other))
            for a, b in [(one, other), (other, one)]:
                threading.Thread(target=self.carry, args=(a, b), daemon=True).start()

    @staticmethod
    def carry(a, b):
        try:
            while piece := a.recv(1 << 16):
                b.sendall(piece)
            b.shutdown(socket.SHUT_WR)
        except OSError:
            pass

    def cut(self):
        for pair in self.pairs:
            for end in pair:
                try:
                    end.shutdown(socket.SHUT_RDWR)
                except OSError:
                    pass
        self.pairs.clear()


class Test:
    def __init__(self, poinsot, folder):
        self.poinsot, self.folder, self.faults = poinsot, Path(folder), 0
        subprocess.run([poinsot, "simulate", CASE, "--out", self.folder / "flight", "--quiet"], check=True, capture_output=True)
        self.rows = (self.folder / "flight/telemetry.csv").read_text().splitlines(keepends=True)
        model = re.sub(r'(?m)^name = ".*"', f'name = "{NAME}"', MODEL.read_text(), count=1)
        (self.folder / "model.toml").write_text(model)

    def need(self, holds, what):
        if not holds:
            self.faults += 1
            print(f"    FAULT: {what}", flush=True)

    def run(self, browser):
        log = (self.folder / "log").open("w")
        command = [self.poinsot, "follow", self.folder / "model.toml", "--serve", "127.0.0.1:0", "--certify", "30", "--line-s", "0.5"]
        follow = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=log, text=True)
        printed = []
        reader = threading.Thread(target=lambda: printed.extend(follow.stdout), daemon=True)
        reader.start()
        try:
            self.give(follow, self.rows[:350])
            port = self.port()
            deaf = socket.create_connection(("127.0.0.1", port))
            deaf.sendall(b"GET /events HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n")
            proxy = Proxy(port)
            page = browser.open(f"http://127.0.0.1:{proxy.own}/", 1200, 900)
            self.until(page, "document.getElementById('live').dataset.points > 0")
            first = self.points(page)
            self.give(follow, self.rows[350:450])
            self.until(page, f"document.getElementById('live').dataset.points > {first + 20}")
            proxy.cut()
            self.until(page, "document.getElementById('live').dataset.state === 'reconnecting'")
            self.give(follow, self.rows[450:550])
            self.until(page, "document.getElementById('live').dataset.state === 'connected'")
            self.need(self.points(page) >= first + 20, "points are lost")
            self.looks(page)
            self.give(follow, self.rows[550:])
            begun = time.monotonic()
            follow.stdin.close()
            follow.wait(60)
            took = time.monotonic() - begun
            reader.join(10)
            self.until(page, "document.getElementById('live').dataset.state === 'ended'")
            lines = [json.loads(line) for line in printed]
            known = sum(line["numbers"]["bus.inertia_kg_m2.zz"]["value"] is not None for line in lines)
            certified = page.value("document.getElementById('certified').textContent")
            print(f"{len(lines)} lines, {known} with values, {self.points(page)} points on the page; ended in {took:.1f} s: {certified}")
            self.need(self.points(page) == known, "lines are missing on the page")
            self.need(follow.returncode == 0, f"exit code {follow.returncode}")
            self.need("Determined" in certified, "no verdict of all rows")
            self.need(page.value("document.title") == f"{NAME}, live" and not page.value("document.images.length"), "a name became markup")
            far = [a for a in page.requests() if not a.startswith(f"http://127.0.0.1:{proxy.own}/")]
            self.need(not far, f"asked for {far}")
            deaf.close()
        finally:
            follow.kill()
            follow.wait()

    def give(self, follow, rows):
        follow.stdin.write("".join(rows))
        follow.stdin.flush()

    def port(self):
        until = time.monotonic() + 30
        while time.monotonic() < until:
            found = re.search(r"http://127\.0\.0\.1:(\d+)/", (self.folder / "log").read_text())
            if found:
                return int(found[1])
            time.sleep(0.05)
        raise TimeoutError("no address was printed")

    @staticmethod
    def points(page):
        return int(page.value("document.getElementById('live').dataset.points || 0"))

    @staticmethod
    def until(page, script, seconds=60.0):
        begun = time.monotonic()
        while not page.value(script):
            if time.monotonic() - begun > seconds:
                raise TimeoutError(f"{script}: not within {seconds:.0f} s")
            time.sleep(0.05)

    def looks(self, page):
        OUT.mkdir(parents=True, exist_ok=True)
        page.settle()
        (OUT / "live.png").write_bytes(page.picture())
        self.need(not page.value(browser_test.CONTRAST), f"contrast {page.value(browser_test.CONTRAST)}")
        if not browser_test.AXE.is_file():
            return print("axe not run")
        page.value(browser_test.AXE.read_text() + "; 0")
        found = page.value("axe.run({ resultTypes: ['violations'] }).then(r => r.violations.map(v => v.id + ': ' + v.nodes[0].html.slice(0, 90)))")
        print(f"axe {found}")
        self.need(not found, f"axe {found}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--poinsot", default=str(ROOT / "target/release/poinsot"))
    arguments = parser.parse_args()
    program = chromium.find()
    if not program:
        print("live test skipped: no Chromium (apt-get install chromium, or set POINSOT_CHROMIUM)")
        return
    browser_test.fetch_axe()
    begun = time.monotonic()
    with tempfile.TemporaryDirectory() as folder, chromium.Browser(program) as browser:
        test = Test(str(Path(arguments.poinsot).resolve()), folder)
        test.run(browser)
    print(f"live test {'FAILED' if test.faults else 'passed'} in {time.monotonic() - begun:.0f} s; screen in {OUT.relative_to(ROOT)}")
    sys.exit(test.faults > 0)


if __name__ == "__main__":
    main()
