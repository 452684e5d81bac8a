"""``advisor serve`` as a program of its own, and its pages in a real browser."""

import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page, WebSocket

BROWSER = shutil.which("chromium") or shutil.which("chromium-browser")
_CONTROL = re.compile(r"\x1b\[[0-9;?]*[A-Za-z]")
PATIENCE_S = 80.0
"""On a fresh checkout the estimating process compiles its functions first, s."""


class Serving:
    """The command at work, until it is told to end."""

    def __init__(self, folder: Path, *words: object) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-m", "advisor", "serve", *map(str, words), "--port", "0"],
            stdin=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
            env={**os.environ, "XDG_DATA_HOME": str(folder), "XDG_CONFIG_HOME": str(folder)},
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
        )
        assert self.process.stderr is not None
        said = iter(self.process.stderr.readline, "")
        self.url = next(line for line in said if "the screens are at" in line).split()[4]

    @property
    def children(self) -> list[tuple[int, str]]:
        """Every process that the command has started, with the name of its module."""
        pid = self.process.pid
        found = []
        for task in Path(f"/proc/{pid}/task").iterdir():
            with suppress(FileNotFoundError, ProcessLookupError):  # it has ended meanwhile
                for child in (task / "children").read_text().split():
                    words = Path(f"/proc/{child}/cmdline").read_bytes().split(b"\0")
                    name = words[words.index(b"-m") + 1].decode() if b"-m" in words else ""
                    found.append((int(child), name))
        return found

    def interrupt(self) -> int:
        """End the command as Ctrl-C does, and wait for its exit code."""
        self.process.send_signal(signal.SIGINT)
        return self.process.wait(PATIENCE_S)

    def clear(self) -> None:
        """End the command if it still runs."""
        if self.process.poll() is None:
            self.process.kill()
        self.process.communicate()


class Screen:
    """One page of the browser: what it asks for, and what is painted on it."""

    def __init__(self, browser: "Browser", url: str) -> None:
        self.asked: list[str] = []
        self.wrong: list[str] = []
        self._painted: list[bytes] = []
        self._page: Page = browser.new_page(viewport={"width": 1280, "height": 800})
        self._page.on("request", lambda request: self.asked.append(request.url))
        self._page.on("pageerror", lambda error: self.wrong.append(str(error)))
        self._page.on("websocket", self._listen)
        self._page.goto(url)
        self._page.wait_for_selector("body.-first-byte", timeout=PATIENCE_S * 1e3)

    @property
    def text(self) -> str:
        """Everything painted so far, without colours and places."""
        return _CONTROL.sub("", b"".join(self._painted).decode(errors="replace"))

    @property
    def is_closed(self) -> bool:
        """Whether the page says that it is closed."""
        return self._page.locator(".closed").is_visible()

    def press(self, *keys: str) -> None:
        """Press keys one after another."""
        for key in keys:
            self._page.keyboard.press(key)

    def until(self, condition: Callable[[], bool]) -> None:
        """Let the browser work until something is so."""
        give_up_s = time.monotonic() + PATIENCE_S
        while not condition():
            assert time.monotonic() < give_up_s, f"waited in vain; painted was: {self.text[-2000:]}"
            self._page.wait_for_timeout(50)

    def _listen(self, socket: "WebSocket") -> None:
        socket.on("framereceived", lambda frame: self._painted.append(frame) if frame[:1] != "[" else None)


@contextmanager
def a_browser() -> Iterator["Browser"]:
    """Run the browser that the system has."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=BROWSER, args=["--no-sandbox", "--disable-gpu", "--disable-background-networking"]
        )
        yield browser
        browser.close()
