"""Blind flights of roll and yaw with one withheld effect each, and how many are diagnosed right.

    python -m benchmarks.lateral_gap SEED [--each 3] [--clean 6] [--only NAME ...] [--pairs 0] [--air 0]
        [--outside 0] [--jsbsim]

The bundled aircraft flies ``--plan lateral`` with a drawn effect, and is recorded at 50 Hz. The diagnosis of
``advisor gap --axis lateral`` has the aircraft's true derivatives. With ``--jsbsim``, JSBSim's c172p flies
the plan, and c172p without the effect is the user's simulator. A size counts as right within its 95 %
interval or 15 %.
"""

import argparse
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from advisor.aircraft.aircraft import Aircraft, SideControl
from advisor.aircraft.reference import SIDE_PARAMETERS
from advisor.flight.maneuvers.maneuver import Maneuver, Span
from advisor.flight.signals.record import Channel
from advisor.gap.axis.comparison import compare_axis
from advisor.gap.axis.diagnosis import diagnose_axis
from advisor.gap.axis.models import case_of
from advisor.gap.result import Diagnosis
from advisor.model.axes.lateral import LATERAL
from advisor.oem.estimate import NoEstimate
from advisor.simulators.axes.side_difference import side_without_difference
from advisor.simulators.specification import simulator_of
from advisor.words.quantities import NORMAL_95
from benchmarks.lateral_laws import LAWS, flight_with
from sim.effects.side import side_kit
from sim.flight import Flight, Sample
from sim.lateral import FULL_RAD, UAV, flown_laterally, lateral_flight
from sim.lateral_jsbsim import LateralJsbsim
from sim.motion import HOME_HEIGHT_M
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
    """Whether it must be named; if not, "none" is right too."""


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
    "side_turbulence": Withheld("side_gusts", "sigma_v_m_s", (0.05, 0.3), is_named=False),
}
"""Name in the simulator to what is withheld."""
KNOWN = SideControl(lag_s=0.0, delay_s=0.0)
AIRCRAFT = Aircraft(aileron=KNOWN, rudder=KNOWN, model=dict(UAV))
READ = {
    "p": "p", "r": "r", "bank": "phi", "theta": "theta", "q": "q", "a_y": "a_y", "alpha": "alpha",
    "airspeed": "airspeed",
}  # fmt: skip
"""Channel to the field of the simulator's reading."""


Effects = Mapping[str, Mapping[str, float]]
Fly = Callable[[int, Effects], Diagnosis | None]
FULL = {"aileron": FULL_RAD, "rudder": FULL_RAD}


def scenario_of(seed: int, effects: Effects) -> Scenario:
    """Return the scenario of a flight."""
    return Scenario(
        seed=seed,
        effects={name: dict(sizes) for name, sizes in effects.items()},
        lead_in_s=3.0,
        gap_s=2.0,
        settling_s=1.0,
        free_s=2.2,
        closing_s=1.0,
        step_s=0.0025,
    )


def diagnosed(seed: int, effects: Effects) -> Diagnosis | None:
    """Fly effects, and return the diagnosis."""
    return diagnosis_of(recordings(lateral_flight(scenario_of(seed, effects))))


def diagnosis_of(flight: Sequence[Maneuver]) -> Diagnosis | None:
    """Return the diagnosis of manoeuvres with the aircraft's true derivatives."""
    case = case_of(LATERAL, flight, AIRCRAFT, np.array([UAV[name] for name in SIDE_PARAMETERS]))
    assert not isinstance(case, NoEstimate)
    return diagnose_axis(case)


