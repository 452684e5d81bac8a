"""From the plain model to the evidence: effects are added, then what is left is looked at."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from advisor.aircraft import Aircraft
from advisor.flight.messages import FloatArray
from advisor.gap.candidates.catalogue import variants_for
from advisor.gap.candidates.known import beyond_known
from advisor.gap.candidates.variant import Variant
from advisor.gap.fitting.fit import Fitted
from advisor.gap.fitting.holdout import HeldOut, held_out
from advisor.gap.fitting.linear import linearise
from advisor.gap.fitting.problem import Problem, counts
from advisor.gap.fitting.step import solve_blocks
from advisor.gap.fitting.uncertainty import worth
from advisor.gap.noise.quiet import quiet_rms
from advisor.gap.noise.stamps import stamp_power
from advisor.gap.records.floor import stated_floor, tolerance_of
from advisor.gap.search.air import Air, gust_instead, moving_air
from advisor.gap.search.command import (
    is_likelier_held,
    is_plainer,
    may_be_held,
    may_be_linear,
    may_pay,
    read_otherwise,
)
from advisor.gap.search.speed import at_constant_speed
from advisor.gap.search.stage import Stage, added_in
from advisor.gap.search.waterfall import (
    Progress,
    as_measured,
    build_up,
    one_after_another,
    reconsidered,
    reduced_to,
)
from advisor.gap.unnamed.cross_axis import crossed_axes
from advisor.gap.unnamed.drift import drifting
from advisor.gap.unnamed.leftover import (
    Leftover,
    is_of_passing_air,
    is_the_gust,
    left_over,
    other_than_air,
)
from advisor.gap.unnamed.memory import remembering
from advisor.gap.unnamed.remainder import (
    bends_as_any,
    is_all_named,
    is_of_no_use,
    of_the_input,
    only_numbers,
    only_resemble,
    remainder,
)
from advisor.gap.unnamed.slosh import sloshing
from advisor.gap.unnamed.steps import stepping
from advisor.gap.unnamed.swing import swinging, swings_the_aircraft
from advisor.gap.unnamed.tone import ringing_hz
from advisor.gap.unnamed.true_speed import true_speed_of
from advisor.gap.unnamed.unnamed_air import unnamed_air
from advisor.gap.unnamed.unnamed_law import Law, unnamed_law
from advisor.gap.unnamed.unsteady import unsteady
from advisor.gap.unnamed.wander import wandering_attitude, wandering_sensor
from advisor.gap.verdict.evidence import Evidence

_FAR_ABOVE = 2.0
"""A floor over white noise from which on it is no longer an instrument's, with whatever memory."""
_HARDLY_DAMPED = 0.02
"""Damping ratio of a structure that rings: of bare metal, or a boom."""


