"""Chromium through its DevTools protocol over a pipe: the standard library is enough, no port is opened.

    with Browser(program) as browser:
        page = browser.open("file:///.../report.html")
        page.value("document.title")
"""

import base64
import fcntl
import json
import os
import select
import shutil
import subprocess
import tempfile
import time

FLAGS = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-dev-shm-usage",
    "--hide-scrollbars",
    # WebGL2 without a graphics card.
    "--enable-unsafe-swiftshader",
    "--remote-debugging-pipe",
]


def find():
    """The browser: POINSOT_CHROMIUM, or the first on the path; None where there is none."""
    names = ["chromium", "chromium-browser", "google-chrome"]
    return os.environ.get("POINSOT_CHROMIUM") or next(filter(None, map(shutil.which, names)), None)


class Browser:
    """A headless browser with an empty profile."""

    def __init__(self, program, patience=120.0):
        self.patience = patience
        self.profile = tempfile.mkdtemp(prefix="poinsot-browser-")
        to_browser, self.out = os.pipe()
        self.into, from_browser = os.pipe()

        def wire():
            # The protocol wants its ends at 3 and 4; out of the way first, should one of ours stand there.
            read, write = (fcntl.fcntl(f, fcntl.F_DUPFD, 10) for f in (to_browser, from_browser))
            os.dup2(read, 3, inheritable=True)
            os.dup2(write, 4, inheritable=True)

        command = [program, *FLAGS, f"--user-data-dir={self.profile}", "about:blank"]
        self.process = subprocess.Popen(
            command, close_fds=False, preexec_fn=wire, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        os.close(to_browser)
        os.close(from_browser)
        self.buffer = b""
        self.number = 0
        self.events = []

    def __enter__(self):
        return self

    def __exit__(self, *_):
        try:
            self.call("Browser.close")
        except (OSError, RuntimeError, TimeoutError):
            self.process.kill()
        try:
            self.process.wait(20)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        os.close(self.out)
        os.close(self.into)
        shutil.rmtree(self.profile, ignore_errors=True)

    def call(self, method, session=None, **parameters):
        """Sends a command and waits for its answer; events that come meanwhile are kept."""
        self.number += 1
        number = self.number
        message = {"id": number, "method": method, "params": parameters}
        if session:
            message["sessionId"] = session
        text = json.dumps(message).encode() + b"\0"
        while text:
            text = text[os.write(self.out, text):]
        until = time.monotonic() + self.patience
        while True:
            answer = self.receive(until)
            if answer.get("id") == number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']['message']}")
                return answer["result"]
            self.events.append(answer)

    def receive(self, until):
        """The next message."""
        while b"\0" not in self.buffer:
            ready, _, _ = select.select([self.into], [], [], max(0.0, until - time.monotonic()))
            if not ready:
                raise TimeoutError("the browser does not answer")
            piece = os.read(self.into, 1 << 20)
            if not piece:
                raise RuntimeError("the browser has ended")
            self.buffer += piece
        text, self.buffer = self.buffer.split(b"\0", 1)
        return json.loads(text)

    def open(self, address, width=1200, height=900, dark=False, still=True):
        """A page, loaded; nothing moves by itself where it is to be still."""
        return Page(self, address, width, height, dark, still)


class Page:
    """One tab."""

    def __init__(self, browser, address, width, height, dark, still):
        self.browser = browser
        self.address = address
        self.target = browser.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = browser.call("Target.attachToTarget", targetId=self.target, flatten=True)["sessionId"]
        for domain in ["Page", "Runtime", "Network", "Log", "DOM", "CSS"]:
            self.call(f"{domain}.enable")
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        features = [
            {"name": "prefers-color-scheme", "value": "dark" if dark else "light"},
            {"name": "prefers-reduced-motion", "value": "reduce" if still else "no-preference"},
        ]
        self.call("Emulation.setEmulatedMedia", features=features)
        browser.events.clear()
        begun = time.monotonic()
        self.call("Page.navigate", url=address)
        self.wait("Page.loadEventFired")
        self.loaded_s = time.monotonic() - begun

    def call(self, method, **parameters):
        return self.browser.call(method, self.session, **parameters)

    def wait(self, event):
        until = time.monotonic() + self.browser.patience
        while not any(e.get("method") == event for e in self.browser.events):
            self.browser.events.append(self.browser.receive(until))

    def value(self, script):
        """What a script gives; its promise is awaited."""
        answer = self.call("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(f"{script}: {answer['exceptionDetails'].get('exception', {}).get('description')}")
        return answer["result"].get("value")

    def settle(self):
        """Two frames: what was drawn is on the screen."""
        self.value("new Promise(r => requestAnimationFrame(() => requestAnimationFrame(() => r(1))))")

    def style(self, rules):
        """Adds rules to the page as its maker could; its policy does not hold for them."""
        made = self.call("CSS.createStyleSheet", frameId=self.call("Page.getFrameTree")["frameTree"]["frame"]["id"])
        self.call("CSS.setStyleSheetText", styleSheetId=made["styleSheetId"], text=rules)

    def close(self):
        self.browser.call("Target.closeTarget", targetId=self.target)

    def drag(self, start, end):
        """Presses, moves in steps, lets go."""
        self.mouse("mousePressed", start)
        for k in range(1, 6):
            between = [a + (b - a) * k / 5 for a, b in zip(start, end)]
            self.mouse("mouseMoved", between)
        self.mouse("mouseReleased", end)
        self.settle()

    def mouse(self, kind, at, clicks=1):
        self.call(
            "Input.dispatchMouseEvent", type=kind, x=at[0], y=at[1], button="left", buttons=1, clickCount=clicks
        )

    def touch(self, start, end):
        """One finger: down, along, up."""
        along = [[a + (b - a) * k / 5 for a, b in zip(start, end)] for k in range(6)]
        for k, (x, y) in enumerate(along):
            kind = "touchMove" if k else "touchStart"
            self.call("Input.dispatchTouchEvent", type=kind, touchPoints=[{"x": x, "y": y}])
        self.call("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])
        self.settle()

    def key(self, key):
        text = {"text": key} if len(key) == 1 else {}
        for kind in ["keyDown", "keyUp"]:
            self.call("Input.dispatchKeyEvent", type=kind, key=key, **(text if kind == "keyDown" else {}))
        self.settle()

    def picture(self, box=None, scale=1):
        """PNG of the whole page, or of a box on it."""
        clip = {"clip": {**box, "scale": scale}} if box else {}
        made = self.call("Page.captureScreenshot", format="png", captureBeyondViewport=True, **clip)
        return base64.b64decode(made["data"])

    def pdf(self):
        """The page as printed, with an outline of its headings."""
        made = self.call(
            "Page.printToPDF", printBackground=True, preferCSSPageSize=True, generateTaggedPDF=True,
            generateDocumentOutline=True,
        )
        return base64.b64decode(made["data"])

    def complaints(self):
        """What the console and the log say."""
        said = []
        for event in self.browser.events:
            what, given = event.get("method"), event.get("params", {})
            if what == "Runtime.consoleAPICalled":
                said.append(" ".join(str(a.get("value", a.get("description"))) for a in given["args"]))
            elif what == "Runtime.exceptionThrown":
                said.append(given["exceptionDetails"].get("exception", {}).get("description", "exception"))
            elif what == "Log.entryAdded":
                said.append(given["entry"]["text"])
        # Taking a picture of WebGL reads it back, which the driver notes.
        return [s for s in said if "due to ReadPixels" not in s]

    def requests(self):
        """Addresses asked for, beside the page itself and what stands in it."""
        asked = [
            e["params"]["request"]["url"] for e in self.browser.events if e.get("method") == "Network.requestWillBeSent"
        ]
        return [a for a in asked if a != self.address and not a.startswith(("data:", "blob:"))]
