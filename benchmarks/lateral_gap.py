"""Blind flights of roll and yaw with one withheld effect each, and how many are diagnosed right.

    python -m benchmarks.lateral_gap SEED [--each 3] [--clean 6] [--only NAME ...]

The bundled aircraft flies ``--plan lateral`` with a drawn effect, and is recorded at 50 Hz. The diagnosis of
``advisor gap --axis lateral`` has the aircraft's true derivatives. A size counts as right within its 95 %
interval or 15 %.
"""

import argparse
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.controls import SideControl
from advisor.aircraft.reference import SIDE_PARAMETERS
from advisor.flight.maneuvers.maneuver import Maneuver, Span
from advisor.flight.signals.record import Channel
from advisor.oem.estimate import NoEstimate
from advisor.side_gap.diagnosis import SideDiagnosis, diagnose_side
from advisor.side_gap.models import case_of
from advisor.words.quantiles import NORMAL_95
from sim.flight import Sample
from sim.lateral import FULL_RAD, UAV, lateral_flight
from sim.scenario import Scenario


@dataclass(frozen=True)
class Withheld:
    """One effect of the simulator, by its name in ``sim.effects.side``."""

    name: str
    """Name in the diagnosis."""
    parameter: str
    """First parameter of the simulator and of the diagnosis."""
    sizes: tuple[float, float]
    """Least and greatest size, SI."""
    is_named: bool = True
    """Whether the diagnosis has a name for it; if not, "none" is right."""


_SERVO = {
    "actuator_lag": ("lag_s", (0.03, 0.09)),
    "transport_delay": ("delay_s", (0.06, 0.12)),
    "actuator_rate_limit": ("rate_rad_s", (0.4, 0.9)),
    "actuator_backlash": ("half_width_rad", (0.005, 0.015)),
    "actuator_deadband": ("half_width_rad", (0.005, 0.015)),
}
CASES: dict[str, Withheld] = {
    **{f"{c}_{n}": Withheld(f"{c}_{n}", p, s) for c in ("aileron", "rudder") for n, (p, s) in _SERVO.items()},
    "p_skew": Withheld("late_roll_rate_stamps", "skew_s", (0.04, 0.09)),
    "r_skew": Withheld("late_yaw_rate_stamps", "skew_s", (0.04, 0.09)),
    "phi_skew": Withheld("late_attitude_stamps", "skew_s", (0.12, 0.2)),
    "a_y_skew": Withheld("late_accelerometer_stamps", "skew_s", (0.12, 0.2)),
    "p_scale": Withheld("roll_rate_scale", "scale", (0.06, 0.15)),
    "r_scale": Withheld("yaw_rate_scale", "scale", (0.06, 0.15)),
    "a_y_scale": Withheld("lateral_acceleration_scale", "scale", (0.06, 0.15)),
    "accelerometer_offset": Withheld("accelerometer_offset", "arm_m", (0.2, 0.5)),
    "propeller_roll": Withheld("propeller_roll", "aileron_rad", (0.03, 0.08)),
    "side_turbulence": Withheld("", "sigma_v_m_s", (0.05, 0.3), is_named=False),
}
"""Name in the simulator to what is withheld."""
KNOWN = SideControl(lag_s=0.0, delay_s=0.0)
AIRCRAFT = Aircraft(aileron=KNOWN, rudder=KNOWN, model=dict(UAV))
READ = {
    "p": "p", "r": "r", "bank": "phi", "theta": "theta", "q": "q", "a_y": "a_y", "alpha": "alpha",
    "airspeed": "airspeed",
}  # fmt: skip
"""Channel to the field of the simulator's reading."""


def diagnosed(seed: int, effects: Mapping[str, Mapping[str, float]]) -> SideDiagnosis | None:
    """Fly effects, and return the diagnosis."""
    scenario = Scenario(
        seed=seed,
        effects={name: dict(sizes) for name, sizes in effects.items()},
        lead_in_s=3.0,
        gap_s=2.0,
        settling_s=1.0,
        free_s=2.2,
        closing_s=1.0,
        step_s=0.0025,
    )
    case = case_of(flown(scenario), AIRCRAFT, np.array([UAV[name] for name in SIDE_PARAMETERS]))
    assert not isinstance(case, NoEstimate)
    return diagnose_side(case)


