"""The files of a case: the log and the aircraft file that the diagnosis sees, the truth that it does not."""

from collections.abc import Iterator
from dataclasses import asdict, replace
from typing import Any

import numpy as np

from benchmarks.sealed import generator
from benchmarks.sealed.tlog import tlog
from sim.sealed.cases import SealedCase

from .design import assignments
from .draw import Case, draw_case, largest_speed_change
from .nature import SHARE, in_the_world
from .telemetry import quieter, record
from .trim import linearised


def cases(
    count: int, seed: int, only: str | None = None, natural_share: float = SHARE, noise_factor: float = 0.0
) -> Iterator[SealedCase]:
    """Yield ``count`` cases, each flown; a share of them has natural nuisances.

    With a ``noise_factor`` filters act in every flight, and the noise is smaller by down to that factor.
    """
    for index, assignment in enumerate(assignments(count, seed, only), start=1):
        case = draw_case(assignment, seed, index, natural_share)
        if noise_factor:
            factor = generator.quiet_factor(case.record_seed, noise_factor)
            case = replace(case, nature=in_the_world(case.nature), noise=quieter(case.noise, factor))
        yield SealedCase(f"{index:04d}", truth(case), log_bytes(case), aircraft_file(case))


def log_bytes(case: Case) -> bytes:
    """The case's tlog."""
    rng = np.random.default_rng(case.record_seed + 1)
    time = case.experiment.time
    shown = case.nature.shown(case.flown.observed, float(time[1] - time[0]))
    streams = case.nature.sent(record(time, shown, case.flown.truth, case.recorder, case.noise, rng))
    elevation_m = case.experiment.aircraft.elevation_m
    return tlog(streams, case.wiring, elevation_m, stated=case.nature.parameters)


def aircraft_file(case: Case) -> dict[str, Any]:
    """The case's aircraft file: what a crew knows."""
    aircraft = case.experiment.aircraft
    return generator.aircraft_file(
        name="test aircraft",
        calibration=case.wiring.calibration,
        servo=(None, None),
        arms_m=(case.stated_arms["vane"], case.stated_arms["accelerometer"]),
        airspeed_m_s=case.nature.indicated * aircraft.airspeed_m_s,
        reference=(
            aircraft.mass_kg, aircraft.wing_area_m2, aircraft.chord_m, aircraft.pitch_inertia_kg_m2,
        ),
        model=None if case.believed is None else case.believed.as_dict(),
    )  # fmt: skip


def truth(case: Case) -> dict[str, Any]:
    """What is true about the case, SI units."""
    experiment, recorder = case.experiment, case.recorder
    return generator.truth(
        case.assignment.kind,
        "filtered" if recorder.low_pass is not None else "hard" if case.troubles else "clean",
        [(s.effect.name, s.effect.block, s.parameters) for s in case.effects],
        background=["turbulence"] if "turbulence" in case.troubles else [],
        sized=[
            {
                "effect": s.effect.name, "dynamic": s.effect.dynamic, "size": s.size,
                "parameters": s.parameters, "ratios": s.ratios, "dynamic_ratios": s.dynamic_ratios,
            }
            for s in case.effects
        ],
        troubles=list(case.troubles),
        background_turbulence_rms_m_s=case.background_rms,
        recorder=asdict(recorder),
        command="linear" if experiment.link.period == 1 else "held",
        largest_speed_change=largest_speed_change(experiment.plan, case.flown),
        aircraft=asdict(experiment.aircraft),
        linear_model=linearised(experiment.model, _flown_m(case)).as_dict(),
        believed_model=None if case.believed is None else case.believed.as_dict(),
        stated_arms_m=case.stated_arms,
        noise=asdict(case.noise),
        nature=asdict(case.nature),
        wiring=asdict(case.wiring),
        maneuvers=[asdict(maneuver) for maneuver in experiment.plan.maneuvers],
    )  # fmt: skip


def _flown_m(case: Case) -> float:
    """Return the mean height of the manoeuvres, m. Low above the ground the air is 1 % denser than at the
    trim."""
    parts = case.experiment.plan.during_maneuvers()
    return float(np.mean([np.mean(case.flown.truth.height[part]) for part in parts]))
