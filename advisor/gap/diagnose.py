"""The diagnosis: where the gap lies, which effect causes it, how far it shrinks without it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from advisor.aircraft import PARAMETERS, Aircraft
from advisor.flight.kinematics import SMALLEST_BIAS_RAD, KinematicCheck, check_alpha, combine
from advisor.flight.maneuver import Maneuver
from advisor.flight.messages import FloatArray
from advisor.gap.air import Air, moving_air
from advisor.gap.baseline import fit_baseline
from advisor.gap.candidates.catalogue import variants_for
from advisor.gap.causes import (
    SPEED_IS_A_CAUSE,
    airspeed_cause,
    alpha_bias_cause,
    alpha_lag_cause,
    block_ranking,
    causes_of,
)
from advisor.gap.coherence import Coherence, coherent_part, unrest
from advisor.gap.data import Flights, prepare
from advisor.gap.fit import Fitted, Problem, linearise, own_only
from advisor.gap.floor import prefiltered, stated_floor
from advisor.gap.foresee import unseen_effects
from advisor.gap.holdout import HeldOut, folds_of, hold_out, mean_squares
from advisor.gap.layout import DERIVATIVES
from advisor.gap.measure import by_band, by_phase, gap_of, shrink_interval
from advisor.gap.probes import probe_blocks
from advisor.gap.result import Cause, Diagnosis, Gap, Shrink, Trace, Value, Verdict, Where, Yardsticks
from advisor.gap.score import shared_std, worth
from advisor.gap.text import sentence_of
from advisor.gap.waterfall import Progress, Stage, build_up, reconsider
from advisor.gap.yardsticks import yardsticks
from advisor.problems import UnusableInputError

VISIBLE = 0.05
"""Gap above the floor from which on there is something to explain."""
DOUBT = 2.5
"""Where the floor is stated, not measured, an unknown cause must exceed it this many times."""
RESTLESS = 2.0
"""Error power while the stick moves over that in quiet, minus 1, from which on it is no noise."""
RESTLESS_IN_MOVING_AIR = 6.0
"""The same when the air moves: it may happen to move more while the stick does."""
LEFT_BY_A_CAUSE = 0.15
"""Share of such excess that a right cause, modelled to low order only, may leave."""
UNEXPLAINED = 0.3
"""Share of the gap that may stay predictable from the motion after a cause was named."""


@dataclass(frozen=True)
class _Evidence:
    """Everything the answer is made from."""

    problem: Problem
    stages: list[Stage]
    coherence: Coherence
    air: Air | None
    floor: FloatArray
    file_model: HeldOut | None
    """The aircraft file's own parameters, unfitted."""
    stated: FloatArray
    """Shape (channels,): tolerance of channels filtered before they were recorded, else 0."""


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
        How many manoeuvres, the last ones, to keep out of every fit for the shrink; None: a third.
    progress
        Called with a sentence and the share done.

    Raises
    ------
    UnusableInputError
        Too few manoeuvres, or no angle of attack.
    """
    progress("checking the angle of attack against the motion", 0.0)
    flights = prepare(maneuvers, aircraft)
    _refuse(flights)
    kinematics = combine(
        [check_alpha(m, aircraft.airspeed_m_s, aircraft.accelerometer.arm_m) for m in maneuvers if m.number in
         {f.number for f in flights.flights}]
    )  # fmt: skip
    progress("fitting the simulator's model", 0.1)
    if abs(kinematics.bias_rad) > max(SMALLEST_BIAS_RAD, 4.0 * kinematics.bias_std_rad):
        # What the climb rate shows is taken out first, else the trim would carry it into the lift.
        flights = prepare([_without_offset(m, kinematics.bias_rad) for m in maneuvers], aircraft)
    problem, baseline = fit_baseline(flights, aircraft)
    evidence = _explain(problem, baseline, aircraft, progress)
    progress("measuring the gap", 0.9)
    return _answer(evidence, aircraft, kinematics, holdout, maneuvers)


def _without_offset(maneuver: Maneuver, offset: float) -> Maneuver:
    """The manoeuvre with a constant taken off its angle of attack."""
    channels = dict(maneuver.channels)
    if "alpha" in channels:
        channels["alpha"] = replace(channels["alpha"], y=channels["alpha"].y - offset)
    return replace(maneuver, channels=channels)


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


def _explain(problem: Problem, baseline: Fitted, aircraft: Aircraft, progress: Progress) -> _Evidence:
    """Build the model up, then look at what is left: the air, and whatever the motion still predicts."""
    variants = variants_for(problem.flights)
    white = stated_floor(problem.flights)
    problem = replace(problem, smallest_noise=0.5 * white)
    stages = reconsider(problem, build_up(problem, baseline, variants, progress), variants)
    air = None
    last = stages[-1].fitted
    samples = sum(len(f.outputs["q"].t) for f in problem.flights.flights)
    if np.min(worth(problem, last.left)) < 0.5 * samples:
        progress("looking at the air", 0.7)
        air = moving_air(problem, last, problem.flights.alpha_is_derived)
    coherence = coherent_part(problem, last)
    held = stages[-1].held_out.mean_square
    floor = np.sqrt(np.maximum(np.minimum(last.noise**2, held) - coherence.power, (0.5 * last.noise) ** 2))
    smooth = prefiltered(problem.flights)
    stated = np.array([white[k] if smooth[c] else 0.0 for k, c in enumerate(problem.channels)])
    return _Evidence(
        problem,
        stages,
        coherence,
        air,
        np.maximum(floor, stated),
        _file_model(problem, baseline, aircraft),
        stated,
    )


def _file_model(problem: Problem, baseline: Fitted, aircraft: Aircraft) -> HeldOut | None:
    """How the aircraft file's own parameters do, only initial states, trim and offsets refitted."""
    if any(name not in aircraft.model for name in PARAMETERS):
        return None
    point = replace(baseline.point, derivatives=np.array([aircraft.model[name] for name in DERIVATIVES]))
    lefts: list[FloatArray] = []
    for _ in range(3):
        linear = linearise(problem, point)
        owns, lefts = own_only(problem, linear, 1.0 / baseline.noise)
        point = replace(point, own=point.own + np.array([o[:4] for o in owns]))
    powers = mean_squares(problem, lefts)
    counts = np.array(
        [[len(f.outputs[c].t) for c in problem.channels] for f in problem.flights.flights], float
    )
    return HeldOut(tuple(lefts), np.sum(powers * counts, axis=0) / np.sum(counts, axis=0), powers)


