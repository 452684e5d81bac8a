"""The files of a case: the log and the aircraft file that the diagnosis sees, the truth that it does not."""

from collections.abc import Iterator
from dataclasses import asdict, replace
from typing import Any

import numpy as np

from benchmarks.sealed import generator
from benchmarks.sealed.tlog import MANUAL, STABILIZE, tlog
from sim.sealed.cases import SealedCase

from .cases import EFFECTS, Case, assignments, draw_case
from .nature import SHARE, USUAL_FILTER_HZ, Nature, drawn
from .plan import as_key
from .recording import record
from .trim import short_period

LATE = ("alpha_skew", "alpha_lag")
"""Names that are true of an angle of attack that the autopilot makes itself."""


def cases(
    count: int, seed: int, only: str | None = None, natural_share: float = SHARE, noise_factor: float = 0.0
) -> Iterator[SealedCase]:
    """Yield ``count`` cases, each flown; a share of them has natural nuisances.

    With a ``noise_factor`` filters act in every flight, and the noise is smaller by down to that factor.
    """
    for index, assignment in enumerate(assignments(count, seed, only), start=1):
        case = draw_case(assignment, seed, index)
        above_sea_m = case.ground_m + case.setup.plan.aircraft.height_m
        nature = drawn(np.random.default_rng([case.noise_seed, 3]), above_sea_m, natural_share)
        if noise_factor:
            nature = replace(nature, filter_hz=nature.filter_hz or USUAL_FILTER_HZ)
            case = quieter(case, generator.quiet_factor(case.noise_seed, noise_factor))
        told = truth(case) | {"nature": nature.facts()}
        yield SealedCase(f"{index:04d}", told, log_bytes(case, nature), aircraft_file(case, nature))


def quieter(case: Case, factor: float) -> Case:
    """Return the case with the noise of its instruments times a factor."""
    kit = case.setup.kit
    noise = {channel: factor * std for channel, std in kit.noise.items()}
    return replace(case, setup=replace(case.setup, kit=replace(kit, noise=noise)))


def log_bytes(case: Case, nature: Nature) -> bytes:
    """The case's log."""
    rng = np.random.default_rng(case.noise_seed)
    streams = nature.stamped(record(nature.measured(case.shown), case.setup.kit, rng))
    mode = STABILIZE if case.setup.plan.gains.damper > 0.0 else MANUAL
    return tlog(streams, case.wiring, case.ground_m, mode, nature.parameters())


def aircraft_file(case: Case, nature: Nature) -> dict[str, Any]:
    """What a crew knows of its aircraft; a servo without a stated lag has none."""
    plan, kit, servo = case.setup.plan, case.setup.kit, case.setup.servo
    return generator.aircraft_file(
        name=plan.aircraft.name,
        calibration=case.wiring.calibration,
        servo=(servo.lag_s, servo.delay_s) if servo.lag_s > 0.0 else (None, None),
        arms_m=(kit.vane_arm_m, kit.stated_imu_arm_m),
        airspeed_m_s=nature.pitot * plan.aircraft.airspeed_m_s,
        reference=(plan.shape.mass, plan.shape.area, plan.shape.chord, plan.shape.inertia),
        model=case.believed,
    )


def _equipment(case: Case) -> str:
    if case.setup.kit.boom:
        return "boom"
    return "autopilot" if case.setup.kit.sends_alpha else "no alpha"


def truth(case: Case) -> dict[str, Any]:
    """What is true of a case, SI units."""
    kit, turbulent = case.setup.kit, case.turbulence_rms > 0.0
    own, damping = short_period(case.setup.plan.model)
    # What no change of the derivatives explains, over all channels: the gap of the effect that shows least.
    gaps = [float(np.mean(np.square(list(w.seen["beyond_parameters"].values())))) for w in case.wrong]
    return generator.truth(
        case.assignment.kind,
        f"{_equipment(case)}, {'turbulent' if turbulent else 'calm'}",
        [(w.name, EFFECTS[w.name].block, w.parameters) for w in case.wrong],
        background=["turbulence"] if turbulent else [],
        gap=min(gaps, default=0.0),
        also_true=LATE if kit.sends_alpha and not kit.boom else (),
        sized=[asdict(w) for w in case.wrong],
        troubles=list(case.troubles),
        background_turbulence_rms_m_s=case.turbulence_rms,
        believed_model=case.believed,
        short_period={"natural_frequency_rad_s": own, "damping_ratio": damping},
        instruments=asdict(kit),
        servo={"lag_s": case.setup.servo.lag_s, "delay_s": case.setup.servo.delay_s},
        boot_s=case.wiring.boot_s,
        **as_key(case.setup.plan),
    )