def explain(problem: Problem, baseline: Fitted, aircraft: Aircraft, progress: Progress) -> Evidence:
    """Build the model up, then look at what is left: the air, and whatever the motion still predicts.

    Parameters
    ----------
    problem, baseline
        The data, and the plain model fitted to them.
    aircraft
        The aircraft file: its effects are in every model.
    progress
        Called with a sentence and the share done.
    """
    variants = beyond_known(aircraft.effects, variants_for(problem.flights))
    variants = [_begun_where_it_rings(v, problem, baseline) for v in variants]
    problem, stages, law = _named(problem, baseline, variants, progress)
    progress("looking at the air", 0.7)
    law, stages, air = _with_the_air(problem, stages, law)
    progress("looking for what has no name", 0.8)
    tolerance = tolerance_of(problem.flights)
    stages = as_measured(problem, stages)
    floor = _floor(problem, stages[-1], tolerance)
    leftover = (
        (law and law.leftover)
        or drifting(problem, stages)
        or remembering(problem, stages)
        or stepping(problem, stages[0].fitted, stages[-1].fitted)
        or wandering_attitude(problem, stages[-1].fitted)
        or crossed_axes(problem, stages[-1].fitted)
        or _without_a_name(problem, stages, air, tolerance, floor)
    )
    file_model = _file_model(problem, stages[0].fitted)
    as_any = bends_as_any(problem, stages, file_model, floor)
    if leftover is None and air is not None and (only_resemble(stages) or as_any):
        stages = reduced_to(problem, stages, [])
        air, floor = moving_air(problem, stages[0].fitted), _floor(problem, stages[0], tolerance)
        leftover = _without_a_name(problem, stages, air, tolerance, floor)
    if leftover is None and air is not None:
        leftover = unnamed_air(air, stages, floor)
    if leftover is None and not (air is not None and air.gust):
        leftover = sloshing(problem, stages[-1].fitted)
    if leftover is None and air is None:
        leftover = None if as_any else remainder(problem, stages, file_model, floor)
        needless = is_of_no_use(problem, stages, file_model, floor) or as_any
        if leftover is None and (needless or only_numbers(problem, stages, file_model, floor)):
            stages = reduced_to(problem, stages, [])
        elif leftover is None and len(stages) == 1:
            leftover = wandering_sensor(problem, stages[-1].fitted)
        leftover = leftover or unsteady(problem, stages[-1].fitted, floor)
    # A model without the law that was found bends its air speed to it.
    true_speed = true_speed_of(problem, stages[-1].fitted) if law is None else None
    if leftover is not None:
        leftover = of_the_input(leftover, stages, file_model, floor)
        if leftover.in_quiet is not None:
            least = np.maximum(stated_floor(problem.flights), tolerance)
            floor = np.sqrt(np.maximum(floor**2 - leftover.in_quiet, least**2))
    named = _file_model(problem, stages[-1].fitted) if len(stages) > 1 else None
    speed = at_constant_speed(problem, stages[-1].fitted)
    return Evidence(problem, stages, leftover, air, floor, file_model, named, speed, true_speed)


def _begun_where_it_rings(variant: Variant, problem: Problem, plain: Fitted) -> Variant:
    """A structural mode also sought where the pitch rate rings: hardly damped, it shows nowhere else."""
    if variant.effect != "structural_mode":
        return variant
    omega = variant.names.index("omega_rad_s")
    lowest, highest = (w / (2.0 * np.pi) for w in variant.bounds[omega])
    hz = ringing_hz(problem, plain, lowest, highest)
    if hz is None:
        return variant
    start = list(variant.starts[0])
    start[omega], start[variant.names.index("damping")] = 2.0 * np.pi * hz, _HARDLY_DAMPED
    return replace(variant, starts=(*variant.starts, tuple(start)))


def _named(
    problem: Problem, baseline: Fitted, variants: Sequence[Variant], progress: Progress
) -> tuple[Problem, list[Stage], Law | None]:
    """The model built up, with the command read the other way where that names the likelier effects.

    Also returned is the law that explains more than all of them. It is sought beside the first names: those
    that are found when they are reconsidered explain more, and beside a law beyond doubt none need be.
    """
    stages = one_after_another(problem, baseline, variants, progress)
    law = unnamed_law(problem, stages)
    if law is not None and law.is_beyond_doubt:
        return problem, stages, law
    stages = reconsidered(problem, stages, variants)
    seen = stages[0].rivals | {j.effect for j in added_in(stages)}
    named = stages[-1].fitted
    doubtful = may_be_held(problem, named, seen) or may_be_linear(problem, named)
    if doubtful and may_pay(problem, named, seen):
        other, plain = read_otherwise(problem, baseline)
        others = build_up(other, plain, variants, progress)
        likelier = is_plainer if problem.held else is_likelier_held
        if likelier(problem, named, other, others[-1].fitted):
            return other, others, unnamed_law(other, others)
    return problem, stages, None if law is None else unnamed_law(problem, stages)