def _answer(
    e: _Evidence,
    aircraft: Aircraft,
    kinematics: KinematicCheck,
    holdout: int | None,
    maneuvers: Sequence[Maneuver],
) -> Diagnosis:
    problem, stages, floor = e.problem, e.stages, e.floor
    first, last = stages[0].held_out, stages[-1].held_out
    still = np.minimum(floor, np.sqrt(e.air.left)) if e.air is not None else floor
    doubtful = np.maximum(floor, DOUBT * e.stated)
    coherent_gap = float(np.mean(e.coherence.power / doubtful**2))
    removed = max(float(np.mean((first.mean_square - last.mean_square) / floor**2)), 0.0)
    bias = alpha_bias_cause(kinematics, floor, problem)
    speed = airspeed_cause(problem, stages[-1].fitted, last, floor)
    air_cause = _air_cause(e)
    late = alpha_lag_cause(kinematics, problem, [s.added for s in stages if s.added is not None])
    unexplained = coherent_gap / max(coherent_gap + removed, 1e-12)
    named = [s.added for s in stages if s.added is not None]
    unknown = coherent_gap > VISIBLE and (unexplained > UNEXPLAINED or not named)
    unknown = (unknown or _restless(e)) and late is None
    causes = causes_of(stages, floor, unexplained if coherent_gap > VISIBLE else 0.0, problem.channels)
    fast = speed is not None and problem.flights.speed_moves > SPEED_IS_A_CAUSE
    alone = not named and air_cause is None and bias is None and late is None
    extra = [c for c in (air_cause, bias, late, speed if fast and alone else None) if c is not None]
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
    before = e.file_model if e.file_model is not None else first
    wrong_values = e.file_model is not None and float(
        np.mean((e.file_model.mean_square - first.mean_square) / floor**2)
    ) > VISIBLE  # fmt: skip
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
        last = _without_air(last, e.air)
        e, floor = replace(e, floor=still), still
    kept, folds = _kept(e, holdout)
    if holdout is not None and e.air is None:
        last = hold_out(problem, stages[-1].fitted, folds)
        before = e.file_model if e.file_model is not None else hold_out(problem, stages[0].fitted, folds)
    before, last = _only(before, kept), _only(last, kept)
    gap = _gap(e, before, last, bias)
    where = _where(e, verdict, causes)
    shrink = _shrink(e, kept, gap, before, last) if verdict in ("effect", "parameters") else None
    fitted = stages[-1].fitted
    std = shared_std(problem, fitted, worth(problem, fitted.left))
    waterfall = _waterfall(stages, floor, extra, speed, gap.before)
    present = {c.effect for c in causes if c.present}
    diagnosis = Diagnosis(
        verdict=verdict, sentence="", gap=gap, where=where, causes=causes, shrink=shrink, waterfall=waterfall,
        cannot_see=unseen_effects(problem, fitted, variants_for(problem.flights), floor, present),
        kinematics=kinematics, model=_model(problem, fitted, std),
        reference_airspeed_m_s=problem.flights.reference_m_s if problem.flights.speed_measured else None,
        effects={c.effect: {k: v.value for k, v in c.parameters.items()} for c in causes if c.present},
        yardsticks=_yardsticks(problem, before, last), traces=_traces(problem, before, last),
        notes=_notes(e, aircraft), maneuvers=tuple(f.number for f in problem.flights.flights),
    )  # fmt: skip
    return replace(diagnosis, sentence=sentence_of(diagnosis))