def flown(scenario: Scenario) -> list[Maneuver]:
    """Return the manoeuvres of the lateral plan."""
    stretches: dict[float, list[Sample]] = {}
    for sample in lateral_flight(scenario).samples():
        if sample.flying is not None:
            stretches.setdefault(sample.flying.start_s, []).append(sample)
    return [recorded(k, samples) for k, samples in enumerate(stretches.values(), 1)]


def recorded(number: int, samples: Sequence[Sample]) -> Maneuver:
    """Return a manoeuvre as a log holds it."""
    t = np.array([sample.time_s for sample in samples])
    told = {name: [getattr(sample.reading, field) for sample in samples] for name, field in READ.items()}
    told |= {
        name: [-FULL_RAD * getattr(sample, name) for sample in samples] for name in ("aileron", "rudder")
    }
    told["throttle"] = [sample.throttle for sample in samples]
    channels = {n: Channel(n, t, np.array(y, float), "HIGHRES_IMU", "measured") for n, y in told.items()}
    return Maneuver(number, 0, Span(t[0], t[0] + 1.0, t[0] + 3.0, t[-1], "other", (), "quiet"), channels)


def rows(seed: int, each: int, clean: int, only: list[str]) -> Iterator[str]:
    """Yield a row a flight, then the counts."""
    rng = np.random.default_rng(seed)
    right = named = false = size_right = 0
    for _ in range(each):
        for name, case in CASES.items():
            size = float(rng.uniform(*case.sizes)) * (rng.choice([-1.0, 1.0]) if "scale" in name else 1.0)
            flight = int(rng.integers(2**31))
            if only and name not in only:
                continue
            found = diagnosed(flight, {name: {case.parameter: size}})
            told, holds, fits = judged(found, case, size)
            if case.is_named:
                named, right, size_right = named + 1, right + holds, size_right + fits
            else:
                false += not holds
            yield f"| {name} | {size:.3g} | {told} | {'yes' if holds else 'NO'} | {'yes' if fits else 'no'} |"
    for _ in range(0 if only else clean):
        found = diagnosed(int(rng.integers(2**31)), {})
        told, holds, _ = judged(found, Withheld("", "", (0.0, 0.0), is_named=False), 0.0)
        false += not holds
        yield f"| nothing | | {told} | {'yes' if holds else 'NO'} | |"
    yield f"{right} of {named} effects named, {size_right} with the right size; {false} false alarms"


def judged(found: SideDiagnosis | None, case: Withheld, size: float) -> tuple[str, bool, bool]:
    """Return the answer in words, whether it is right, and whether its size is."""
    if found is None:
        return "no answer", False, False
    if found.verdict != "effect":
        said = f"{found.verdict} ({found.none:.2f}, {found.parameters:.2f})"
        return said, not case.is_named and found.verdict == "none", False
    first = found.causes[0]
    told = first.cause.parameters[next(iter(first.cause.parameters))]
    near = abs(told.value - size) <= max(NORMAL_95 * told.std, 0.15 * abs(size))
    said = f"{first.name} {told.value:.3g} ± {NORMAL_95 * told.std:.2g} ({first.cause.probability:.2f})"
    holds = case.is_named and first.name == case.name
    return said, holds, holds and near


def main() -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("seed", type=int)
    parser.add_argument("--each", type=int, default=3)
    parser.add_argument("--clean", type=int, default=6)
    parser.add_argument("--only", nargs="*", default=[])
    asked = parser.parse_args()
    print("| withheld | size | told | right | size |\n|---|---|---|---|---|")
    for row in rows(asked.seed, asked.each, asked.clean, asked.only):
        print(row, flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
