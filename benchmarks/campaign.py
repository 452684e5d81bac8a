"""What a long campaign costs: processor time by its manoeuvres, and a flight of ten hours.

python -m benchmarks.campaign

A recorded flight of seven manoeuvres is flown again and again, all clocks running on. Processor time only.
"""

import pickle
import resource
import time
from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np

from advisor.aircraft.aircraft import Aircraft, Elevator
from advisor.campaign.campaign import Campaign, ManeuverJudged
from advisor.campaign.state import JudgedManeuver
from advisor.flight.signals.messages import Columns
from advisor.mavlink.logs.logs import open_log
from advisor.oem.estimate import Estimate
from benchmarks.long_flight import cut, later

LOG = Path(__file__).parents[1] / "logs" / "arduplane-calm.tlog"
CALIBRATION = ((1000.0, 25.0), (1500.0, 0.0), (2000.0, -25.0))
UNKNOWN_SERVO = Aircraft(elevator=Elevator(calibration=CALIBRATION))
KNOWN_SERVO = Aircraft(elevator=Elevator(calibration=CALIBRATION, lag_s=0.14))
FLIGHT = 7
"""Manoeuvres of the recorded flight."""
HOURS = 10.0
EVERY_S = 180.0
"""Between two manoeuvres of the long flight."""
SPEED = 100.0
"""Of the replay: ten reports a second then lie ten seconds of flight apart."""


def again(repeats: int) -> Iterator[list[Columns]]:
    """The recorded flight one time after the other, second by second."""
    every = [columns for batch in open_log(LOG) for columns in batch]
    seconds = _steps(every, 1.0)
    length = round(max(c.arrival_s[-1] for c in every) - min(c.arrival_s[0] for c in every)) + 2
    orders = max(int(c.order[-1]) for c in every) + 1
    for k in range(repeats):
        for second in seconds:
            yield [later(columns, float(k * length), k * orders) for columns in second]


def ten_hours(flown: Sequence[JudgedManeuver]) -> Iterator[list[Columns]]:
    """The recorded flight's manoeuvres one after the other, much level flight between, in reports' steps."""
    every = [columns for batch in open_log(LOG) for columns in batch]
    first, last = min(c.arrival_s[0] for c in every), max(c.arrival_s[-1] for c in every)
    boot = next(c for c in every if "time_boot_ms" in c.fields)
    offset = float(boot.arrival_s[0]) - float(boot.fields["time_boot_ms"][0]) / 1e3
    spans = [judged.maneuver.span for judged in flown]
    joints = [(a.end_s + b.record_from_s) / 2.0 + offset for a, b in pairwise(spans)]
    quiet = _steps([c for c in (cut(c, last - 29.0, last - 13.0) for c in every) if len(c)], 0.1 * SPEED)
    parts = [
        _steps([c for c in (cut(c, a, b) for c in every) if len(c)], 0.1 * SPEED)
        for a, b in zip([first, *joints], [*joints, last + 1.0], strict=True)
    ]
    now, order, k = float(first), 0, 0
    while now < first + HOURS * 3600.0:
        due = now + EVERY_S
        for steps in (parts[k % len(parts)], *(quiet,) * 12):
            if now >= due:
                break
            begin, end = steps[0][0].arrival_s[0], max(c.arrival_s[-1] for c in steps[-1])
            seconds, largest = round(now - float(begin), 3), max(int(c.order[-1]) for s in steps for c in s)
            for step in steps:
                yield [later(columns, seconds, order) for columns in step]
            now, order = now + round(float(end - begin) + 0.02, 3), order + largest + 1
        k += 1


def _steps(pieces: list[Columns], step_s: float) -> list[list[Columns]]:
    first, last = min(c.arrival_s[0] for c in pieces), max(c.arrival_s[-1] for c in pieces)
    starts = np.arange(first, last + 1e-3, step_s)
    steps = [
        [part for c in pieces if len(part := cut(c, start, start + step_s))] for start in starts.tolist()
    ]
    return [sorted(step, key=lambda c: int(c.order[0])) for step in steps if step]