def _restless(e: _Evidence) -> bool:
    """Whether the error still grows when the stick moves, by more than what was named may leave behind."""
    active, quiet = unrest(e.problem, e.stages[-1].fitted.left)
    was, _ = unrest(e.problem, e.stages[0].fitted.left)
    quiet = np.maximum(quiet, (DOUBT * e.stated) ** 2)
    rest, total = np.maximum(active / quiet - 1.0, 0.0), np.maximum(was / quiet - 1.0, 0.0)
    share = float(np.mean(rest)) / max(float(np.mean(total)), 1e-12)
    least = RESTLESS_IN_MOVING_AIR if e.air is not None else RESTLESS
    # Every further effect that is needed makes it likelier that none of them is the right one.
    allowed = LEFT_BY_A_CAUSE / max(len(e.stages) - 1, 1)
    return float(np.max(rest)) > least and (share > allowed or len(e.stages) == 1)


def _merge(causes: tuple[Cause, ...], extra: Sequence[Cause]) -> tuple[Cause, ...]:
    """Causes judged apart from the fits (air, constant offset, speed) beside those judged by it."""
    present, other = [c for c in causes if c.present], [c for c in causes if not c.present]
    if extra and not present:
        taken = 0.95 / len(extra)
        other = [replace(c, probability=0.05 * c.probability) for c in other]
        return (*(replace(c, probability=taken) for c in extra), *other)[:5]
    if extra:
        present = [replace(c, probability=0.9 * c.probability) for c in present]
        extra = [replace(c, probability=0.08 / len(extra)) for c in extra]
        other = [replace(c, probability=0.2 * c.probability) for c in other]
    return (*present, *extra, *other)[:5]


