"""A headless Chromium that a test drives, by the DevTools protocol over two pipes: no port, no library.

absent() ends a test where there is no Chromium: skipped, or failed with MSBVH_REQUIRE_BROWSER=1.
"""

from __future__ import annotations

import base64
import fcntl
import json
import os
import select
import shutil
import signal
import time
from pathlib import Path
from types import TracebackType
from typing import Any, NoReturn

import pytest

PROGRAMS = ("chromium", "chromium-browser", "google-chrome")
OPTIONS = (
    "--headless=new",
    "--remote-debugging-pipe",
    "--no-sandbox",  # As root there is none.
    "--disable-gpu",
    "--disable-dev-shm-usage",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-extensions",
    "--mute-audio",
    "--hide-scrollbars",
)
TIMEOUT = 60.0
"""Seconds for one answer, on a machine that is busy."""
KEYS = {"Enter": ("\r", 13), " ": (" ", 32), "Tab": ("", 9), "ArrowLeft": ("", 37), "ArrowRight": ("", 39)}
"""Keys that tests press: text and Windows' code."""


def find_browser() -> str:
    """The program; ends the test where there is none."""
    program = next(filter(None, map(shutil.which, PROGRAMS)), None)
    return program if program else absent()


def absent() -> NoReturn:
    """Ends a test that needs a browser."""
    if os.environ.get("MSBVH_REQUIRE_BROWSER") == "1":
        pytest.fail(f"MSBVH_REQUIRE_BROWSER=1: found none of {', '.join(PROGRAMS)}; expected Debian's package chromium")
    pytest.skip("no Chromium on this machine")


class Browser:
    """One page. `events` are all that came since the last look: dictionaries with `method` and `params`."""

    def __init__(self, program: str, profile: Path) -> None:
        theirs_in, self._out = os.pipe()
        self._in, theirs_out = os.pipe()
        # Clear of 3 and 4, where Chromium expects its ends.
        high = [fcntl.fcntl(end, fcntl.F_DUPFD_CLOEXEC, 20) for end in (theirs_in, theirs_out)]
        log = os.open(profile / "chromium.log", os.O_WRONLY | os.O_CREAT, 0o600)
        actions = [
            (os.POSIX_SPAWN_DUP2, high[0], 3),
            (os.POSIX_SPAWN_DUP2, high[1], 4),
            (os.POSIX_SPAWN_DUP2, log, 1),
            (os.POSIX_SPAWN_DUP2, log, 2),
        ]
        command = [program, *OPTIONS, f"--user-data-dir={profile}", "about:blank"]
        self._process = os.posix_spawn(program, command, os.environ, file_actions=actions, setpgroup=0)
        for end in (theirs_in, theirs_out, *high, log):
            os.close(end)
        self.events: list[dict[str, Any]] = []
        self._buffer = b""
        self._count = 0
        self._session = ""
        target = next(each for each in self("Target.getTargets")["targetInfos"] if each["type"] == "page")
        attached = self("Target.attachToTarget", targetId=target["targetId"], flatten=True)
        self._session = attached["sessionId"]
        for domain in ("Page", "Runtime", "Network", "Log"):
            self(f"{domain}.enable")

    def __enter__(self) -> Browser:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        os.close(self._out)
        os.close(self._in)
        os.killpg(self._process, signal.SIGKILL)
        os.waitpid(self._process, 0)

    def __call__(self, method: str, **parameters: Any) -> dict[str, Any]:
        """One command of the protocol, and its result."""
        self._count += 1
        message: dict[str, Any] = {"id": self._count, "method": method, "params": parameters}
        if self._session:
            message["sessionId"] = self._session
        content = json.dumps(message).encode() + b"\0"
        while content:
            content = content[os.write(self._out, content) :]
        while True:
            answer = self._next(method)
            if answer.get("id") == self._count:
                assert "error" not in answer, f"{method}: {answer['error']}"
                return answer["result"]
            self.events.append(answer)

    def _next(self, awaited: str) -> dict[str, Any]:
        """The next message."""
        end = time.monotonic() + TIMEOUT
        while b"\0" not in self._buffer:
            ready, _, _ = select.select([self._in], [], [], max(0.0, end - time.monotonic()))
            assert ready, f"Chromium did not answer {awaited} within {TIMEOUT:g} s"
            received = os.read(self._in, 1 << 20)
            assert received, f"Chromium ended during {awaited}"
            self._buffer += received
        message, _, self._buffer = self._buffer.partition(b"\0")
        return json.loads(message)

    def open(self, path: Path) -> None:
        """Shows a file, and waits until it and its pictures are there."""
        self("Page.navigate", url=path.as_uri())
        while not any(event.get("method") == "Page.loadEventFired" for event in self.events):
            self.events.append(self._next("Page.loadEventFired"))
        self.run("Promise.all([...document.images].filter(i => i.src).map(i => i.decode())).then(() => true)")

    def run(self, script: str) -> Any:
        """The value of an expression in the page; promises are awaited."""
        found = self("Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True)
        assert "exceptionDetails" not in found, f"{script}: {found['exceptionDetails']}"
        return found["result"].get("value")

    def resize(self, width: int, height: int, dark: bool = False) -> None:
        """The window, in CSS pixels, and the colour scheme."""
        phone = width < 600
        self("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=phone)
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        self("Emulation.setEmulatedMedia", features=[scheme])

    def press(self, key: str) -> None:
        """A key, down and up, to what has the focus."""
        text, code = KEYS[key]
        about = {"key": key, "code": "Space" if key == " " else key, "windowsVirtualKeyCode": code}
        if text:
            about["text"] = text
        self("Input.dispatchKeyEvent", type="keyDown", **about)
        about.pop("text", None)
        self("Input.dispatchKeyEvent", type="keyUp", **about)

    def mouse(self, kind: str, x: float, y: float) -> None:
        """`Pressed`, `Moved` with the left button held, or `Released`, in the window's pixels."""
        about = {"button": "left", "buttons": 0 if kind == "Released" else 1, "clickCount": 1}
        self("Input.dispatchMouseEvent", type=f"mouse{kind}", x=x, y=y, **about)

    def click(self, x: float, y: float) -> None:
        self.mouse("Pressed", x, y)
        self.mouse("Released", x, y)

    def screenshot(self, path: Path, whole: bool = True) -> None:
        """As a PNG file: the whole page or the window."""
        found = self("Page.captureScreenshot", format="png", captureBeyondViewport=whole)
        path.write_bytes(base64.b64decode(found["data"]))

    def faults(self) -> list[str]:
        """Exceptions, console errors and entries of the log that warn, since the browser began."""
        found = []
        for event in self.events:
            about = event.get("params", {})
            if event["method"] == "Runtime.exceptionThrown":
                found.append(json.dumps(about["exceptionDetails"]))
            elif event["method"] == "Runtime.consoleAPICalled" and about["type"] in ("error", "warning", "assert"):
                found.append(json.dumps(about["args"]))
            elif event["method"] == "Log.entryAdded" and about["entry"]["level"] in ("error", "warning"):
                found.append(about["entry"]["text"])
        return found

    def requests(self) -> list[str]:
        """Every address that was asked for; data URIs cut short."""
        sent = [event["params"] for event in self.events if event["method"] == "Network.requestWillBeSent"]
        return [about["request"]["url"][:200] for about in sent]
