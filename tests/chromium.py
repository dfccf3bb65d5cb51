"""A headless chromium, asked through the pipe of its DevTools protocol: JSON texts, each with a zero byte."""

import base64
import contextlib
import fcntl
import io
import json
import os
import select
import shutil
import signal
import subprocess
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.image import imread

FOUND = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
FLAGS = (
    "--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
    "--remote-debugging-pipe", "--disable-dev-shm-usage", "--no-first-run", "--disable-background-networking",
    "--mute-audio", "--hide-scrollbars",
)  # fmt: skip
PATIENCE = 60.0  # s for one answer; a shared machine without a graphics card is slow


class BrowserTab:
    """One tab; ``told`` is what it said on its console or threw, ``asked`` the addresses it wanted."""

    def __init__(self, write: int, read: int) -> None:
        self._write, self._read, self._rest = write, read, b""
        self._number = 0
        self._session: str | None = None
        self.told: list[str] = []
        self.asked: list[str] = []
        self.loads = 0
        target = self.send("Target.createTarget", url="about:blank")["targetId"]
        self._session = self.send("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Network", "Log"):
            self.send(f"{domain}.enable")

    def send(self, method: str, **parameters: Any) -> Any:
        """Ask, and wait for the answer."""
        self._number += 1
        message: dict[str, Any] = {"id": self._number, "method": method, "params": parameters}
        if self._session:
            message["sessionId"] = self._session
        os.write(self._write, json.dumps(message).encode() + b"\0")
        while True:
            answer = self._next()
            if answer.get("id") == self._number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return answer["result"]

    def _next(self) -> dict[str, Any]:
        end = time.monotonic() + PATIENCE
        while b"\0" not in self._rest:
            if not select.select([self._read], [], [], max(0.0, end - time.monotonic()))[0]:
                raise TimeoutError("chromium did not answer")
            got = os.read(self._read, 1 << 20)
            if not got:
                raise EOFError("chromium ended")
            self._rest += got
        text, _, self._rest = self._rest.partition(b"\0")
        answer: dict[str, Any] = json.loads(text)
        self._note(answer.get("method", ""), answer.get("params", {}))
        return answer

    def _note(self, event: str, what: dict[str, Any]) -> None:
        if event == "Runtime.consoleAPICalled":
            self.told.append(" ".join(str(each.get("value", each)) for each in what["args"]))
        elif event == "Runtime.exceptionThrown":
            details = what["exceptionDetails"]
            self.told.append(details.get("exception", {}).get("description", details["text"]))
        elif event == "Log.entryAdded":
            self.told.append(what["entry"]["text"])
        elif event == "Network.requestWillBeSent" and not what["request"]["url"].startswith("data:"):
            self.asked.append(what["request"]["url"])
        elif event == "Page.loadEventFired":
            self.loads += 1

    def size(self, wide: int, high: int, is_phone: bool = False) -> None:
        """The size of the window, CSS pixels; two of them are one of a picture, which is drawn sooner."""
        self.send(
            "Emulation.setDeviceMetricsOverride",
            width=wide, height=high, deviceScaleFactor=0.5, mobile=is_phone,
        )  # fmt: skip

    def open(self, path: Path, at: str = "") -> None:
        """Open a file and wait until it has drawn."""
        self.send("Page.navigate", url="about:blank")
        self.told.clear()
        self.asked.clear()
        loads = self.loads
        self.send("Page.navigate", url=path.resolve().as_uri() + at)
        while self.loads <= loads:
            self._next()
        self.wait_for("window.roadgpt && roadgpt.frames > 0")

    def run(self, script: str) -> Any:
        """The value of an expression, promises awaited."""
        done = self.send("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in done:
            raise RuntimeError(done["exceptionDetails"]["exception"]["description"])
        return done["result"].get("value")

    def wait_for(self, script: str) -> None:
        """Wait until an expression is true."""
        end = time.monotonic() + PATIENCE
        while not self.run(f"Boolean({script})"):
            if time.monotonic() > end:
                raise TimeoutError(f"never true: {script}; the page said {self.told}")
            time.sleep(0.05)

    def settle(self) -> None:
        """Wait until two more frames have passed."""
        self.run("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done(1))))")

    def picture(self, of: str = "body") -> np.ndarray:
        """What an element inside the window shows, ``(rows, columns, 4)``, 0..1."""
        self.settle()
        box = self.run(
            f"(r => ({{x: r.x + scrollX, y: r.y + scrollY, width: r.width, height: r.height, scale: 1}}))"
            f"(document.querySelector({json.dumps(of)}).getBoundingClientRect())"
        )
        shot = self.send("Page.captureScreenshot", clip=box, optimizeForSpeed=True)
        return np.asarray(imread(io.BytesIO(base64.b64decode(shot["data"])), format="png"))

    def screenshot(self, path: Path) -> None:
        """The window as a PNG."""
        self.settle()
        path.write_bytes(base64.b64decode(self.send("Page.captureScreenshot")["data"]))

    def key(self, key: str, **more: Any) -> None:
        """Press a key."""
        text = {"text": key} if len(key) == 1 else {}
        self.send("Input.dispatchKeyEvent", type="keyDown", key=key, **text, **more)
        self.send("Input.dispatchKeyEvent", type="keyUp", key=key, **more)

    def mouse(self, kind: str, x: float, y: float, button: str = "left") -> None:
        """Press, move or release."""
        held = 0 if kind == "mouseReleased" else 1
        self.send(
            "Input.dispatchMouseEvent", type=kind, x=x, y=y, button=button, buttons=held, clickCount=1
        )  # fmt: skip

    def click(self, x: float, y: float) -> None:
        """Press and release the left button there."""
        self.mouse("mousePressed", x, y)
        self.mouse("mouseReleased", x, y)


@contextmanager
def browser() -> Iterator[BrowserTab]:
    """A chromium of our own with one tab; it ends with the block."""
    assert FOUND is not None
    their_read, our_write = os.pipe()
    our_read, their_write = os.pipe()
    # chromium reads from file 3 and writes to file 4; copies with high numbers are not in each other's way
    high = [fcntl.fcntl(end, fcntl.F_DUPFD_CLOEXEC, 50) for end in (their_read, their_write)]

    def hand_over() -> None:
        os.dup2(high[0], 3)
        os.dup2(high[1], 4)

    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        process = subprocess.Popen(  # the page is ours
            [FOUND, *FLAGS, f"--user-data-dir={profile}", "about:blank"],
            preexec_fn=hand_over, close_fds=False, start_new_session=True,
            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        for end in (their_read, their_write, *high):
            os.close(end)
        try:
            yield BrowserTab(our_write, our_read)
        finally:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()
            os.close(our_write)
            os.close(our_read)


def opened(page: BrowserTab, path: Path) -> None:
    """Show a page of a file, and wait until it is there."""
    page.send("Page.navigate", url=path.resolve().as_uri())
    while page.run("document.readyState + location.protocol") != "completefile:":
        time.sleep(0.02)
