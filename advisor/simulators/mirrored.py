"""Words and gap of a simulator that has an effect too much (``mirror``)."""

from dataclasses import replace

import numpy as np

from advisor.gap.diagnose import Examined
from advisor.gap.fitting.measure import whole_gap
from advisor.gap.fitting.problem import EffectProblem, SearchPoint
from advisor.gap.result import Cause, Diagnosis, Value
from advisor.gap.verdict.statements import what
from advisor.gap.verdict.text import answers_of
from advisor.simulators.unseen import floor_of, predicted, unknown_offset
from advisor.words.certainty import as_sure


def said_of_the_simulator(whole: Examined, diagnosis: Diagnosis) -> Diagnosis:
    """Return the diagnosis with the words and the gap of a simulator that has an effect too much."""
    without = whole.findings.without
    if without is None:
        return diagnosis
    first, before, after = diagnosis.causes[0], diagnosis.gap.before, _gap_without(whole, without)
    removed = 100.0 * (1.0 - after / before)
    sentence = f"{_said(first)}; without it the gap is {removed:.0f} % less."
    where = replace(diagnosis.where, block=first.block, share=float(np.clip(removed / 100.0, 0.0, 1.0)))
    simulated = diagnosis.in_simulator
    if simulated is not None:
        names = tuple(cause.effect for cause in diagnosis.causes if cause.present)
        simulated = replace(
            simulated, after=simulated.before, percent=0.0, on_paper=simulated.on_paper or names
        )
    return replace(
        diagnosis, sentence=as_sure(sentence, answers_of(diagnosis.evidence)),
        where=where, effects={}, waterfall=((first.effect, after),), shrink=None, in_simulator=simulated,
    )  # fmt: skip


def _gap_without(whole: Examined, problem: EffectProblem) -> float:
    """Return the flight's gap to the simulator without its effects, with no parameter fitted."""
    floor = floor_of(whole)
    assert problem.prior_derivatives is not None
    given = SearchPoint(problem.prior_derivatives, whole.findings.last.fitted.point.own)
    plain, offset = whole.findings.models[0].fitted, unknown_offset(whole.diagnosis, None)
    every = range(len(problem.flights))
    return whole_gap(predicted(problem, given, plain, floor, every, offset).mean_square, floor)


def _said(cause: Cause) -> str:
    """Return the statement about a simulator effect of negative size."""
    if cause.block == "input":
        return what(cause)
    read = what(negative_of(cause))
    return f"In the simulator alone {read[0].lower()}{read[1:]}"


def negative_of(cause: Cause) -> Cause:
    """Return an effect of the simulator as a cause, with the negative of its size, because the aircraft lacks
    the effect.
    """
    first, *rest = cause.parameters.items()
    name, size = first
    return replace(cause, parameters={name: Value(-size.value, size.std), **dict(rest)})
