"""From evidence to the answer: verdict, place, causes, sentence."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from advisor.aircraft import Aircraft
from advisor.flight.kinematics import KinematicCheck
from advisor.flight.maneuver import Maneuver
from advisor.gap.candidates.catalogue import variants_for
from advisor.gap.causes import (
    airspeed_cause,
    alpha_bias_cause,
    alpha_lag_cause,
    block_ranking,
    causes_of,
    speed_wanders,
    with_doubt,
)
from advisor.gap.evidence import VISIBLE, Evidence
from advisor.gap.foresee import unseen_effects
from advisor.gap.holdout import hold_out
from advisor.gap.measure import gap_of
from advisor.gap.numbers import (
    fidelity_of,
    gap_numbers,
    kept_out,
    model_of,
    over_maneuvers,
    shrink_of,
    traces_of,
    waterfall_of,
    without_air,
)
from advisor.gap.result import Cause, Diagnosis, Value, Verdict, Where
from advisor.gap.score import file_is_off, shared_std, worth
from advisor.gap.text import sentence_of


def answer(
    e: Evidence,
    aircraft: Aircraft,
    kinematics: KinematicCheck,
    holdout: int | None,
    maneuvers: Sequence[Maneuver],
) -> Diagnosis:
    """Turn the evidence into the diagnosis."""
    problem, stages, floor = e.problem, e.stages, e.floor
    first, last = stages[0].held_out, stages[-1].held_out
    still = np.minimum(floor, np.sqrt(e.air.left)) if e.air is not None else floor
    removed = max(float(np.mean((first.mean_square - last.mean_square) / floor**2)), 0.0)
    speed = airspeed_cause(problem, e.constant_speed, last, floor)
    air_cause = _air_cause(e)
    named = [s.added for s in stages if s.added is not None]
    left = float(np.mean(gap_of(last.mean_square, floor)))
    bias = alpha_bias_cause(kinematics, named, problem, left)
    late = alpha_lag_cause(kinematics, problem, named, left)
    unknown = e.leftover is not None and late is None
    causes = tuple(
        with_doubt(cause, problem)
        for cause in causes_of(
            stages, floor, e.leftover.share if e.leftover is not None else 0.0, problem.channels
        )
    )
    extra = [c for c in (air_cause, bias, late) if c is not None]
    before = e.file_model if e.file_model is not None else first
    visible = e.file_model is not None and float(
        np.mean((e.file_model.mean_square - first.mean_square) / floor**2)
    ) > VISIBLE  # fmt: skip
    wrong_values = visible and file_is_off(problem, stages[-1].fitted)
    if speed is not None and not (extra or named or wrong_values) and speed_wanders(problem):
        extra = [speed]
    if unknown:
        causes = tuple(
            replace(c, probability=c.probability * 0.5) for c in causes if not c.present or not named
        )[:5]
    causes = _merge(causes, extra)
    if bias is not None and not unknown:
        offset = (bias.parameters["bias_rad"].value / floor[problem.channels.index("alpha")]) ** 2
        causes = _bias_first(
            causes, float(offset) / len(floor) > removed and not problem.flights.alpha_is_derived
        )
    if e.constant_speed is not None and speed in extra:
        before = e.constant_speed
    verdict: Verdict = "none"
    if unknown:
        verdict = "unknown"
    elif any(c.present for c in causes):
        verdict = "effect"
    elif wrong_values:
        verdict = "parameters"
    if verdict in ("none", "parameters"):
        causes = tuple(replace(c, probability=0.05 * c.probability) for c in causes)
    if e.air is not None:
        # From here on the air is one of the causes: the floor is what stays without its motion.
        last = without_air(last, e.air)
        e, floor = replace(e, floor=still), still
    kept, folds = kept_out(e, holdout)
    if holdout is not None and e.air is None:
        last = hold_out(problem, stages[-1].fitted, folds)
        before = e.file_model if e.file_model is not None else hold_out(problem, stages[0].fitted, folds)
    before, last = over_maneuvers(before, kept), over_maneuvers(last, kept)
    gap = gap_numbers(e, before, last, bias)
    where = _where(e, verdict, causes)
    shrink = shrink_of(e, kept, gap, before, last) if verdict in ("effect", "parameters") else None
    fitted = stages[-1].fitted
    std = shared_std(problem, fitted, worth(problem, fitted.innovations))
    waterfall = waterfall_of(stages, floor, extra, speed, gap.before)
    present = {c.effect for c in causes if c.present}
    diagnosis = Diagnosis(
        verdict=verdict, sentence="", gap=gap, where=where, causes=causes, shrink=shrink, waterfall=waterfall,
        cannot_see=unseen_effects(problem, fitted, variants_for(problem.flights), floor, present),
        kinematics=kinematics, model=model_of(problem, fitted, std),
        reference_airspeed_m_s=problem.flights.reference_m_s if problem.flights.speed_measured else None,
        effects={c.effect: {k: v.value for k, v in c.parameters.items()} for c in causes if c.present},
        yardsticks=fidelity_of(problem, before, last), traces=traces_of(problem, before, last),
        notes=_notes(e, aircraft), maneuvers=tuple(f.number for f in problem.flights.flights),
    )  # fmt: skip
    return replace(diagnosis, sentence=sentence_of(diagnosis))


def _merge(causes: tuple[Cause, ...], extra: Sequence[Cause]) -> tuple[Cause, ...]:
    """Causes judged apart from the fits (air, constant offset, speed) beside those judged by it."""
    present, other = [c for c in causes if c.present], [c for c in causes if not c.present]
    if extra and not present:
        # The first is the larger one; where there is only one, it has no rival.
        shares = [0.95] if len(extra) == 1 else [0.9, *[0.05 / (len(extra) - 1)] * (len(extra) - 1)]
        other = [replace(c, probability=0.05 * c.probability) for c in other]
        named = (replace(c, probability=p) for c, p in zip(extra, shares, strict=True))
        return (*named, *other)[:5]
    if extra:
        present = [replace(c, probability=0.96 * c.probability) for c in present]
        extra = [replace(c, probability=0.03 / len(extra)) for c in extra]
        other = [replace(c, probability=0.2 * c.probability) for c in other]
    return (*present, *extra, *other)[:5]


def _bias_first(causes: tuple[Cause, ...], larger: bool) -> tuple[Cause, ...]:
    """The constant offset ahead of everything else, when it makes the larger part of the gap."""
    if not larger:
        return causes
    bias = next(c for c in causes if c.effect == "alpha_bias")
    rest = tuple(replace(c, probability=0.08 * c.probability) for c in causes if c is not bias)
    return (replace(bias, probability=0.9), *rest)


def _air_cause(e: Evidence) -> Cause | None:
    if e.air is None:
        return None
    reference = e.problem.flights.reference_m_s
    gust = e.air.gust
    peak, spread = e.air.gust_angle * reference, e.air.angle_std * reference
    parameters = {"sigma_w_m_s": Value(spread, 0.25 * spread)}
    if gust:
        parameters = {"amplitude_m_s": Value(peak, 0.4 * abs(peak)), "at_s": Value(e.air.gust_at_s, 0.1)}
    return Cause(
        "gust" if gust else "turbulence", "air", 0.9, parameters, ("turbulence" if gust else "gust",),
        "fly more manoeuvres: a gust does not come back, turbulence does", 0.0, True,
    )  # fmt: skip


def _where(e: Evidence, verdict: Verdict, causes: tuple[Cause, ...]) -> Where:
    if verdict == "unknown" and e.leftover is not None:
        return Where(e.leftover.block, e.leftover.share, e.leftover.ranking)
    ranking = block_ranking(e.stages[0], causes)
    total = max(float(np.mean(gap_of(e.stages[0].held_out.mean_square, e.floor))), 1e-12)
    left = float(np.mean(gap_of(e.stages[-1].held_out.mean_square, e.floor)))
    block = next((c.block for c in causes if c.present), ranking[0][0] if ranking else "force_equation")
    return Where(block, float(np.clip(1.0 - left / total, 0.0, 1.0)) if causes else 0.0, ranking)


def _notes(e: Evidence, aircraft: Aircraft) -> tuple[str, ...]:
    notes = []
    flights = e.problem.flights
    notes.append(
        "The command was held between its stamps." if e.problem.held
        else "The command was taken as linear between its stamps, its edges anywhere between two."
    )  # fmt: skip
    if not flights.speed_measured:
        notes.append("No air speed in the log: derivatives are taken as constant.")
    missing = [c for c in ("a_z", "theta") if c not in flights.channels]
    if missing:
        notes.append(f"Without {' and '.join(missing)} several instrument effects cannot be seen.")
    if len(flights) < 6:
        notes.append(
            f"Only {len(flights)} manoeuvres: intervals are wide, changes between manoeuvres hard to see."
        )
    if aircraft.elevator.lag_s is None:
        notes.append(
            "The servo's lag is not in the aircraft file: a lag found here may simply be the servo's."
        )
    return tuple(notes)
