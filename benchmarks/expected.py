"""Do doctor's expected errors come out in flight?

    python -m benchmarks.expected LOG [LOG ...]

Doctor reads a log until half of its manoeuvres are flown, and expects the errors of one 3-2-1-1. Each later
accepted 3-2-1-1, estimated alone, has errors of its own. The expected error is scaled to the amplitude
flown, because errors fall with the amplitude. A line a log has the median of stated over expected errors, by
derivative. The last line has the share of ratios between .7 and 1.4. An aircraft file of the same name next
to a log is used.
"""

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft_file.read import load_aircraft
from advisor.campaign.campaign import Campaign
from advisor.decision.envelope import flown
from advisor.doctor.examiner import Examiner
from advisor.mavlink.logs.logs import read_whole_log
from advisor.oem.estimate import Estimate
from advisor.oem.estimator import estimate as estimate_one

NAMES = ("Z_alpha", "M_alpha", "M_q", "M_delta_e")
LEAST, MOST = 0.7, 1.4


def main() -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("logs", nargs="+", type=Path)
    asked = parser.parse_args()
    every: list[float] = []
    print(f"| log | 3-2-1-1 | {' | '.join(NAMES)} |\n|---|---|{'---|' * len(NAMES)}")
    for log in asked.logs:
        beside = log.with_suffix(".yaml")
        told = np.array(list(ratios(log, load_aircraft(beside) if beside.exists() else Aircraft())))
        if len(told):
            every += told.ravel().tolist()
            middle = " | ".join(f"{ratio:.2f}" for ratio in np.median(told, axis=0))
            print(f"| {log.stem} | {len(told)} | {middle} |", flush=True)
    within = np.mean([LEAST <= ratio <= MOST for ratio in every]) if every else 0.0
    print(f"{100.0 * within:.0f} % of {len(every)} ratios lie between {LEAST} and {MOST}")
    return 0


def ratios(log: Path, aircraft: Aircraft) -> Iterator[list[float]]:
    """Yield stated over expected errors of each accepted 3-2-1-1 in the second half of a log."""
    campaign, examiner = Campaign(aircraft), Examiner(aircraft)
    flown_by = []
    for columns in read_whole_log(log):
        campaign.feed(columns)
        flown_by.append(len(campaign.state.maneuvers))
    campaign.finish()
    maneuvers = campaign.state.maneuvers
    half = len(maneuvers) // 2
    for columns, count in zip(read_whole_log(log), flown_by, strict=True):
        examiner.feed(columns)
        if count >= half > 0:
            break
    expected = examiner.findings().expectation
    if expected is None:
        return
    for one in maneuvers[half:]:
        if not one.verdict.accepted or "3-2-1-1" not in one.maneuver.span.kind:
            continue
        estimate = estimate_one(one.maneuver, aircraft)
        if not isinstance(estimate, Estimate):
            continue
        amplitude = 0.5 * float(np.degrees(np.ptp(flown(one.maneuver, "elevator"))))
        share = amplitude / expected.amplitude_deg
        stated = [float(estimate.std[estimate.names.index(name)]) for name in NAMES]
        yield [share * s / expected.std[name] for name, s in zip(NAMES, stated, strict=True)]


if __name__ == "__main__":
    sys.exit(main())
