"""``advisor replay`` in a pseudo-terminal, and what stands on its screen."""

import fcntl
import os
import pty
import re
import select
import struct
import subprocess
import sys
import tempfile
import termios
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

TICKS_PER_S = os.sysconf("SC_CLK_TCK")
PAGE_MB = os.sysconf("SC_PAGE_SIZE") / 1e6
_SEQUENCE = re.compile(r"\x1b(?:\[(?P<numbers>[0-9;?]*)(?P<final>[@-~])|[()].|[=>])|(?P<text>[^\x1b]+)")
_INCOMPLETE = re.compile(r"\x1b(?:\[[0-9;?]*|[()])?$")


class Page:
    """The characters on a terminal, as far as Textual's output needs one: places, text, cleared screens."""

    def __init__(self, columns: int, rows: int) -> None:
        self._cells = [[" "] * columns for _ in range(rows)]
        self._row = self._column = 0
        self._bytes, self._left = b"", ""

    def feed(self, said: bytes) -> None:
        """Take output, cut anywhere."""
        said = self._bytes + said
        text = said.decode(errors="ignore")
        self._bytes = said[len(text.encode()) :]
        text = self._left + text
        cut = _INCOMPLETE.search(text)
        self._left = text[cut.start() :] if cut else ""
        for piece in _SEQUENCE.finditer(text[: cut.start()] if cut else text):
            if piece["text"]:
                self._write(piece["text"])
            elif piece["final"] == "H":
                row, column = (int(number or 1) for number in f"{piece['numbers']};".split(";")[:2])
                self._row, self._column = row - 1, column - 1
            elif piece["final"] == "J":
                self._cells = [[" "] * len(line) for line in self._cells]

    def _write(self, text: str) -> None:
        for number, line in enumerate(text.replace("\r", "").split("\n")):
            if number:
                self._row, self._column = self._row + 1, 0
            if self._row < len(self._cells):
                self._cells[self._row][self._column : self._column + len(line)] = line
            self._column += len(line)

    @property
    def text(self) -> str:
        """All rows."""
        return "\n".join("".join(line) for line in self._cells)


class Terminal:
    """A running ``advisor replay`` that sees keys and shows a page."""

    def __init__(self, arguments: list[str], columns: int, rows: int, folder: str, screen: str) -> None:
        settings = Path(folder) / "inflight-advisor" / "settings.yaml"
        settings.parent.mkdir(exist_ok=True)
        settings.write_text(f"screen: {screen}\n")
        self.page = Page(columns, rows)
        self._ours, theirs = pty.openpty()
        fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))
        env = {**os.environ, "TERM": "xterm-256color", "XDG_CONFIG_HOME": folder, "HEADLESS": "0"}
        self.started_s = time.perf_counter()
        command = [str(Path(sys.executable).with_name("advisor")), "replay", *arguments]
        self._process = subprocess.Popen(command, stdin=theirs, stdout=theirs, stderr=theirs, env=env)
        os.close(theirs)

    def read(self) -> bytes:
        """What was painted since, put on the page too; nothing if nothing comes at once."""
        if not select.select([self._ours], [], [], 0.01)[0]:
            return b""
        said = os.read(self._ours, 1 << 16)
        self.page.feed(said)
        return said

    def until(self, shown: Callable[[str], bool], patience_s: float = 20.0) -> float:
        """Read until the page is as wanted; seconds since the call."""
        begun = time.perf_counter()
        while time.perf_counter() - begun < patience_s:
            if self.read() and shown(self.page.text):
                return time.perf_counter() - begun
        raise TimeoutError(f"the screen never came to that:\n{self.page.text}")

    def watch(self, seconds: float) -> None:
        """Read whatever is painted."""
        end = time.perf_counter() + seconds
        while time.perf_counter() < end:
            self.read()

    def press(self, keys: bytes) -> None:
        """Type."""
        os.write(self._ours, keys)

    @property
    def cpu_s(self) -> float:
        """Processor time of the application's processes so far, s."""
        ticks = 0
        for process in _with_children(self._process.pid):
            after_name = Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()
            ticks += int(after_name[11]) + int(after_name[12])
        return ticks / TICKS_PER_S

    def close(self) -> None:
        """End the application."""
        self._process.terminate()
        self._process.wait()
        os.close(self._ours)


def resident_mb(process: int) -> float:
    """Memory of a process and its children, MB."""
    pages = [int(Path(f"/proc/{p}/statm").read_text().split()[1]) for p in _with_children(process)]
    return sum(pages) * PAGE_MB


def _with_children(process: int) -> list[int]:
    threads = Path(f"/proc/{process}/task").glob("*/children")
    return [process, *(int(child) for path in threads for child in path.read_text().split())]


@contextmanager
def terminal(*arguments: str, size: tuple[int, int] = (120, 40), screen: str = "pilot") -> Iterator[Terminal]:
    """``advisor replay`` with the settings' folder empty but for the first screen."""
    with tempfile.TemporaryDirectory() as folder:
        here = Terminal(list(arguments), *size, folder, screen)
        try:
            yield here
        finally:
            here.close()
