"""How many logs a core analyzes in a minute, and how the cost grows with their number and their length.

    python -m benchmarks.batch            # 200 logs, some minutes
    python -m benchmarks.batch --logs 20

The logs are the beginning of ``logs/arduplane-calm.tlog``, up to the end of a manoeuvre, each with some bytes
of its own at its end. ``advisor batch`` analyzes them as a user would, with an aircraft file that gives the
servo's lag; counted is the CPU time of all its processes, so that other work on the machine changes little.

Without the lag, the newest manoeuvres up to seven are estimated together after each one. A log of two
manoeuvres then takes 1.6 times as much, and a log of seven 3.5 times. With more than seven the cost is linear
(``benchmarks/campaign.py``).
"""

import resource
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import click

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import ManeuverFlown
from advisor.flight.stream.stream import FlightStream
from advisor.mavlink.logs.formats.telemetry import read_tlog
from advisor.mavlink.wire.scan import STAMP_BYTES

LOG = Path(__file__).parent.parent / "logs" / "arduplane-calm.tlog"
COPIES = 3
"""Logs of each length."""
AIRCRAFT = "elevator: {calibration: [[1000, 25.0], [1500, 0.0], [2000, -25.0]], lag_s: 0.14}\n"
"""As ``logs/README.md`` gives it."""
GOAL = 1.15
"""Largest ratio of a cost to the linear one that counts as linear."""


def ends_of_maneuvers() -> list[int]:
    """Length in bytes of the log up to the end of each manoeuvre."""
    stream = FlightStream(Aircraft(), keep_all=True)
    events = [event for columns in read_tlog(LOG) for event in stream.feed(columns)]
    events += stream.finish()
    (power_on,) = stream.power_ons
    spans = [event.maneuver.span for event in events if isinstance(event, ManeuverFlown)]
    return [power_on.arrivals(span.start_s, span.end_s + 5.0)[1] - STAMP_BYTES for span in spans]


def cost_s(length: int, count: int) -> float:
    """CPU time of a batch of so many logs, each as long, in s."""
    with TemporaryDirectory() as place:
        folder = Path(place) / "logs"
        folder.mkdir()
        beginning = LOG.read_bytes()[:length]
        for number in range(count):
            (folder / f"flight-{number:03}.tlog").write_bytes(beginning + bytes(number))
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        aircraft = Path(place) / "aircraft.yaml"
        aircraft.write_text(AIRCRAFT, encoding="utf-8")
        words = ["batch", str(folder), "-o", f"{place}/out", "--aircraft", str(aircraft), "--workers", "1"]
        subprocess.run([sys.executable, "-m", "advisor", *words], check=True, capture_output=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


@click.command
@click.option("--logs", type=click.IntRange(20), default=200, show_default=True, help="Logs of the batch.")
def main(logs: int) -> None:
    """Print both tables."""
    lengths = ends_of_maneuvers()
    start_s = cost_s(lengths[0], 1)
    print(f"A log of one manoeuvre, with the start of the program: {start_s:.1f} s of CPU")
    print("logs of one manoeuvre      CPU    each  logs a core-minute  ratio  goal")
    first = 0.0
    for count in (logs // 10, logs):
        each = cost_s(lengths[0], count) / count
        first = first or each
        rate = 60.0 / each
        print(f"{count:21d} {each * count:7.1f} s {each:5.2f} s {rate:19.0f} {each / first:6.2f} <= {GOAL}")
    print("manoeuvres a log       MB   CPU a log  a manoeuvre  ratio  goal")
    first = 0.0
    for number in (2, 4, len(lengths)):
        each = (cost_s(lengths[number - 1], COPIES + 1) - cost_s(lengths[number - 1], 1)) / COPIES
        first = first or each / number
        print(
            f"{number:16d} {lengths[number - 1] / 1e6:8.2f} {each:9.2f} s {each / number:10.2f} s"
            f" {each / number / first:6.2f} <= {GOAL}"
        )


if __name__ == "__main__":
    main()