def _with_the_air(
    problem: Problem, stages: list[Stage], law: Law | None
) -> tuple[Law | None, list[Stage], Air | None]:
    """A law and nothing that was named, with the air's motion; or, where it is the air's shape, the names."""
    if law is not None:
        plain, air = _beside_the_air(problem, reduced_to(problem, stages, []))
        if not law.may_be(air):
            return law, plain, air
    return None, *_beside_the_air(problem, stages)


def _beside_the_air(problem: Problem, stages: list[Stage]) -> tuple[list[Stage], Air | None]:
    """The air's motion, and the stages without what is no more than its shape."""
    last = stages[-1].fitted
    nearly_white = np.all(worth(problem, last.innovations) >= 0.5 * counts(problem))
    if not problem.knows_the_noise and nearly_white:
        return stages, None
    if (gust := gust_instead(problem, stages)) is not None:
        return reduced_to(problem, stages, []), gust
    air = moving_air(problem, last)
    if air is None:
        return stages, None
    named = added_in(stages)
    kept = [judged.effect for judged in named if not air.may_be(judged)]
    if len(kept) == len(named):
        return stages, air
    stages = reduced_to(problem, stages, kept)
    return stages, moving_air(problem, stages[-1].fitted)


def _without_a_name(
    problem: Problem, stages: list[Stage], air: Air | None, tolerance: FloatArray, floor: FloatArray
) -> Leftover | None:
    """What the last model leaves that is neither noise nor the air."""
    first, last = stages[0].fitted, stages[-1].fitted
    # The filter takes a swing for noise: as a line it is seen, and placed, better than by any other sign.
    swing = swinging(problem, first, last, tolerance) or swings_the_aircraft(problem, first, last)
    if swing is not None:
        return swing
    all_named = air is None and is_all_named(stages, _of_instruments(problem, floor))
    leftover = left_over(problem, first, last, tolerance, air is not None, all_named)
    slight = None if leftover is None else stages[-1].slight_in(leftover.block)
    if slight is not None:
        # A cause that is known, and below its physical minimum, leaves nothing without a name.
        last = slight.fitted
        leftover = left_over(problem, first, last, tolerance, air is not None, all_named)
    if air is None:
        return leftover
    if air.gust and leftover is not None and is_the_gust(problem, last, leftover):
        return None
    if leftover is None or leftover.block == "air" or is_of_passing_air(problem, last, leftover):
        return other_than_air(problem, first, last)
    return leftover


def _of_instruments(problem: Problem, floor: FloatArray) -> FloatArray:
    """The floor, but the white noise where it is far above that: something goes on in quiet, too."""
    if problem.instruments is None:
        return floor
    return np.where(floor > _FAR_ABOVE * problem.instruments, problem.instruments, floor)


def _floor(problem: Problem, last: Stage, tolerance: FloatArray) -> FloatArray:
    """Shape (channels,): noise as it is where nothing was flown."""
    # Stamps that jitter are the instruments', too, but show only where something moves.
    measured = quiet_rms(problem, last.fitted) ** 2 + stamp_power(problem, last.fitted)
    return np.maximum(np.sqrt(np.minimum(measured, last.held_out.mean_square)), tolerance)


def _file_model(problem: Problem, fitted: Fitted) -> HeldOut | None:
    """How the aircraft file's own parameters do, only initial states, trim and offsets refitted."""
    if problem.believed is None:
        return None
    point = replace(fitted.point, derivatives=problem.believed)
    lefts: list[FloatArray] = []
    for _ in range(3):
        linear = linearise(problem, point)
        owns = solve_blocks(problem, linear, 1.0 / fitted.noise, point).free
        still = np.zeros(len(point.shared))
        lefts = [block.measured.after(still, own) for block, own in zip(linear, owns, strict=True)]
        point = replace(point, own=point.own + np.array([o[:4] for o in owns]))
    return held_out(problem, lefts)
