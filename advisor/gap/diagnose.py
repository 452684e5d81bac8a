"""The diagnosis: where the gap lies, which effect causes it, how far it shrinks without it."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from advisor.aircraft import PARAMETERS, Aircraft
from advisor.flight.kinematics import SMALLEST_BIAS_RAD, check_alpha, combine
from advisor.flight.maneuver import Maneuver
from advisor.flight.messages import FloatArray
from advisor.gap.air import moving_air
from advisor.gap.airspeed import speed_of_the_motion
from advisor.gap.answer import answer
from advisor.gap.baseline import fit_baseline
from advisor.gap.candidates.catalogue import variants_for
from advisor.gap.causes import OFFSET_SIGMAS
from advisor.gap.command import is_likelier_held, may_be_held, read_as_held
from advisor.gap.data import prepare
from advisor.gap.evidence import Evidence
from advisor.gap.fit import Fitted, solve_blocks
from advisor.gap.flights import Flights
from advisor.gap.floor import prefiltered, stated_floor
from advisor.gap.holdout import HeldOut, held_out
from advisor.gap.known import beyond_known
from advisor.gap.layout import DERIVATIVES
from advisor.gap.leftover import Leftover, is_the_gust, left_over, of_the_wind, other_than_air, swinging
from advisor.gap.linear import linearise
from advisor.gap.noise import quiet_rms
from advisor.gap.notes import left_out
from advisor.gap.problem import Problem
from advisor.gap.remainder import is_of_no_use, remainder
from advisor.gap.result import Diagnosis
from advisor.gap.speed import at_constant_speed
from advisor.gap.stamps import stamp_power
from advisor.gap.uncertainty import worth
from advisor.gap.unnamed import unnamed_law
from advisor.gap.variant import Variant
from advisor.gap.wander import wandering_sensor
from advisor.gap.waterfall import Progress, Stage, as_measured, build_up, reduced_to
from advisor.gap.weight import weight_carried
from advisor.gap.wind import wind_shear
from advisor.problems import UnusableInputError


def diagnose(
    maneuvers: Sequence[Maneuver],
    aircraft: Aircraft,
    holdout: int | None = None,
    progress: Progress = lambda *_: None,
) -> Diagnosis:
    """Diagnose the sim-to-real gap from flown manoeuvres.

    Parameters
    ----------
    maneuvers
        As the segmenter found them; at least two with elevator, α and pitch rate.
    aircraft
        The aircraft file: what the simulator believes today.
    holdout
        How many manoeuvres, the last ones, the shrink is measured on, with every number fitted without them
        (which effects are there is judged on all); None: all, each kept out in turn with a third of them.
    progress
        Called with a sentence and the share done.

    Raises
    ------
    UnusableInputError
        Too few manoeuvres, or no angle of attack.
    """
    progress("checking the angle of attack against the motion", 0.0)
    aircraft = _with_speed(maneuvers, aircraft)
    offset = aircraft.effects.get("alpha_bias", {}).get("bias_rad", 0.0)
    maneuvers = [_without_offset(m, offset) for m in maneuvers]
    flights = prepare(maneuvers, aircraft)
    _refuse(flights)
    arms = aircraft.accelerometer.arm_m, aircraft.alpha.vane_arm_m
    numbers = {flight.number for flight in flights.flights}
    flown = [m for m in maneuvers if m.number in numbers]
    kinematics = combine([check_alpha(m, aircraft.airspeed_m_s, *arms) for m in flown])
    progress("fitting the simulator's model", 0.1)
    if abs(kinematics.bias_rad) > max(SMALLEST_BIAS_RAD, OFFSET_SIGMAS * kinematics.bias_std_rad):
        # What the climb rate shows is taken out first, else the trim would carry it into the lift.
        flights = prepare([_without_offset(m, kinematics.bias_rad) for m in maneuvers], aircraft)
    problem, baseline = fit_baseline(flights, aircraft)
    evidence = _explain(problem, baseline, aircraft, progress)
    shear = wind_shear(flown)
    if shear is not None and not _of_the_attitude(evidence.leftover):
        # Air that moves swings the air speed, too: beside it what is not plain is worth a note, no more.
        is_there = evidence.air is None or shear.is_plain
        leftover = of_the_wind(evidence.leftover) if is_there else evidence.leftover
        evidence = replace(evidence, shear=shear, leftover=leftover)
    weight = weight_carried(flown, problem.flights.reference_m_s)
    evidence = replace(evidence, weight=weight)
    if weight is not None and evidence.leftover is None and len(evidence.stages) == 1:
        at_fault = Leftover("accelerometer", 1.0, (("accelerometer", 1.0),))
        evidence = replace(evidence, leftover=at_fault)
    progress("measuring the gap", 0.9)
    diagnosis = answer(evidence, aircraft, kinematics, holdout)
    missing = left_out([m.number for m in maneuvers if m.number not in numbers])
    return replace(diagnosis, notes=(*diagnosis.notes, *missing))


def _refuse(flights: Flights) -> None:
    if len(flights) < 2:
        raise UnusableInputError(
            "no_maneuver",
            f"{len(flights)} usable manoeuvre{'s' if len(flights) != 1 else ''} in the log: "
            "a cause cannot be proved without manoeuvres kept out of the fit.",
            "Fly at least three elevator manoeuvres (3-2-1-1 or doublets), better nine.",
        )
    if "alpha" not in flights.channels:
        raise UnusableInputError(
            "no_alpha",
            "No angle of attack in the log.",
            "Log AOA_SSA, or set alpha.source in the aircraft file.",
        )


def _with_speed(maneuvers: Sequence[Maneuver], aircraft: Aircraft) -> Aircraft:
    """The aircraft with the speed that its motion shows, where neither file nor every manoeuvre has one."""
    known = aircraft.airspeed_m_s or aircraft.reference_airspeed_m_s
    if known or all("airspeed" in m.channels for m in maneuvers):
        return aircraft
    return replace(aircraft, airspeed_m_s=speed_of_the_motion(maneuvers))


def _without_offset(maneuver: Maneuver, offset: float) -> Maneuver:
    """The manoeuvre with a constant taken off its angle of attack."""
    channels = dict(maneuver.channels)
    if "alpha" in channels:
        channels["alpha"] = replace(channels["alpha"], y=channels["alpha"].y - offset)
    return replace(maneuver, channels=channels)


def _explain(problem: Problem, baseline: Fitted, aircraft: Aircraft, progress: Progress) -> Evidence:
    """Build the model up, then look at what is left: the air, and whatever the motion still predicts."""
    variants = beyond_known(aircraft.effects, variants_for(problem.flights))
    white = stated_floor(problem.flights)
    problem, stages = _named(problem, baseline, variants, progress)
    law = unnamed_law(problem, stages)
    if law is not None:
        stages = reduced_to(problem, stages, [])
    air = None
    last = stages[-1].fitted
    samples = sum(len(f.outputs["q"].t) for f in problem.flights.flights)
    if problem.knows_the_noise or np.min(worth(problem, last.innovations)) < 0.5 * samples:
        progress("looking at the air", 0.7)
        air = moving_air(problem, last)
    if air is not None:
        named = [s.added for s in stages if s.added is not None]
        kept = [judged.effect for judged in named if not air.may_be(judged)]
        if len(kept) < len(named):
            stages = reduced_to(problem, stages, kept)
            last = stages[-1].fitted
            air = moving_air(problem, last)
    progress("looking for what has no name", 0.8)
    smooth = prefiltered(problem.flights)
    stated = np.array([white[k] if smooth[c] else 0.0 for k, c in enumerate(problem.channels)])
    leftover = left_over(problem, stages[0].fitted, last, stated, moving_air=air is not None)
    if air is not None and air.gust and leftover is not None and is_the_gust(problem, last, leftover):
        leftover = None
    elif air is not None and (leftover is None or leftover.block == "air"):
        leftover = other_than_air(problem, stages[0].fitted, last)
    # The filter takes a swing for noise: as a line it is seen, and placed, better than by any other sign.
    leftover = law or swinging(problem, stages[0].fitted, last, stated) or leftover
    stages = as_measured(problem, stages)
    # Stamps that jitter are the instruments', too, but show only where something moves.
    measured = quiet_rms(problem, last) ** 2 + stamp_power(problem, last)
    floor = np.sqrt(np.minimum(measured, stages[-1].held_out.mean_square))
    file_model = _file_model(problem, stages[0].fitted, aircraft)
    if leftover is None and air is None:
        leftover = remainder(problem, stages, np.maximum(floor, stated))
        if leftover is None and len(stages) == 1:
            leftover = wandering_sensor(problem, last)
        if leftover is None and is_of_no_use(problem, stages, file_model, np.maximum(floor, stated)):
            stages = reduced_to(problem, stages, [])
            last = stages[-1].fitted
    if leftover is not None and leftover.in_quiet is not None:
        floor = np.sqrt(np.maximum(floor**2 - leftover.in_quiet, white**2))
    return Evidence(
        problem,
        stages,
        leftover,
        air,
        np.maximum(floor, stated),
        file_model,
        at_constant_speed(problem, last),
        stated,
    )


def _named(
    problem: Problem, baseline: Fitted, variants: Sequence[Variant], progress: Progress
) -> tuple[Problem, list[Stage]]:
    """The model built up, with the command held instead of linear where that names the likelier effects."""
    stages = build_up(problem, baseline, variants, progress)
    seen = stages[0].rivals | {s.added.effect for s in stages if s.added is not None}
    if may_be_held(problem, stages[-1].fitted, seen):
        held, plain = read_as_held(problem, baseline)
        others = build_up(held, plain, variants, progress)
        if is_likelier_held(problem, stages[-1].fitted, held, others[-1].fitted):
            return held, others
    return problem, stages


def _of_the_attitude(leftover: Leftover | None) -> bool:
    """An attitude that is wrong feigns wind that changes with height, for the climb is computed from it."""
    return leftover is not None and leftover.block == "attitude_sensor"


def _file_model(problem: Problem, baseline: Fitted, aircraft: Aircraft) -> HeldOut | None:
    """How the aircraft file's own parameters do, only initial states, trim and offsets refitted."""
    if any(name not in aircraft.model for name in PARAMETERS):
        return None
    point = replace(baseline.point, derivatives=np.array([aircraft.model[name] for name in DERIVATIVES]))
    lefts: list[FloatArray] = []
    for _ in range(3):
        linear = linearise(problem, point)
        owns = solve_blocks(problem, linear, 1.0 / baseline.noise, point).free
        still = np.zeros(len(point.shared))
        lefts = [block.measured.after(still, own) for block, own in zip(linear, owns, strict=True)]
        point = replace(point, own=point.own + np.array([o[:4] for o in owns]))
    return held_out(problem, lefts)
