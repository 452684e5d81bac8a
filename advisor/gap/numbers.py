"""The numbers of a diagnosis: gap, shrink, waterfall, model, yardsticks, traces."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from advisor.aircraft import PARAMETERS
from advisor.flight.messages import FloatArray
from advisor.gap.air import Air
from advisor.gap.evidence import Evidence
from advisor.gap.fit import Fitted
from advisor.gap.floor import prefiltered
from advisor.gap.holdout import HeldOut, folds_of
from advisor.gap.layout import DERIVATIVES
from advisor.gap.measure import by_band, by_phase, gap_of, shrink_interval
from advisor.gap.problem import Problem
from advisor.gap.result import Cause, Gap, Shrink, Trace, Value, Yardsticks
from advisor.gap.waterfall import Stage
from advisor.gap.yardsticks import yardsticks


def gap_numbers(e: Evidence, before: HeldOut, last: HeldOut, bias: Cause | None) -> Gap:
    """The gap of the plain and of the final model, as numbers."""
    problem, floor = e.problem, e.floor
    offset = np.zeros(len(problem.channels))
    if bias is not None:
        offset[problem.channels.index("alpha")] = bias.parameters["bias_rad"].value ** 2
    here, there = gap_of(before.mean_square + offset, floor), gap_of(last.mean_square, floor)
    smooth = [c for c, yes in prefiltered(problem.flights).items() if yes]
    note = "measured where nothing was flown, before the first step and late in the free response"
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


def kept_out(e: Evidence, holdout: int | None) -> tuple[list[int], list[list[int]]]:
    """Manoeuvres the gap is measured on, and folds that keep them out: the last ones, or each in turn."""
    n = len(e.problem.flights)
    if holdout is None or not 0 < holdout < n:
        return list(range(n)), folds_of(n)
    kept = list(range(n - holdout, n))
    return kept, [kept, *[[i for i in fold if i not in kept] for fold in folds_of(n)]]


def over_maneuvers(problem: Problem, held: HeldOut, kept: Sequence[int]) -> HeldOut:
    """The mean squares over some manoeuvres only; as in a fit, every sample counts alike."""
    flights = [problem.flights.flights[i] for i in kept]
    samples = np.array([[len(f.outputs[c].t) for c in problem.channels] for f in flights], float)
    sums = np.sum(samples * held.by_maneuver[list(kept)], axis=0)
    return replace(held, mean_square=sums / np.sum(samples, axis=0))


def without_air(held: HeldOut, air: Air) -> HeldOut:
    """Held-out errors with the share of the moving air taken out, alike in every manoeuvre.

    The courses of the errors are those that the air's likeliest course leaves.
    """
    share = np.minimum(air.left / held.mean_square, 1.0)
    powers = held.by_maneuver * share
    return replace(held, left=air.lefts, mean_square=held.mean_square * share, by_maneuver=powers)


def shrink_of(e: Evidence, kept: Sequence[int], gap: Gap, before: HeldOut, last: HeldOut) -> Shrink:
    """How far the gap shrinks on the manoeuvres kept out, with an interval from resampling them."""
    was = np.mean(before.by_maneuver / e.floor**2 - 1.0, axis=1)[list(kept)]
    now = np.mean(last.by_maneuver / e.floor**2 - 1.0, axis=1)[list(kept)]
    percent = 100.0 * (1.0 - gap.after / gap.before) if gap.before > 1e-9 else 0.0
    low, high = shrink_interval(was, now)
    numbers = tuple(e.problem.flights.flights[i].number for i in kept)
    return Shrink(numbers, gap.before, gap.after, percent, (min(low, percent), max(high, percent)))


def waterfall_of(
    stages: list[Stage],
    floor: FloatArray,
    extra: Sequence[Cause],
    speed: Cause | None,
    start: float,
) -> tuple[tuple[str, float], ...]:
    """Effect and gap after adding it, in order.

    A simulator that is given the measured speed has its change already: ``start`` is what that one leaves.
    """
    steps: list[tuple[str, float]] = []
    if speed is not None and speed not in extra:
        steps.append((speed.effect, start))
    for stage, following in pairwise(stages):
        assert stage.added is not None
        steps.append((stage.added.effect, float(np.mean(gap_of(following.held_out.mean_square, floor)))))
    for cause in extra:
        steps.append((cause.effect, min(cause.gap_after, steps[-1][1] if steps else start)))
    return tuple(steps)


def model_of(problem: Problem, fitted: Fitted, std: FloatArray) -> dict[str, Value]:
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


def fidelity_of(problem: Problem, before: HeldOut, last: HeldOut) -> dict[str, tuple[Yardsticks, Yardsticks]]:
    """Accepted yardsticks of every channel, before and after."""
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


def traces_of(problem: Problem, before: HeldOut, last: HeldOut) -> tuple[Trace, ...]:
    """Measured and simulated courses, for plotting."""
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