def diagnosed_in_jsbsim(seed: int, effects: Effects) -> Diagnosis | None:
    """Fly effects with JSBSim's c172p, and return the diagnosis against c172p without them."""
    scenario = replace(
        scenario_of(seed, effects), engine="jsbsim", aircraft="c172p", height_m=1200.0, step_s=0.005
    )
    kit = side_kit(seed, scenario.effects)
    engine = LateralJsbsim("c172p", 53.0, scenario.height_m, scenario.step_s, kit)
    flight = recordings(flown_laterally(scenario, engine, kit, slower=SLOWER), engine.full_rad)
    simulator = simulator_of("jsbsim:c172p", Aircraft(), lambda _: [])
    try:
        beside, as_file = side_without_difference(flight, simulator, Aircraft(aileron=KNOWN, rudder=KNOWN))
    finally:
        simulator.close()
    found = compare_axis(LATERAL, beside, as_file)
    assert not isinstance(found, NoEstimate)
    return found if found.evidence else None


SLOWER = 1.6
"""Duration of the steps over those of the bundled aircraft: the Dutch roll of c172p lasts 1.6 times as
long."""


def recordings(flight: Flight, full_rad: Mapping[str, float] = FULL) -> list[Maneuver]:
    """Return the manoeuvres of the lateral plan; ``full_rad`` is the deflection at full demand."""
    stretches: dict[float, list[Sample]] = {}
    for sample in flight.samples():
        if sample.flying is not None:
            stretches.setdefault(sample.flying.start_s, []).append(sample)
    return [recorded(k, samples, full_rad) for k, samples in enumerate(stretches.values(), 1)]


def recorded(number: int, samples: Sequence[Sample], full_rad: Mapping[str, float]) -> Maneuver:
    """Return a manoeuvre as a log holds it."""
    t = np.array([sample.time_s for sample in samples])
    told = {name: [getattr(sample.reading, field) for sample in samples] for name, field in READ.items()}
    told |= {name: [-full * getattr(sample, name) for sample in samples] for name, full in full_rad.items()}
    told["altitude"] = [HOME_HEIGHT_M + sample.motion.height for sample in samples]
    told["throttle"] = [sample.throttle for sample in samples]
    channels = {n: Channel(n, t, np.array(y, float), "HIGHRES_IMU", "measured") for n, y in told.items()}
    return Maneuver(number, 0, Span(t[0], t[0] + 1.0, t[0] + 3.0, t[-1], "other", (), "quiet"), channels)


@dataclass(frozen=True)
class Study:
    """Numbers of the flights to fly."""

    each: int
    """Flights with each effect."""
    clean: int
    """Flights with nothing."""
    pairs: int
    """Flights with two effects of different controls or outputs."""
    air: int
    """Flights in side gusts alone."""
    outside: int = 0
    """Flights with each law that no effect describes, of the bundled aircraft."""
    only: Sequence[str] = ()
    """Effects to fly; empty for all."""


