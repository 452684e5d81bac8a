"""The terminal application: first paint, cost of live plots, answer to keys, memory over an hour.

    python -m benchmarks.tui [--log logs/arduplane-calm.tlog] [--minutes 60]

All rows but the last run ``advisor replay`` as a user would, in a pseudo-terminal, and look at
nothing but its output and its processor time; the last runs the application without a terminal
over the log's manoeuvres followed by quiet flight, every half second of it reported and painted.
Processor time and memory are those of both processes, the one that paints and the one that estimates.
"""

import argparse
import asyncio
import os
import time
from collections.abc import Sequence
from functools import partial
from math import inf
from pathlib import Path

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.campaign.campaign import Campaign
from advisor.session.conducting import Tempo
from advisor.session.remote import ConductorTask, RemoteConductor
from advisor.tui.app import AdvisorApp
from advisor.tui.settings import Settings
from benchmarks import long_flight
from benchmarks.keys import SIZES, answers, says
from benchmarks.terminal import resident_mb, terminal


def first_paint(log: Path) -> tuple[float, float]:
    """Best of five: seconds from the command to the painted word, and processor seconds."""
    times = []
    for _ in range(5):
        with terminal(str(log)) as here:
            here.until(says("█"))
            times.append((time.perf_counter() - here.started_s, here.cpu_s))
    return min(t for t, _ in times), min(t for _, t in times)


def live_plots(log: Path) -> tuple[float, float]:
    """Share of a core in percent: with a manoeuvre in the air and three plots, and between manoeuvres."""
    with terminal(str(log), screen="engineer") as here:
        here.until(says("Manoeuvres"))
        here.press(b"5]")
        here.until(says("in the air: manoeuvre"), 60.0)
        shares = []
        for seconds in (4.0, 12.0):
            before = here.cpu_s
            here.watch(seconds)
            shares.append((here.cpu_s - before) / seconds * 100.0)
        return shares[0], shares[1]


async def memory(log: Path, minutes: float) -> tuple[float, int]:
    """Growth of resident memory in MB over the last two thirds of the flight, and repaints in all."""
    task = ConductorTask(partial(long_flight.player, log, minutes), partial(Campaign, Aircraft(), None, True))
    app = AdvisorApp(
        RemoteConductor(task), Aircraft(), log.name, Tempo(speed=inf), Settings(screen="engineer")
    )
    resident, repaints = [], 0
    async with app.run_test(size=(200, 60)) as pilot:
        shown = app.view
        while shown.health.condition != "ended":
            await pilot.pause(0.01)
            if app.view is not shown:
                shown, repaints = app.view, repaints + 1
                resident.append(resident_mb(os.getpid()))
    return max(resident[-20:]) - max(resident[: len(resident) // 3]), repaints


def row(name: str, figure: str, goal: str) -> None:
    print(f"{name:<58}{figure:>34}   {goal}", flush=True)


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
    for size in SIZES:
        ms = [after_ms for _, after_ms in answers(chosen.log, size, 100)]
        figure = f"{np.median(ms):.0f} ms, 95 % {np.percentile(ms, 95):.0f}, worst {max(ms):.0f}"
        row(f"key to its effect, estimates running, {size[0]} x {size[1]}", figure, "within 100 ms")
    grown, repaints = asyncio.run(memory(chosen.log, chosen.minutes))
    row(
        f"memory, last two thirds of {chosen.minutes:.0f} min",
        f"{grown:+.1f} MB ({repaints} paints)",
        "no growth",
    )


if __name__ == "__main__":
    main()