def cost(repeats: int) -> tuple[float, int, list[float]]:
    """Processor seconds of a whole campaign, its manoeuvres, and the seconds of each verdict."""
    campaign, verdicts, total = Campaign(UNKNOWN_SERVO), [], 0.0
    for second in again(repeats):
        begin = time.process_time()
        told = campaign.feed(second)
        took = time.process_time() - begin
        total += took
        verdicts += [took] * any(isinstance(event, ManeuverJudged) for event in told)
    begin = time.process_time()
    campaign.finish()
    maneuvers = len(campaign.state.maneuvers)
    return total + time.process_time() - begin, maneuvers, verdicts


def growth() -> None:
    """Print the cost of campaigns of growing length."""
    print("Campaign of one log, servo's lag unknown, from messages to the final estimate")
    print(f"{'manoeuvres':>10s} {'CPU':>9s} {'each':>8s} {'ratio':>6s} {'goal':>6s}")
    base, _ = 0.0, cost(1)
    for repeats in (1, 2, 6, 29):
        seconds, maneuvers, verdicts = cost(repeats)
        base = base or seconds / maneuvers
        each = seconds / maneuvers
        print(f"{maneuvers:10d} {seconds:7.1f} s {each:6.2f} s {each / base:6.2f} {'<= 1':>6s}", flush=True)
    early, late = float(np.median(verdicts[:FLIGHT])), float(np.median(verdicts[-FLIGHT:]))
    print(
        f"Verdict after each of the last {FLIGHT} of {maneuvers} manoeuvres: {1e3 * late:.0f} ms, after each"
        f" of the first {FLIGHT}: {1e3 * early:.0f} ms, ratio {late / early:.2f} (goal <= 1);"
        f" longest {max(verdicts):.2f} s"
    )


def resident_mb() -> float:
    """Memory of this process now."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * resource.getpagesize() / 1e6


def hours() -> None:
    """Print what ten hours of flight take, and whether each verdict is that of its piece."""
    alone = Campaign(KNOWN_SERVO)
    for second in again(1):
        alone.feed(second)
    alone.finish()
    pieces = alone.state.maneuvers
    campaign, told_h = Campaign(KNOWN_SERVO, informs=True), 0.0
    begin = time.process_time()
    print(f"\nFlight of {HOURS:g} h, a manoeuvre every {EVERY_S:g} s, with screens at {SPEED:g} times")
    at: list[tuple[int, float]] = []
    for batch in ten_hours(pieces):
        campaign.feed(batch)
        state = campaign.state
        if state.duration_s / 3600.0 >= told_h:
            at.append((len(state.maneuvers), resident_mb()))
            print(
                f"  {state.duration_s / 3600.0:5.2f} h {len(state.maneuvers):4d} manoeuvres"
                f" {resident_mb():7.1f} MB, {len(state.activity)} stretches of activity",
                flush=True,
            )
            told_h += 0.25 if told_h < 1.0 else 1.0
    campaign.finish()
    seconds, state = time.process_time() - begin, campaign.state
    (early, early_mb), (late, late_mb) = at[4], at[-1]
    size = np.mean([len(pickle.dumps(judged)) for judged in state.maneuvers]) / 1e3
    print(
        f"  {seconds:.0f} s of CPU: {state.duration_s / seconds:.0f} times as fast as flown (goal {SPEED:g});"
        f" {1e3 * (late_mb - early_mb) / (late - early):.0f} kB a manoeuvre, whose samples, estimate and"
        f" verdict are {size:.0f} kB"
    )
    apart = [distance(judged, pieces[k % FLIGHT]) for k, judged in enumerate(state.maneuvers)]
    verdicts = sum(
        judged.verdict.accepted == pieces[k % FLIGHT].verdict.accepted
        for k, judged in enumerate(state.maneuvers)
    )
    print(
        f"  verdicts equal to those of the pieces: {verdicts} of {len(state.maneuvers)}; estimates apart by"
        f" at most {max(apart):.1e} standard deviations"
    )


def distance(one: JudgedManeuver, other: JudgedManeuver) -> float:
    """Largest difference of two estimates in standard deviations; infinite where only one is there."""
    if not isinstance(one.estimate, Estimate) or not isinstance(other.estimate, Estimate):
        return 0.0 if type(one.estimate) is type(other.estimate) else float("inf")
    return float(np.max(np.abs(one.estimate.theta - other.estimate.theta) / other.estimate.std))


def main() -> None:
    growth()
    hours()


if __name__ == "__main__":
    main()
