"""The advisor live next to ArduPlane: ENOUGH ends a multisine of the script.

    python -m benchmarks.scripted.uplink [--tolerance PERCENT] [--inputs N]

ArduPlane flies multisines on its first link, and ``advisor live --uplink`` listens on its second one. The
first stretch gives the joint estimates. A later one ends as soon as its data are enough at this tolerance.
Printed are the script's texts and the advisor's lines. The exit code is 0 if the script says ``done: enough``
and the advisor accepts each stretch on both axes.
"""

import argparse
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from advisor.aircraft.aircraft import Aircraft
from advisor.scripts.ardupilot import ardupilot_script
from advisor.scripts.table import Source, script_table

from .flight import ScriptFlight, recover
from .pilot import SITL, airborne

LAG_S = 0.14
"""Lag of the simulator's servos (SIM_SERVO_SPEED), s, which the aircraft file states."""
LONGEST_S = 1800.0
"""Longest real time of the flight, s."""
BEFORE_S = 40.0
"""Level flight before each input, s: the advisor starts, asks for its parameters, and judges the last one."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Fly, print what both said, and return 1 if no input ended early or one was not accepted."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tolerance", type=float, default=40.0, help="of the crew, %% of each derivative")
    parser.add_argument("--inputs", type=int, default=2)
    given = parser.parse_args(arguments)
    if not (SITL / "arduplane.xz").exists():
        print(f"{SITL} holds no simulator.", file=sys.stderr)
        return 2
    table = script_table(Aircraft(name="light"), Source(), ("multisine",))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        lines = folder / "advisor.txt"
        with airborne(ardupilot_script(table), folder, longest_s=LONGEST_S) as pilot:
            flight = ScriptFlight(pilot, table, folder / "flight.tlog")
            with lines.open("wb") as written:
                live = subprocess.Popen(
                    _words(pilot.second_port, folder, given.tolerance),
                    stdout=written, stderr=written, env=os.environ | {"HEADLESS": "1"},
                )  # fmt: skip
                try:
                    for number in range(1, given.inputs + 1):
                        _wait(flight)
                        flight.begun(number)
                        flight.over(number)
                    _wait(flight)
                finally:
                    live.terminate()
                    live.wait(30)
        said = lines.read_text(encoding="utf-8")
    print("\n".join(f"{t:.1f} {text}" for t, text in pilot.texts if text.startswith("ADVISOR")))
    print(said)
    ended = any(text.endswith("done: enough") for _, text in pilot.texts)
    accepted = len(re.findall(r"multisine.*ACCEPTED", said))
    print(f"Ended by ENOUGH: {'yes' if ended else 'no'}; {accepted} of {2 * given.inputs} verdicts accept.")
    return 0 if ended and accepted == 2 * given.inputs else 1


def _words(port: int, folder: Path, tolerance_percent: float) -> list[str]:
    """Write the aircraft file, and return the command of the advisor."""
    file = folder / "aircraft.yaml"
    lags = "".join(f"{control}: {{lag_s: {LAG_S}}}\n" for control in ("elevator", "aileron", "rudder"))
    file.write_text(f"name: light\n{lags}campaign: {{tolerance_percent: {tolerance_percent:g}}}\n")
    words = [sys.executable, "-m", "advisor", "live", "--master", f"tcp:127.0.0.1:{port}", "--uplink"]
    return [*words, "--request-rates", "--no-record", "--aircraft", str(file)]


def _wait(flight: ScriptFlight) -> None:
    """Fly level at a held height, then in FBWA."""
    pilot = flight.pilot
    recover(pilot)
    pilot.link.set_mode("FBWB")
    pilot.fly(BEFORE_S)
    pilot.link.set_mode("FBWA")
    pilot.fly(3.0)


if __name__ == "__main__":
    sys.exit(main())