def rows(seed: int, study: Study, fly: Fly) -> Iterator[str]:
    """Yield a row a flight, then the counts; ``fly`` flies effects and diagnoses them."""
    rng = np.random.default_rng(seed)
    right = named = false = size_right = 0

    def drawn(name: str) -> float:
        sign = rng.choice([-1.0, 1.0]) if "scale" in name else 1.0
        return float(rng.uniform(*CASES[name].sizes) * sign)

    singles = [name for _ in range(study.each) for name in CASES if not study.only or name in study.only]
    for name in [*singles, *("side_turbulence" for _ in range(study.air))]:
        case, size = CASES[name], drawn(name)
        told, holds, fits = judged(fly(int(rng.integers(2**31)), {name: {case.parameter: size}}), case, size)
        if case.is_named:
            named, right, size_right = named + 1, right + holds, size_right + fits
        else:
            false += not holds
        yield f"| {name} | {size:.3g} | {told} | {'yes' if holds else 'NO'} | {'yes' if fits else 'no'} |"
    for _ in range(study.clean):
        told, holds, _ = judged(fly(int(rng.integers(2**31)), {}), NOTHING, 0.0)
        false += not holds
        yield f"| nothing | | {told} | {'yes' if holds else 'NO'} | |"
    unknown = 0
    for law in [law for law in LAWS for _ in range(study.outside)]:
        flight, size = flight_with(scenario_of(int(rng.integers(2**31)), {}), law, rng)
        answer = diagnosis_of(recordings(flight))
        holds = answer is not None and answer.verdict == "unknown"
        unknown += holds
        shares = None if answer is None else answer.probabilities
        lacking = 0.0 if shares is None else sum(shares.unknown.values())
        told = "no answer" if answer is None else f"{answer.verdict} (unknown {lacking:.2f})"
        yield f"| {law} | {size:.3g} | {told} | {'yes' if holds else 'NO'} | |"
    both = one = 0
    able = [name for name, case in CASES.items() if case.is_named]
    for _ in range(study.pairs):
        names = [able[int(k)] for k in rng.choice(len(able), 2, replace=False)]
        sizes = {name: drawn(name) for name in names}
        effects = {name: {CASES[name].parameter: size} for name, size in sizes.items()}
        told, found = pair_judged(fly(int(rng.integers(2**31)), effects), names)
        both, one = both + (found == len(names)), one + (found > 0)
        listed = ", ".join(f"{size:.3g}" for size in sizes.values())
        yield f"| {' + '.join(names)} | {listed} | {told} | {found} of 2 | |"
    yield (
        f"{right} of {named} effects named, {size_right} with the right size; {false} false alarms; "
        f"{unknown} of {study.outside * len(LAWS)} laws without a name are unknown; of "
        f"{study.pairs} pairs {both} named whole, {one} at least by half"
    )


NOTHING = Withheld("", "", (0.0, 0.0), is_named=False)


def judged(found: Diagnosis | None, case: Withheld, size: float) -> tuple[str, bool, bool]:
    """Return the answer in words, whether it is right, and whether its size is."""
    if found is None:
        return "no answer", False, False
    if found.verdict != "effect":
        shares = found.probabilities
        assert shares is not None
        said = f"{found.verdict} ({shares.none:.2f}, {shares.parameters:.2f})"
        return said, not case.is_named and found.verdict == "none", False
    present = [one for one in found.causes if one.present]
    first = present[0].parameters
    told = first[next(iter(first))]
    near = abs(told.value - size) <= max(NORMAL_95 * told.std, 0.15 * abs(size))
    holds = [one.name for one in present] == [case.name]
    return said_of(found), holds, holds and near


def pair_judged(found: Diagnosis | None, names: Sequence[str]) -> tuple[str, int]:
    """Return the answer in words, and how many of the effects it names; one that is not there costs all."""
    if found is None or found.verdict != "effect":
        return "none" if found is None else found.verdict, 0
    told = {one.name for one in found.causes if one.present}
    right = {CASES[name].name for name in names}
    return said_of(found), 0 if told - right else len(told)


def said_of(found: Diagnosis) -> str:
    """Return the effects of the model with their first size and probability."""
    return "; ".join(
        f"{one.name} {value.value:.3g} ± {NORMAL_95 * value.std:.2g} ({one.probability:.2f})"
        for one in found.causes
        if one.present
        for value in list(one.parameters.values())[:1]
    )


def main() -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("seed", type=int)
    parser.add_argument("--each", type=int, default=3)
    parser.add_argument("--clean", type=int, default=6)
    parser.add_argument("--only", nargs="*", default=[])
    parser.add_argument("--pairs", type=int, default=0)
    parser.add_argument("--air", type=int, default=0)
    parser.add_argument("--outside", type=int, default=0)
    parser.add_argument("--jsbsim", action="store_true")
    asked = parser.parse_args()
    fly = diagnosed_in_jsbsim if asked.jsbsim else diagnosed
    print("| withheld | size | told | right | size |\n|---|---|---|---|---|")
    study = Study(asked.each, asked.clean, asked.pairs, asked.air, asked.outside, asked.only)
    for row in rows(asked.seed, study, fly):
        print(row, flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