def _bias_first(causes: tuple[Cause, ...], larger: bool) -> tuple[Cause, ...]:
    """The constant offset ahead of everything else, when it makes the larger part of the gap."""
    if not larger:
        return causes
    bias = next(c for c in causes if c.effect == "alpha_bias")
    rest = tuple(replace(c, probability=0.08 * c.probability) for c in causes if c is not bias)
    return (replace(bias, probability=0.9), *rest)


def _air_cause(e: _Evidence) -> Cause | None:
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


def _gap(e: _Evidence, before: HeldOut, last: HeldOut, bias: Cause | None) -> Gap:
    problem, floor = e.problem, e.floor
    offset = np.zeros(len(problem.channels))
    if bias is not None:
        offset[problem.channels.index("alpha")] = bias.parameters["bias_rad"].value ** 2
    here, there = gap_of(before.mean_square + offset, floor), gap_of(last.mean_square, floor)
    smooth = [c for c, yes in prefiltered(problem.flights).items() if yes]
    note = "measured: what neither an effect nor the motion explains on manoeuvres kept out"
    if smooth:
        note = f"stated as 2 % of peak for {', '.join(smooth)} (filtered before storage); else measured"
    return Gap(
        before=float(np.mean(here)), after=float(np.mean(there)),
        floor=dict(zip(problem.channels, map(float, floor), strict=True)), floor_note=note,
        by_channel=dict(zip(problem.channels, map(float, here), strict=True)),
        by_channel_after=dict(zip(problem.channels, map(float, there), strict=True)),
        by_maneuver=tuple(
            (f.number, float(np.mean(gap_of(b, floor))), float(np.mean(gap_of(a, floor))))
            for f, b, a in zip(problem.flights.flights, before.by_maneuver, last.by_maneuver, strict=True)
        ),
        by_phase=by_phase(problem, before.left, floor), by_band_hz=by_band(problem, before.left),
    )  # fmt: skip


def _where(e: _Evidence, verdict: Verdict, causes: tuple[Cause, ...]) -> Where:
    if verdict == "unknown":
        instruments = np.sqrt(np.maximum(e.floor**2, 1e-18))
        probes = probe_blocks(e.problem, e.stages[-1].fitted, instruments)
        best = max(probes[0].gain, 1e-9)
        scores: dict[str, float] = {}
        for p in probes:
            scores.setdefault(p.block, round(max(p.gain, 0.0) / best, 4))
        return Where(probes[0].block, probes[0].explained, tuple(scores.items()))
    ranking = block_ranking(e.stages[0], causes)
    total = max(float(np.mean(gap_of(e.stages[0].held_out.mean_square, e.floor))), 1e-12)
    left = float(np.mean(gap_of(e.stages[-1].held_out.mean_square, e.floor)))
    block = next((c.block for c in causes if c.present), ranking[0][0] if ranking else "force_equation")
    return Where(block, float(np.clip(1.0 - left / total, 0.0, 1.0)) if causes else 0.0, ranking)


def _shrink(e: _Evidence, kept: Sequence[int], gap: Gap, before: HeldOut, last: HeldOut) -> Shrink:
    """How far the gap shrinks on the manoeuvres kept out, with an interval from resampling them."""
    was = np.mean(before.by_maneuver / e.floor**2 - 1.0, axis=1)[list(kept)]
    now = np.mean(last.by_maneuver / e.floor**2 - 1.0, axis=1)[list(kept)]
    percent = 100.0 * (1.0 - gap.after / gap.before) if gap.before > 1e-9 else 0.0
    low, high = shrink_interval(was, now)
    numbers = tuple(e.problem.flights.flights[i].number for i in kept)
    return Shrink(numbers, gap.before, gap.after, percent, (min(low, percent), max(high, percent)))


