"""The terminal application: first paint, cost of live plots, answer to keys, memory over an hour.

    python benchmarks/tui.py [--log logs/arduplane-calm.tlog] [--minutes 60]

The first three rows run ``advisor replay`` as a user would, in a pseudo-terminal, and look at
nothing but its output and its processor time; the last runs the application without a terminal
over the log's manoeuvres followed by quiet flight, every half second of it reported and painted.
"""

import argparse
import asyncio
import fcntl
import os
import pty
import select
import struct
import subprocess
import sys
import tempfile
import termios
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from math import inf
from pathlib import Path

import numpy as np

from advisor.aircraft import Aircraft
from advisor.campaign import Campaign
from advisor.flight.messages import Columns
from advisor.mavlink.logs import open_log
from advisor.tui import conductor, replay
from advisor.tui.app import AdvisorApp
from advisor.tui.settings import Settings

TICKS_PER_S = os.sysconf("SC_CLK_TCK")
PAGE_MB = os.sysconf("SC_PAGE_SIZE") / 1e6
BLOCK = "█".encode()


class Terminal:
    """``advisor replay`` in a pseudo-terminal of its own."""

    def __init__(self, arguments: list[str], columns: int, rows: int, folder: str, screen: str) -> None:
        settings = Path(folder) / "inflight-advisor" / "settings.yaml"
        settings.parent.mkdir(exist_ok=True)
        settings.write_text(f"screen: {screen}\n")
        self._ours, theirs = pty.openpty()
        fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))
        env = {**os.environ, "TERM": "xterm-256color", "XDG_CONFIG_HOME": folder, "HEADLESS": "0"}
        self.started_s = time.perf_counter()
        command = [str(Path(sys.executable).with_name("advisor")), "replay", *arguments]
        self._process = subprocess.Popen(command, stdin=theirs, stdout=theirs, stderr=theirs, env=env)
        os.close(theirs)

    def until(self, mark: bytes, patience_s: float = 20.0) -> float:
        """Read until the screen shows ``mark``; seconds since the call."""
        begun, said = time.perf_counter(), b""
        while time.perf_counter() - begun < patience_s:
            if select.select([self._ours], [], [], 0.01)[0]:
                said += os.read(self._ours, 1 << 16)
                if mark in said:
                    return time.perf_counter() - begun
        raise TimeoutError(f"the screen never showed {mark!r}")

    def drain(self, seconds: float) -> int:
        """Read whatever is painted; the number of bytes."""
        begun, count = time.perf_counter(), 0
        while time.perf_counter() - begun < seconds:
            if select.select([self._ours], [], [], 0.05)[0]:
                count += len(os.read(self._ours, 1 << 16))
        return count

    def press(self, keys: bytes) -> None:
        os.write(self._ours, keys)

    @property
    def cpu_s(self) -> float:
        """Processor time of the application so far, s."""
        after_name = Path(f"/proc/{self._process.pid}/stat").read_text().rsplit(")", 1)[1].split()
        return (int(after_name[11]) + int(after_name[12])) / TICKS_PER_S

    def close(self) -> None:
        self._process.terminate()
        self._process.wait()
        os.close(self._ours)


@contextmanager
def terminal(*arguments: str, size: tuple[int, int] = (120, 40), screen: str = "pilot") -> Iterator[Terminal]:
    with tempfile.TemporaryDirectory() as folder:
        here = Terminal(list(arguments), *size, folder, screen)
        try:
            yield here
        finally:
            here.close()


def first_paint(log: Path) -> tuple[float, float]:
    """Best of five: seconds from the command to the painted word, and processor seconds."""
    times = []
    for _ in range(5):
        with terminal(str(log)) as here:
            here.until(BLOCK)
            times.append((time.perf_counter() - here.started_s, here.cpu_s))
    return min(t for t, _ in times), min(t for _, t in times)


def live_plots(log: Path) -> tuple[float, float]:
    """Share of a core in percent: with a manoeuvre in the air and three plots, and between manoeuvres."""
    with terminal(str(log), screen="engineer") as here:
        here.until(b"Manoeuvres")
        here.press(b"5]")
        here.until(b"fitted so far", 60.0)
        shares = []
        for seconds in (4.0, 12.0):
            before = here.cpu_s
            here.drain(seconds)
            shares.append((here.cpu_s - before) / seconds * 100.0)
        return shares[0], shares[1]


