"""From the baseline model to the evidence: effects are added one by one, then the residual is examined."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.signals.messages import FloatArray
from advisor.gap.candidates.catalogue import variants_for
from advisor.gap.candidates.known import beyond_known, beyond_servo
from advisor.gap.evidence.found import Evidence
from advisor.gap.fitting.fit import EffectFit, fit
from advisor.gap.fitting.holdout import hold_out
from advisor.gap.fitting.measure import file_model_of, whole_gap
from advisor.gap.fitting.problem import EffectProblem, counts
from advisor.gap.fitting.uncertainty import distance_from_file, effective_samples
from advisor.gap.kit.variant import Variant
from advisor.gap.noise.probes import Probe, probe_blocks
from advisor.gap.noise.quiet import quiet_rms
from advisor.gap.noise.stamps import stamp_power
from advisor.gap.records.floor import stated_floor, tolerance_of
from advisor.gap.result import VISIBLE
from advisor.gap.search.air import SoughtAir, moving_air, one_maneuver_stands_out
from advisor.gap.search.speed import at_constant_speed
from advisor.gap.search.stage import Stage, sets_in
from advisor.gap.search.waterfall import (
    Progress,
    as_measured,
    in_full,
    one_after_another,
    reduced_to,
    settled,
)
from advisor.gap.uncatalogued.airspeed_scale import airspeed_scale_of
from advisor.gap.uncatalogued.law_search import Law, search_law
from advisor.gap.uncatalogued.spectral_line import ringing_hz
from advisor.gap.uncatalogued.sustained_oscillation import sustained_oscillation
from advisor.gap.uncatalogued.unexplained import Unexplained, innovation_noise, located, unexplained_residual

_HARDLY_DAMPED = 0.02
"""Numerical: damping ratio at which the search for a structural mode starts, of bare metal or a boom. A start
far from the true value only costs iterations."""


def explain(problem: EffectProblem, baseline: EffectFit, aircraft: Aircraft, progress: Progress) -> Evidence:
    """Add effects to the baseline model, then examine the residual: moving air, and unexplained motion.

    Parameters
    ----------
    problem, baseline
        The data, and the baseline model fitted to the data.
    aircraft
        The aircraft file, whose effects are part of every model.
    progress
        Function that receives a sentence and the share of the work that is done, 0 to 1.
    """
    variants = beyond_servo(aircraft, variants_for(problem.flights))
    stated = [change.effect for change, _ in problem.changes]
    variants = [v for v in beyond_known(aircraft.effects, variants) if v.effect not in stated]
    variants = [_begun_where_it_rings(v, problem, baseline) for v in variants]
    searched = one_after_another(problem, baseline, variants, progress)
    laws = search_law(problem, searched)
    stages = in_full(problem, settled(problem, searched)) if laws.law is None else searched
    law = laws.law
    progress("looking at the air", 0.7)
    stages, sought = _with_the_air(problem, stages, law)
    progress("looking for what has no name", 0.8)
    stages = as_measured(problem, stages)
    air = sought.found
    first, last, tolerance = stages[0].fitted, stages[-1].fitted, tolerance_of(problem.flights)
    unexplained = None if law is None else law.unexplained
    probes = probe_blocks(problem, last, innovation_noise(problem))
    if unexplained is None:
        unexplained = _unexplained(problem, stages, tolerance, air is not None, probes)
    floor = _floor(problem, stages[-1], tolerance)
    # Without a law that was found, the model would fit its air speed to the law's motion.
    airspeed_scale = airspeed_scale_of(problem, last) if law is None else None
    if unexplained is not None and unexplained.in_quiet is not None:
        least = np.maximum(stated_floor(problem.flights), tolerance)
        floor = np.sqrt(np.maximum(floor**2 - unexplained.in_quiet, least**2))
    file_model = file_model_of(problem, first)
    with_effects = file_model_of(problem, last) if len(stages) > 1 else None
    speed = at_constant_speed(problem, last)
    return Evidence(
        problem, stages, unexplained, air, floor, file_model, with_effects, speed, airspeed_scale,
        sought_air=sought, laws=laws.gains, sets=sets_in(searched, stages), probes=tuple(probes),
    )  # fmt: skip


def _unexplained(
    problem: EffectProblem, stages: Sequence[Stage], tolerance: FloatArray, air: bool, probes: Sequence[Probe]
) -> Unexplained | None:
    """Return a sustained oscillation, or else the unexplained residual of the last model.

    ``tolerance``, ``air`` (``moving_air``) and ``probes`` are defined in ``unexplained_residual``.
    """
    first, last = stages[0].fitted, stages[-1].fitted
    found = sustained_oscillation(problem, first, last, tolerance)
    if found is not None:
        return found
    found = unexplained_residual(problem, first, last, tolerance, air, probes)
    slight = None if found is None else stages[-1].slight_in(found.block)
    if slight is None:
        return found
    # A known effect below its physical minimum explains the residual of its block.
    probes = probe_blocks(problem, slight.fitted, innovation_noise(problem))
    return unexplained_residual(problem, first, slight.fitted, tolerance, air, probes)


def _floor(problem: EffectProblem, last: Stage, tolerance: FloatArray) -> FloatArray:
    """Return the noise of each channel where nothing was flown, shape (channels,), at least ``tolerance``."""
    # Jitter of the stamps belongs to the instruments, but appears only where a channel moves.
    measured = quiet_rms(problem, last.fitted) ** 2 + stamp_power(problem, last.fitted)
    return np.maximum(np.sqrt(np.minimum(measured, last.held_out.mean_square)), tolerance)


def evidence_of_one_maneuver(problem: EffectProblem, baseline: EffectFit) -> Evidence:
    """Return the evidence of a single manoeuvre: where the gap lies. No cause is sought, for lack of a
    hold-out.

    The gap is the residual of the aircraft file's derivatives if these are wrong, otherwise that of fitted
    ones.
    """
    stage = Stage(baseline, hold_out(problem, baseline), (), None)
    floor, file_model = (
        _floor(problem, stage, tolerance_of(problem.flights)),
        file_model_of(problem, baseline),
    )
    as_filed, held = baseline, stage.held_out
    is_off = distance_from_file(problem, baseline).is_off
    if problem.prior_derivatives is not None and file_model is not None and is_off:
        file = replace(baseline.point, derivatives=problem.prior_derivatives)
        as_filed, held = fit(replace(problem, derivatives_fixed=True), file, baseline.noise), file_model
    is_gap = whole_gap(held.mean_square, floor) >= VISIBLE
    unexplained = located(problem, as_filed) if is_gap else None
    return Evidence(problem, [stage], unexplained, None, floor, file_model, None, None)


def _begun_where_it_rings(variant: Variant, problem: EffectProblem, baseline: EffectFit) -> Variant:
    """Return a structural mode with one more start, at the frequency where the pitch rate rings."""
    if "omega_rad_s" not in variant.names:
        return variant
    omega = variant.names.index("omega_rad_s")
    lowest, highest = (w / (2.0 * np.pi) for w in variant.bounds[omega])
    hz = ringing_hz(problem, baseline, lowest, highest)
    if hz is None:
        return variant
    start = list(variant.starts[0])
    start[omega], start[variant.names.index("damping")] = 2.0 * np.pi * hz, _HARDLY_DAMPED
    return replace(variant, starts=(*variant.starts, tuple(start)))


def _with_the_air(
    problem: EffectProblem, stages: list[Stage], law: Law | None
) -> tuple[list[Stage], SoughtAir]:
    """Return the stages and the moving air. With a law, only the air that the law leaves unexplained
    counts."""
    if law is None:
        return stages, _air_with(problem, stages[-1].fitted)
    baseline = reduced_to(problem, stages, [])
    air = _air_with(problem, baseline[-1].fitted)
    # Motion of the law is no moving air: with the law in the model the air may be still.
    still = air.found is None or moving_air(problem, law.fitted).found is None
    return baseline, SoughtAir() if still else air


def _air_with(problem: EffectProblem, last: EffectFit) -> SoughtAir:
    """Return the moving air that a model leaves. A white residual without a loud manoeuvre is not
    searched."""
    nearly_white = np.all(effective_samples(problem, last.innovations) >= 0.5 * counts(problem))
    if not problem.knows_the_noise and nearly_white and not one_maneuver_stands_out(problem, last):
        return SoughtAir()
    return moving_air(problem, last)
