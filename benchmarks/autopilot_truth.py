"""Derivatives of an autopilot's logs against the truth of the aircraft that was flown.

    python -m benchmarks.autopilot_truth FLIGHTS TLOGS [--only NAME ...]

Each log runs as in ``advisor analyze``: once with the servo's lag of the aircraft file, once without it. A
row holds when the estimate lies within 5 % of the truth, or when the 95 % interval holds the truth. The truth
is that of the README beside the logs, at the true air speed of the flight. The aircraft files state their air
speed as read.
"""

import argparse
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from advisor.aircraft.aircraft import Aircraft, Elevator
from advisor.aircraft.reference import PARAMETERS
from advisor.aircraft_file.read import load_aircraft
from advisor.campaign.state import CampaignState
from advisor.library import judge, read

SHOWN = ("Z_alpha", "M_alpha", "M_q", "M_delta_e")
POWERS: Mapping[str, int] = {"Z_alpha": 1, "M_alpha": 2, "M_q": 1, "M_delta_e": 2}
"""Power of the air speed by which each derivative grows."""
TRUE_OVER_STANDARD = 1.018
"""True air speed in this simulator over that of the standard atmosphere at the static pressure: 1.0509 over
1.0327 and 1.052 over 1.0354 by the ground speed without wind, 1.0265 over 1.0075 by its README."""
NEAR = 0.05
NORMAL_95 = 1.96


@dataclass(frozen=True)
class Truth:
    """Truth of one log, next to the aircraft file that stands beside it."""

    log: str
    lag_s: float
    """True lag of the servo, s."""
    true_over_read: float = 1.054
    """True air speed over the one that is read."""
    factors: Mapping[str, float] = field(default_factory=dict)
    """Factor from the file's derivative to the true one."""
    skipped: tuple[str, ...] = ()
    """Derivatives without one value: the flight's moment is not linear."""
    at_one_m_s: Mapping[str, float] = field(default_factory=dict)
    """Derivatives at a true air speed of 1 m/s, for a log without a file's model."""


TRUTHS = (
    Truth("autopilot-05", 0.14, skipped=("M_q",)),
    Truth("autopilot-14", 0.14, factors={"M_alpha": 0.815, "M_q": 0.7}),
    Truth("autopilot-16", 0.22),
    Truth("autopilot-20", 0.14),
    Truth("autopilot-42", 0.04, 1.0265, skipped=("M_q", "M_alpha", "M_delta_e")),
    Truth("autopilot-45", 0.04, 1.0265, {"Z_alpha": 1.0 / 0.75, "M_delta_e": 1.0 / 1.2}),
    Truth("autopilot-54", 0.06, 1.0265),
    Truth("autopilot-58", 0.04, 1.0265),
    Truth(
        "arduplane-elevon",
        0.14,
        at_one_m_s={"Z_alpha": -0.320, "M_alpha": -0.0715, "M_q": -0.159, "M_delta_e": -0.1213},
    ),
    Truth(
        "uav-calm-manual",
        0.14,
        at_one_m_s={"Z_alpha": -0.3069, "M_alpha": -0.0709, "M_q": -0.1621, "M_delta_e": -0.1494},
    ),
)


@dataclass(frozen=True)
class Row:
    """One derivative of one log."""

    log: str
    lag: str
    name: str
    value: float
    half: float
    truth: float
    lag_used: float
    accepted: str

    @property
    def off(self) -> float:
        """Relative error."""
        return self.value / self.truth - 1.0

    @property
    def inside(self) -> bool:
        """Whether the 95 % interval holds the truth."""
        return abs(self.value - self.truth) <= self.half

    @property
    def holds(self) -> bool:
        """Whether the estimate is near the truth, or its interval holds the truth."""
        return self.inside or abs(self.off) <= NEAR


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table; 1 where a row does not hold."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--only", nargs="*", default=[])
    given = parser.parse_args(arguments)
    rows = []
    print("| log | lag | lag used | accepted | derivative | estimate | truth | off | inside | holds |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    for truth in TRUTHS:
        path = next((p for f in given.folders for p in f.glob(f"{truth.log}.*") if p.suffix != ".yaml"), None)
        if path is None or (given.only and truth.log not in given.only):
            continue
        for row in _rows(truth, path):
            rows.append(row)
            print(
                f"| {row.log} | {row.lag} | {row.lag_used:.3f} | {row.accepted} | {row.name}"
                f" | {row.value:.2f} ± {row.half:.2f} | {row.truth:.2f} | {100 * row.off:+.1f} %"
                f" | {'yes' if row.inside else 'no'} | {'yes' if row.holds else '**no**'} |",
                flush=True,
            )
    print(
        f"\n{sum(row.holds for row in rows)} of {len(rows)} hold; {sum(row.inside for row in rows)} inside."
    )
    return 0 if all(row.holds for row in rows) else 1


def _rows(truth: Truth, path: Path) -> Iterator[Row]:
    beside = path.with_suffix(".yaml")
    described = (
        load_aircraft(beside)
        if beside.exists()
        else (Aircraft() if "elevon" in truth.log else _of_the_base())
    )
    stated = described.elevator.lag_s if described.elevator.lag_s is not None else truth.lag_s
    for word, lag_s in (("given", stated), ("unknown", None)):
        aircraft = replace(described, elevator=replace(described.elevator, lag_s=lag_s))
        found = judge(read(path, aircraft))
        yield from _compared(truth, word, described, found)


def _of_the_base() -> Aircraft:
    """Return the aircraft of a log that has no file."""
    return Aircraft(elevator=Elevator(calibration=((1000.0, 25.0), (1500.0, 0.0), (2000.0, -25.0))))


def _compared(truth: Truth, word: str, described: Aircraft, found: CampaignState) -> Iterator[Row]:
    model = found.model
    accepted = sum(judged.verdict.accepted for judged in found.maneuvers)
    stopped = found.flight_test.stopped_at
    counted = f"{accepted}/{len(found.maneuvers)}" + (f" STOP {stopped}" if stopped else "")
    if model is None or model.airspeed_m_s is None:
        return
    for name in SHOWN:
        if name in truth.skipped:
            continue
        value, half = model.value(name), NORMAL_95 * float(model.std[PARAMETERS.index(name)])
        speed = TRUE_OVER_STANDARD * model.airspeed_m_s
        if truth.at_one_m_s:
            true = truth.at_one_m_s[name] * speed ** POWERS[name]
        else:
            stated = truth.true_over_read * (described.reference_airspeed_m_s or model.airspeed_m_s)
            ratio = speed / stated
            true = truth.factors.get(name, 1.0) * described.model[name] * ratio ** POWERS[name]
        yield Row(truth.log, word, name, value, half, true, model.servo_lag_s, counted)


if __name__ == "__main__":
    sys.exit(main())