def _kept(e: _Evidence, holdout: int | None) -> tuple[list[int], list[list[int]]]:
    """Manoeuvres the gap is measured on, and folds that keep them out: the last ones, or each in turn."""
    n = len(e.problem.flights)
    if holdout is None or not 0 < holdout < n:
        return list(range(n)), folds_of(n)
    kept = list(range(n - holdout, n))
    return kept, [kept, *[[i for i in fold if i not in kept] for fold in folds_of(n)]]


def _only(held: HeldOut, kept: Sequence[int]) -> HeldOut:
    """The mean squares over some manoeuvres only."""
    return replace(held, mean_square=np.mean(held.by_maneuver[list(kept)], axis=0))


def _without_air(held: HeldOut, air: Air) -> HeldOut:
    """Held-out errors with the share of the moving air taken out, alike in every manoeuvre."""
    share = np.minimum(air.left / held.mean_square, 1.0)
    return HeldOut(held.left, held.mean_square * share, held.by_maneuver * share)


def _waterfall(
    stages: list[Stage],
    floor: FloatArray,
    extra: Sequence[Cause],
    speed: Cause | None,
    start: float,
) -> tuple[tuple[str, float], ...]:
    steps: list[tuple[str, float]] = []
    if speed is not None and speed not in extra:
        steps.append((speed.effect, float(np.mean(gap_of(stages[0].held_out.mean_square, floor)))))
    for stage, following in pairwise(stages):
        assert stage.added is not None
        steps.append((stage.added.effect, float(np.mean(gap_of(following.held_out.mean_square, floor)))))
    for cause in extra:
        steps.append((cause.effect, min(cause.gap_after, steps[-1][1] if steps else start)))
    return tuple(steps)


def _model(problem: Problem, fitted: Fitted, std: FloatArray) -> dict[str, Value]:
    """The eight parameters about zero angles, from the trimmed ones of each manoeuvre."""
    d = fitted.point.derivatives
    trims = np.array([[f.trim[0], f.u_trim] for f in problem.flights.flights])
    own = fitted.point.own
    gravity = np.array([9.80665 / float(np.mean(f.slow[0])) for f in problem.flights.flights])
    z0 = own[:, 2] + gravity - d[0] * trims[:, 0] - d[2] * trims[:, 1]
    m0 = own[:, 3] - d[3] * trims[:, 0] - d[5] * trims[:, 1]
    n = np.sqrt(len(z0))
    values = {
        "Z_0": Value(float(np.mean(z0)), float(np.std(z0) / n)),
        "M_0": Value(float(np.mean(m0)), float(np.std(m0) / n)),
    }
    for k, name in enumerate(DERIVATIVES):
        values[name] = Value(float(d[k]), float(std[k]))
    return {name: values[name] for name in PARAMETERS}


def _yardsticks(problem: Problem, before: HeldOut, last: HeldOut) -> dict[str, tuple[Yardsticks, Yardsticks]]:
    found = {}
    for c, name in enumerate(problem.channels):
        measured = np.concatenate([f.outputs[name].y for f in problem.flights.flights])
        pair = []
        for held in (before, last):
            left = np.concatenate([
                x[problem.rows(f)[c]] for f, x in zip(problem.flights.flights, held.left, strict=True)
            ])  # fmt: skip
            pair.append(yardsticks(name, measured, measured - left))
        found[name] = (pair[0], pair[1])
    return found


def _traces(problem: Problem, before: HeldOut, last: HeldOut) -> tuple[Trace, ...]:
    traces = []
    for i, flight in enumerate(problem.flights.flights):
        for name, rows in zip(problem.channels, problem.rows(flight), strict=True):
            out = flight.outputs[name]
            traces.append(
                Trace(
                    flight.number,
                    name,
                    out.t,
                    out.y,
                    out.y - before.left[i][rows],
                    out.y - last.left[i][rows],
                )
            )
    return tuple(traces)


def _notes(e: _Evidence, aircraft: Aircraft) -> tuple[str, ...]:
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
