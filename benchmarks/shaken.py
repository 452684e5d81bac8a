"""Is the set of accepted tests the same where a log differs by what no aircraft decides?

    python -m benchmarks.shaken LOG [LOG ...] --draws 20 --seed 1

Every draw moves each stamp by up to one millisecond, each whole number by one count, and the beginning of the
record by up to twelve seconds. Beginnings stay before the first test. A test is the same where more than half
of it overlaps. A line a log, then the share of draws with the set of the log as it is.
"""

import argparse
import sys
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft_file.read import load_aircraft
from advisor.campaign.campaign import Campaign
from advisor.flight.signals.messages import Columns, cut
from advisor.mavlink.logs.whole import read_whole_log

STAMPS = {"time_boot_ms": 1.0, "time_usec": 1000.0, "TimeUS": 1000.0, "timestamp": 1000.0}
"""Field of a stamp, and a millisecond in its unit."""
COUNTS = {
    "SERVO_OUTPUT_RAW": "servo", "RC_CHANNELS": "chan", "RAW_IMU": "acc", "SCALED_IMU2": "acc", "RCOU": "C",
}  # fmt: skip
"""Message to the beginning of the names of its whole numbers."""
LONGEST_S = 12.0
Test = tuple[str, float, float]
"""Axis, begin and end, s."""


def main() -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("logs", nargs="+", type=Path)
    parser.add_argument("--aircraft", type=Path)
    parser.add_argument("--draws", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    aircraft = load_aircraft(asked.aircraft) if asked.aircraft else Aircraft()
    same = drawn = 0
    print("| log | accepted | the same set | differs by |\n|---|---|---|---|")
    for log in asked.logs:
        rng = np.random.default_rng(asked.seed)
        columns = [one for batch in read_whole_log(log) for one in batch if len(one)]
        begins = float(min(one.arrival_s[0] for one in columns))
        as_it_is = accepted(columns, aircraft)
        first = min((begin for _, begin, _ in as_it_is), default=np.inf)
        spare_s = min(LONGEST_S, max(first - earliest_s(columns) - 2.0 * LONGEST_S, 0.0))
        others = []
        for _ in range(asked.draws):
            found = accepted(shaken(columns, rng, begins + spare_s * rng.random()), aircraft)
            others += list(differences(as_it_is, found))[:1]
        same, drawn = same + asked.draws - len(others), drawn + asked.draws
        print(f"| {log.name} | {len(as_it_is)} | {asked.draws - len(others)} of {asked.draws} | "
              f"{'; '.join(sorted(set(others)))} |", flush=True)  # fmt: skip
    print(f"{same} of {drawn} draws have the set of the log as it is")
    return 0


def earliest_s(columns: Sequence[Columns]) -> float:
    """Return the first stamp since boot, s."""
    stamps = [
        one.fields["time_boot_ms"][0] * 1e-3 for one in columns if "time_boot_ms" in one.fields and len(one)
    ]
    return float(min(stamps, default=0.0))


def accepted(columns: Sequence[Columns], aircraft: Aircraft) -> list[Test]:
    """Return the accepted tests of both axes."""
    campaign = Campaign(aircraft, lateral=True)
    campaign.feed(columns)
    campaign.finish()
    state = campaign.state
    lateral = state.lateral.maneuvers if state.lateral is not None else ()
    found = [("pitch", one) for one in state.maneuvers] + [("roll and yaw", one) for one in lateral]
    return [(axis, float(one.maneuver.span.start_s), float(one.maneuver.span.end_s))
            for axis, one in found if one.verdict.accepted]  # fmt: skip


def differences(one: Sequence[Test], other: Sequence[Test]) -> Iterator[str]:
    """Yield each test of one set that the other lacks."""
    for mine, theirs, word in ((one, other, "lost"), (other, one, "new")):
        for axis, begin, end in mine:
            overlaps = [min(end, e) - max(begin, b) for a, b, e in theirs if a == axis]
            if max(overlaps, default=0.0) <= 0.5 * (end - begin):
                yield f"{axis} {begin:.0f} to {end:.0f} s {word}"


def shaken(columns: Sequence[Columns], rng: np.random.Generator, from_s: float) -> list[Columns]:
    """Return the messages with stamps and whole numbers moved, from a time of arrival on."""
    found = []
    for one in columns:
        fields = dict(one.fields)
        for name, millisecond in STAMPS.items():
            if name in fields and len(one) > 1:
                moved = np.rint(fields[name] + millisecond * rng.uniform(-1.0, 1.0, len(one)))
                fields[name] = np.maximum.accumulate(moved).astype(fields[name].dtype)
        begin = COUNTS.get(one.name)
        for name in [name for name in fields if begin is not None and name.startswith(begin)]:
            values = fields[name]
            if values.dtype.kind in "iu":
                step = rng.integers(-1, 2, values.shape) * (values > 0)
                fields[name] = (values.astype(np.int64) + step).astype(values.dtype)
        found.append(cut(replace(one, fields=fields), one.arrival_s >= from_s))
    return [one for one in found if len(one)]


if __name__ == "__main__":
    sys.exit(main())
