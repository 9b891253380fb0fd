"""A real browser without a window, driven over the WebDriver protocol."""

from __future__ import annotations

import json
import shutil
import socket
import subprocess
import time
import urllib.error
import urllib.request

BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
DRIVER = shutil.which("chromedriver")

OPTIONS = (
    "--headless=new",
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
)

LOOK = """
const root = document.documentElement;
return {
  images: [...document.images].map((image) => [image.alt, image.naturalWidth]),
  links: [...document.querySelectorAll("a[href]")].map((a) => a.getAttribute("href")),
  ids: [...document.querySelectorAll("[id]")].map((element) => element.id),
  overflow: root.scrollWidth - root.clientWidth,
  width: window.innerWidth,
  headings: [...document.querySelectorAll("h1, h2, h3, h4")].map((heading) => Number(heading.tagName[1])),
  scopes: [...document.querySelectorAll("th")].map((th) => th.getAttribute("scope")),
  captions: [...document.querySelectorAll("table")].map((table) => table.caption ? table.caption.textContent : ""),
  scripts: document.querySelectorAll("script:not([type])").length,
  drawn: document.querySelector(".viewer.drawn") !== null,
  hacked: window.hacked === undefined ? null : window.hacked,
  title: document.title,
};
"""
"""What there is to see on a page."""

PIXELS = """
const done = arguments[0];
requestAnimationFrame(() => requestAnimationFrame(() => {
  const canvas = document.querySelector("canvas"), copy = document.createElement("canvas");
  [copy.width, copy.height] = [80, 60];
  const flat = copy.getContext("2d");
  flat.drawImage(canvas, 0, 0, 80, 60);
  done([...flat.getImageData(0, 0, 80, 60).data]);
}));
"""
"""The picture of the bed as it is now, small: red, green, blue, opacity of every pixel."""


class Browser:
    """One window of a browser.

    Parameters
    ----------
    folder : Path
        Where the browser keeps its files.
    """

    def __init__(self, folder):
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        self.process = subprocess.Popen(
            [DRIVER, f"--port={port}"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        self.address = f"http://127.0.0.1:{port}/session"
        try:
            self._wait_for(port)
            options = {"binary": BROWSER, "args": [*OPTIONS, f"--user-data-dir={folder}"]}
            wanted = {"goog:chromeOptions": options, "goog:loggingPrefs": {"browser": "ALL", "performance": "ALL"}}
            session = self._send("", {"capabilities": {"alwaysMatch": wanted}})
            self.address += f"/{session['sessionId']}"
        except BaseException:
            self.process.kill()
            raise

    def _wait_for(self, port):
        """Wait until the driver answers."""
        for _ in range(300):
            try:
                urllib.request.urlopen(f"http://127.0.0.1:{port}/status", timeout=5).close()
            except OSError:
                time.sleep(0.1)
            else:
                return
        raise AssertionError("chromedriver does not answer")

    def close(self):
        """End the browser and its driver."""
        try:
            urllib.request.urlopen(urllib.request.Request(self.address, method="DELETE"), timeout=30).close()
        finally:
            self.process.terminate()
            self.process.wait(timeout=30)

    def open(self, path, width=1100, height=900, scheme="light"):
        """Load a page from a file at a width, as a phone would where it is narrow."""
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600}
        self.tell("Emulation.setDeviceMetricsOverride", size)
        self.tell("Emulation.setEmulatedMedia", {"features": [{"name": "prefers-color-scheme", "value": scheme}]})
        self._send("/url", {"url": path.as_uri()})

    def tell(self, command, parameters):
        """Send a command of the browser's own protocol."""
        return self._send("/goog/cdp/execute", {"cmd": command, "params": parameters})

    def run(self, script, *arguments):
        """Run a script in the page; what it returns."""
        return self._send("/execute/sync", {"script": script, "args": list(arguments)})

    def pixels(self):
        """The picture of the bed, once it is drawn."""
        return self._send("/execute/async", {"script": PIXELS, "args": []})

    def drag(self, x, y):
        """Press on the middle of the picture of the bed, pull it aside and let go."""
        element = self._send("/element", {"using": "css selector", "value": "canvas"})
        at = {"type": "pointerMove", "origin": element, "duration": 0}
        steps = [
            at | {"x": 0, "y": 0},
            {"type": "pointerDown", "button": 0},
            at | {"x": x, "y": y},
            {"type": "pointerUp", "button": 0},
        ]
        self._send("/actions", {"actions": [{"type": "pointer", "id": "mouse", "actions": steps}]})

    def press(self, key):
        """Press a key on the picture of the bed."""
        element = self._send("/element", {"using": "css selector", "value": "canvas"})
        self._send(f"/element/{next(iter(element.values()))}/value", {"text": key})

    def console(self):
        """What the console told since it was last asked."""
        return [entry["message"] for entry in self._send("/se/log", {"type": "browser"})]

    def requests(self):
        """Addresses that pages asked for since they were last asked for."""
        events = [json.loads(e["message"])["message"] for e in self._send("/se/log", {"type": "performance"})]
        return [e["params"]["request"]["url"] for e in events if e["method"] == "Network.requestWillBeSent"]

    def _send(self, place, body):
        data = json.dumps(body).encode()
        request = urllib.request.Request(self.address + place, data, {"Content-Type": "application/json"})
        try:
            with urllib.request.urlopen(request, timeout=60) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            raise AssertionError(error.read().decode()[:2000]) from None