def keys(log: Path) -> tuple[float, float]:
    """Milliseconds from a key to its effect while the log is played as fast as it can be: median, worst."""
    answers = []
    with terminal(str(log), "--speed", "max", size=(80, 24), screen="engineer") as here:
        here.until(b"Manoeuvres")
        here.until("✓ GOOD".encode(), 60.0)
        for _ in range(20):
            for key, effect in ((b"p", BLOCK), (b"e", b"Manoeuvres")):
                here.press(key)
                answers.append(here.until(effect) * 1e3)
                here.drain(0.02)
    return float(np.median(answers)), max(answers)


def long_flight(log: Path, minutes: float) -> list[Columns]:
    """The log, then 20 s of quiet flight out of it again and again, all clocks running on."""
    pieces = [columns for batch in open_log(log) for columns in batch]
    arrival = np.concatenate([p.arrival_s for p in pieces])
    first, last = float(arrival.min()), float(arrival.max())
    last_order = max(int(p.order[-1]) for p in pieces)
    quiet = [p for p in (_cut(p, first + 10.0, first + 30.0) for p in pieces) if len(p)]
    repeats = int((minutes * 60.0 - (last - first)) / 20.0)
    return pieces + [
        _later(piece, last - first - 10.0 + 20.0 * k, (k + 1) * (last_order + 1))
        for k in range(repeats)
        for piece in quiet
    ]


def _cut(piece: Columns, start_s: float, end_s: float) -> Columns:
    wanted = (piece.arrival_s >= start_s) & (piece.arrival_s < end_s)
    fields = {name: np.array(values)[wanted] for name, values in piece.fields.items()}
    return replace(piece, order=piece.order[wanted], arrival_s=piece.arrival_s[wanted], fields=fields)


def _later(piece: Columns, seconds: float, order: int) -> Columns:
    fields = dict(piece.fields)
    for name, per_second in (("time_boot_ms", 1e3), ("time_usec", 1e6)):
        if name in fields:
            shifted = fields[name].astype(np.int64) + int(seconds * per_second)
            fields[name] = shifted.astype(fields[name].dtype)
    return replace(piece, order=piece.order + order, arrival_s=piece.arrival_s + seconds, fields=fields)


async def memory(log: Path, minutes: float) -> tuple[float, int]:
    """Growth of resident memory in MB over the last two thirds of the flight, and repaints in all."""
    conductor.REPORT_EVERY_S = 0.0
    flight = long_flight(log, minutes)
    player = replay.LogPlayer(log.name, lambda: flight, inf)
    app = AdvisorApp(
        player, lambda: Campaign(Aircraft(), settle=True), Aircraft(), Settings(screen="engineer")
    )
    resident, repaints = [], 0
    async with app.run_test(size=(200, 60)) as pilot:
        shown = app.view
        while shown.health.condition != "ended":
            await pilot.pause(0.01)
            if app.view is not shown:
                shown, repaints = app.view, repaints + 1
                resident.append(int(Path("/proc/self/statm").read_text().split()[1]) * PAGE_MB)
    return max(resident[-20:]) - max(resident[: len(resident) // 3]), repaints


def row(name: str, figure: str, goal: str) -> None:
    print(f"{name:<58}{figure:>22}   {goal}", flush=True)


def main(arguments: Sequence[str] | None = None) -> None:
    options = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    options.add_argument("--log", type=Path, default=Path("logs/arduplane-calm.tlog"))
    options.add_argument("--minutes", type=float, default=60.0)
    chosen = options.parse_args(arguments)
    # Seconds on the wall mean little while others want the same processors.
    print(f"load average {os.getloadavg()[0]:.1f} on {os.cpu_count()} processors")
    wall_s, cpu_s = first_paint(chosen.log)
    row("first paint after the command, best of 5", f"{wall_s:.2f} s ({cpu_s:.2f} s CPU)", "at most 0.5 s")
    flown, between = live_plots(chosen.log)
    row("manoeuvre in the air, three plots, whole application", f"{flown:.1f} % of a core", "under 10 %")
    row("between manoeuvres", f"{between:.1f} % of a core", "-")
    median, worst = keys(chosen.log)
    row("key to its effect, estimates running", f"{median:.0f} ms, worst {worst:.0f} ms", "within 100 ms")
    grown, repaints = asyncio.run(memory(chosen.log, chosen.minutes))
    row(
        f"memory, last two thirds of {chosen.minutes:.0f} min",
        f"{grown:+.1f} MB ({repaints} paints)",
        "no growth",
    )


if __name__ == "__main__":
    main()
