"""A flight as a test: ArduPlane flies the written script, and ``advisor expect`` decides.

    python -m benchmarks.scripted.expected [--junit FILE] [--keep DIR]

These are the steps of the page "Test a flight", each a process of its own: ``advisor script ardupilot``,
ArduPlane in software in the loop, ``docs/data/fly_script.py``, ``advisor expect``. The airframe and its
expectations are ``light.yaml`` and ``light-expectations.yaml``. The exit code is that of ``advisor expect``.
Where no ArduPlane is present, the command says so and ends with 0. A slow machine takes longer, and does not
fail by its pace.
"""

import argparse
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from .pilot import SITL, free_port, install, light, simulator

FILES = Path(__file__).parent
FLY = FILES.parents[1] / "docs" / "data" / "fly_script.py"
INPUTS = 6
"""Number of inputs of the script's table."""
SPEEDUPS = ("4", "2")
"""Simulated seconds in a second, one flight after the other until a flight's script was called in time."""
LATE_MS = 120
"""Longest time between two calls of a script that flies steps of 200 ms, ms."""
ADVISOR = (sys.executable, "-m", "advisor")


def main(arguments: Sequence[str] | None = None) -> int:
    """Fly, compare, and return the exit code of ``advisor expect``."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--junit", type=Path, help="file for the report as JUnit XML")
    parser.add_argument("--keep", type=Path, help="folder of the flight; a temporary one by default")
    given = parser.parse_args(arguments)
    if not (SITL / "arduplane.xz").exists():
        print(f"No flight: {SITL} holds no ArduPlane.")
        return 0
    with tempfile.TemporaryDirectory() as name:
        folder = (given.keep or Path(name)).resolve()
        for speedup in SPEEDUPS:
            at = folder / f"speedup-{speedup}"
            at.mkdir(parents=True)
            if code := _fly(at, speedup):
                return code
            if _latest_ms(at / "flight.tlog") <= LATE_MS:
                break
            print(f"This machine calls the script too late at {speedup} times real time.", flush=True)
        return _compare(at / "flight.tlog", given.junit)


def _latest_ms(flight: Path) -> int:
    """Return the longest time between two calls that the script reported, ms."""
    return max(map(int, re.findall(rb"ADVISOR LATE: calls up to (\d+) ms", flight.read_bytes())), default=0)


def _fly(folder: Path, speedup: str) -> int:
    """Write the script, fly its inputs, and return the exit code of the step that failed, or 0."""
    script = folder / "inflight.lua"
    words = [*ADVISOR, "script", "ardupilot", "--aircraft", str(FILES / "light.yaml"), "-o", str(script)]
    if code := subprocess.run(words, check=False).returncode:
        return code
    install(script.read_text(encoding="utf-8"), folder, light())
    port = free_port()
    with simulator(folder, "plane", port, speedup):
        words = [sys.executable, str(FLY), str(INPUTS), str(folder / "flight.tlog"), str(port)]
        return subprocess.run(words, check=False).returncode


def _compare(flight: Path, junit: Path | None) -> int:
    """Compare the flight with the expectations, and return the exit code."""
    words = [*ADVISOR, "expect", str(flight), str(FILES / "light-expectations.yaml")]
    words += ["--aircraft", str(FILES / "light.yaml")]
    if junit is not None:
        junit.parent.mkdir(parents=True, exist_ok=True)
        words += ["--junit", str(junit)]
    return subprocess.run(words, check=False, env=os.environ).returncode


if __name__ == "__main__":
    sys.exit(main())
