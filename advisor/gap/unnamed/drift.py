"""What was named is there, but not the same throughout: a vane ages, a clock runs off and is set again.

A named effect of an instrument, of the stamps or of the servo is one number. One that grows or fades from the
first manoeuvre to the last, or is another in every one, has no name, only a place.
"""

from dataclasses import dataclass

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.gap.candidates.between import starts_of
from advisor.gap.candidates.traits import STEADY
from advisor.gap.candidates.variant import Values, Variant
from advisor.gap.fitting.fit import Fitted, fit
from advisor.gap.fitting.holdout import HeldOut
from advisor.gap.fitting.problem import Problem, counts
from advisor.gap.fitting.step import own_eliminated
from advisor.gap.fitting.uncertainty import worth
from advisor.gap.records.flights import Flights
from advisor.gap.result import spelled
from advisor.gap.search.merit import CERTAIN, Judged
from advisor.gap.search.score import addition
from advisor.gap.search.stage import Stage
from advisor.gap.simulator.layout import ENTRIES
from advisor.gap.unnamed.leftover import Leftover

_LEAST_CHANGE = 0.8
"""From the first manoeuvre to the last, over the number itself."""
_ALONE = 2
"""Stages where a single effect was named."""
_FEW = 5
"""Manoeuvres from which on a course in time is no chance."""
_SCATTER, _ITS_ERRORS = 0.2, 20.0
"""Standard deviation between manoeuvres of a number that is another in each: over itself, for a lag that is
taken for a delay scatters by a sixth; and its square over that of the errors."""
_TOLD = 1e-6
"""Share of what the manoeuvre that tells most says of it, below which one says nothing."""
_WANDERS_IN = {"alpha_lag": "timing"}
"""Where an effect that is another in every manoeuvre belongs, if not to its own block: a vane's lag is its
build, and stays; what delays messages comes and goes."""
_MAY_DRIFT, _SIGNIFICANT = 0.15, 5.0
"""The same of one that may change evenly: what changes by four fifths has 0.23."""


@dataclass(frozen=True)
class _Scatter:
    """How far apart the manoeuvres are in a named number."""

    value: float
    std: float
    over_errors: float
    """Square of the departures over that of their errors."""

    @property
    def may_drift(self) -> bool:
        return self.std > _MAY_DRIFT * abs(self.value) and self.over_errors > _SIGNIFICANT

    @property
    def is_plain(self) -> bool:
        return self.std > _SCATTER * abs(self.value) and self.over_errors > _ITS_ERRORS


def drifting(problem: Problem, stages: list[Stage]) -> Leftover | None:
    """The named effect that is not the same throughout; None where all are, or the flight is too short."""
    if len(problem.flights) < _FEW:
        return None
    alone = len(stages) == _ALONE or stages[0].disputed is not None
    for stage in stages:
        said, model, held = stage.added, stages[-1].fitted, stages[-1].held_out
        if said is None and stage.disputed is not None:
            # Manoeuvres kept out refuse what is another number in each of them.
            said, model, held = stage.disputed, stage.disputed.fitted, stage.disputed.held_out
        if said is None or said.effect not in STEADY or len(said.value) != 1:
            continue
        scatter = _scatter(problem, model, said)
        if not scatter.may_drift:
            continue
        drift = _with_drift(problem, model, held, said)
        if not _is_plain(drift, said):
            if not scatter.is_plain:
                continue
            block = _WANDERS_IN.get(said.effect, said.variant.block)
            return Leftover(block, 1.0, ((block, 1.0),), note=_varies(said, scatter))
        # Of a lag and a clock that are hard to tell apart one may drift as the other does not.
        alike = [j for j in stage.considered if j.effect in STEADY and j.variant.block != said.variant.block]
        for rival in alike if alone else []:
            other = _with_drift(problem, rival.fitted, rival.held_out, rival)
            if other.fitted.cost < drift.fitted.cost and _is_plain(other, rival):
                said, drift = rival, other
        block = said.variant.block
        return Leftover(block, 1.0, ((block, 1.0),), note=_said(said, float(drift.value[0])))
    return None


def _is_plain(drift: Judged, named: Judged) -> bool:
    """Whether the change is certain, shows, and is a good part of the number itself."""
    change = abs(float(drift.value[0]))
    shows = drift.gain >= CERTAIN and drift.removed >= drift.least
    return shows and change >= _LEAST_CHANGE * abs(float(named.value[0]))


def _with_drift(problem: Problem, before: Fitted, held_before: HeldOut, judged: Judged) -> Judged:
    """What it adds that the effect changes evenly from the first manoeuvre to the last."""
    t = starts_of(problem.flights)
    course = (t - np.mean(t)) / np.ptp(t)
    named = judged.variant
    per_unit = _written(named, 1.0, problem.flights) - _written(named, 0.0, problem.flights)
    lowest = min(named.bounds[0][0], 0.0)

    def apply(p: FloatArray, values: Values, _: Flights) -> None:
        moved = per_unit != 0.0
        p += values[0] * course[:, None] * per_unit
        p[moved] = np.maximum(p[moved], lowest)

    width = named.bounds[0][1] - lowest
    drift = Variant(
        f"{named.effect}_drift", named.block, (named.names[0],), ((0.0,),), named.steps, ((-width, width),),
        named.smallest, apply_with=apply,
    )  # fmt: skip
    fitted = fit(problem, before.point.with_effect(drift, (0.0,)), before.noise, tolerance=0.5)
    independent = worth(problem, fitted.innovations)
    return addition(problem, before, held_before, fitted, drift.effect, independent)


def _written(variant: Variant, value: float, flights: Flights) -> FloatArray:
    p = np.zeros((len(flights), len(ENTRIES)))
    variant.apply(p, [value], flights)
    return p


def _scatter(problem: Problem, last: Fitted, named: Judged) -> _Scatter:
    """What each manoeuvre by itself would change of a named number, all others as they are."""
    at = last.point.place(last.point.index_of(named.effect)).start
    share = worth(problem, last.innovations) / counts(problem)
    inners = [own_eliminated(block, np.sqrt(share) / last.noise)[0] for block in last.linear]
    told = max(inner[at, at] for inner in inners)
    pairs = [(inner[at, at], inner[at, -1]) for inner in inners if inner[at, at] > _TOLD * told]
    known, pulled = np.array(pairs).T
    change = pulled / known
    change -= np.average(change, weights=known)
    std = float(np.sqrt(max(np.mean(change**2 - 1.0 / known), 0.0)))
    return _Scatter(float(named.value[0]), std, float(np.mean(known * change**2)))


def _varies(judged: Judged, scatter: _Scatter) -> str:
    (unit, scale), value = _unit(judged), float(judged.value[0])
    give = f"give or take {round(scale * scatter.std)} {unit}"
    return (
        f"The {spelled(judged.effect)} is another in every manoeuvre: {round(scale * value)} {unit}, {give}."
    )


def _unit(judged: Judged) -> tuple[str, float]:
    return ("ms", 1e3) if judged.variant.names[0].endswith("_s") else ("%", 1e2)


def _said(judged: Judged, change: float) -> str:
    (unit, scale), value = _unit(judged), float(judged.value[0])
    began, ended = (round(scale * (value + half)) for half in (-0.5 * change, 0.5 * change))
    course = f"{began} {unit} at the beginning, {ended} {unit} at the end"
    return f"The {spelled(judged.effect)} is not the same throughout: {course}."
