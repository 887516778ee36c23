# SPDX-License-Identifier: GPL-3.0-or-later
"""A headless Chromium that tests drive.

Its DevTools protocol runs over two pipes, as --remote-debugging-pipe has it.
"""

import base64
import itertools
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

PROGRAM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome", "chrome"))), None)
# Chromium reads from descriptor 3 and writes to 4; this puts the two pipes there and becomes Chromium.
_START = """
import fcntl, os, sys
pipes = [fcntl.fcntl(int(pipe), fcntl.F_DUPFD, 10) for pipe in sys.argv[1:3]]
for pipe, place in zip(pipes, (3, 4)):
    os.dup2(pipe, place)
os.execv(sys.argv[3], sys.argv[3:])
"""


class Browser:
    """One page in one Chromium.

    `problems` are errors, warnings and exceptions that the page reported.
    """

    def __init__(self, folder: Path) -> None:
        (read, its_write), (its_read, write) = os.pipe(), os.pipe()
        self._read, self._write = os.fdopen(read, "rb", buffering=0), os.fdopen(write, "wb", buffering=0)
        flags = ["--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--remote-debugging-pipe"]
        start = [sys.executable, "-c", _START, str(its_read), str(its_write), PROGRAM]
        command = [*start, *flags, f"--user-data-dir={folder}", "about:blank"]
        self._process = subprocess.Popen(command, pass_fds=(its_read, its_write), stderr=subprocess.DEVNULL)
        os.close(its_read)
        os.close(its_write)
        self._numbers, self._rest, self._session = itertools.count(1), b"", None
        self._reached: set[tuple[str, str]] = set()
        self.problems: list[str] = []
        try:
            self._attach()
        except BaseException:
            self.close()
            raise

    def _attach(self) -> None:
        target = self.send("Target.createTarget", url="about:blank")["targetId"]
        self._session = self.send("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log"):
            self.send(f"{domain}.enable")
        self.send("Page.setLifecycleEventsEnabled", enabled=True)

    def close(self) -> None:
        """End the program."""
        self._process.kill()
        self._process.wait()
        self._read.close()
        self._write.close()

    def send(self, method: str, **parameters):
        """The result of one command of the protocol.

        Raises RuntimeError with its message where it fails.
        """
        number = next(self._numbers)
        message = {"id": number, "method": method, "params": parameters}
        if self._session:
            message["sessionId"] = self._session
        self._write.write(json.dumps(message).encode() + b"\0")
        while True:
            answer = self._receive()
            if answer.get("id") == number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']['message']}")
                return answer["result"]
            self._note(answer)

    def _receive(self):
        while b"\0" not in self._rest:
            more = self._read.read(1 << 16)
            if not more:
                raise RuntimeError("Chromium ended")
            self._rest += more
        message, self._rest = self._rest.split(b"\0", 1)
        return json.loads(message)

    def _note(self, event):
        method, told = event.get("method"), event.get("params", {})
        if method == "Page.lifecycleEvent":
            self._reached.add((told["name"], told["loaderId"]))
        elif method == "Runtime.exceptionThrown":
            details = told["exceptionDetails"]
            self.problems.append(details.get("exception", {}).get("description", details["text"]))
        elif method == "Runtime.consoleAPICalled" and told["type"] in ("error", "warning", "assert"):
            self.problems.append(str(told["args"]))
        elif method == "Log.entryAdded" and told["entry"]["level"] in ("error", "warning"):
            self.problems.append(told["entry"]["text"])

    def open(self, path: Path, width: int = 1400, height: int = 1000, dark: bool = False, scripts: bool = True) -> None:
        """Load a file, of a window of that size, and wait until its script is done."""
        self.send(
            "Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=width < 600
        )
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        self.send("Emulation.setEmulatedMedia", features=[scheme])
        self.send("Emulation.setScriptExecutionDisabled", value=not scripts)
        loader = self.send("Page.navigate", url=path.as_uri())["loaderId"]
        while ("load", loader) not in self._reached:
            self._note(self._receive())
        has_script = "document.querySelector('script[type=module]') !== null"
        if scripts and self.evaluate(has_script):
            while not self.problems and not self.evaluate("'ready' in document.documentElement.dataset"):
                self.settle()
            self.settle()

    def settle(self) -> None:
        """Wait until what was asked for is drawn."""
        self.evaluate(
            "new Promise((done) => setTimeout(() => requestAnimationFrame(() => requestAnimationFrame(done))))"
        )

    def evaluate(self, expression: str):
        """The value of an expression of the page."""
        found = self.send("Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in found:
            raise RuntimeError(found["exceptionDetails"].get("exception", {}).get("description", "exception"))
        return found["result"].get("value")

    def place(self, selector: str) -> tuple[float, float]:
        """The middle of the first element of that selector, scrolled into view."""
        find = f"document.querySelector({json.dumps(selector)})"
        self.evaluate(f"{find}.scrollIntoView({{ block: 'center' }})")
        # Text that runs both ways has several boxes, and nothing in the middle between them.
        middle = "(({ x, y, width, height }) => [x + width / 2, y + height / 2])"
        x, y = self.evaluate(f"{middle}({find}.getClientRects()[0])")
        return x, y

    def click(self, selector: str) -> None:
        """Click in the middle of an element."""
        self.drag(*[self.place(selector)] * 2)

    def drag(self, start: tuple[float, float], end: tuple[float, float]) -> None:
        """Press the mouse at one point, move it to another, and let go."""
        for kind, (x, y) in (
            ("mouseMoved", start),
            ("mousePressed", start),
            ("mouseMoved", end),
            ("mouseReleased", end),
        ):
            button = {"button": "left", "clickCount": 1, "buttons": int(kind != "mouseReleased")}
            self.send("Input.dispatchMouseEvent", type=kind, x=x, y=y, **button)
        self.settle()

    def press(self, key: str, text: str = "") -> None:
        """Press and release a key."""
        self.send("Input.dispatchKeyEvent", type="keyDown", key=key, text=text)
        self.send("Input.dispatchKeyEvent", type="keyUp", key=key)
        self.settle()

    def screenshot(self, path: Path) -> None:
        """Write the whole page as PNG."""
        shot = self.send("Page.captureScreenshot", captureBeyondViewport=True)
        path.write_bytes(base64.b64decode(shot["data"]))
