"""Terms that the user adds to the equations: their factors from measured signals.

The factor of a term is evaluated on measured signals, so the model stays linear in its parameters. Between
two events a factor has its value in the middle. A factor does not scale with the air speed.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from functools import cache

import numpy as np

from advisor.aircraft.added_term import FROM_MEAN, SIGNALS, AddedTerm, parse_term
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.oem.alpha_use import has
from advisor.oem.estimate import NoEstimate
from advisor.oem.rows import Signal, padded
from advisor.process.arrays import FloatArray
from advisor.words.quantities import channel

_FUNCTIONS: Mapping[str, Callable[[FloatArray], FloatArray]] = {
    "abs": np.abs, "sin": np.sin, "cos": np.cos
}  # fmt: skip
_term = cache(parse_term)


def recorded(
    maneuvers: Sequence[Maneuver], terms: Sequence[AddedTerm], own: Collection[str]
) -> list[dict[str, Signal]] | NoEstimate:
    """Return the signals of each manoeuvre that terms need, or the reason why one is missing.

    ``own`` holds the names of signals that a record has anyway.
    """
    recorded_signals: list[dict[str, Signal]] = []
    for m in maneuvers:
        recorded_signals.append({})
        for term in terms:
            for name in set(term.signals) - set(own):
                if not has(m.channels, SIGNALS[name]):
                    missing = channel(SIGNALS[name]).symbol
                    text = f"The term {term.name} needs {missing}, which manoeuvre {m.number} does not have."
                    return NoEstimate("no_signal", text)
                series = m.channels[SIGNALS[name]]
                recorded_signals[-1][name] = Signal(series.t - series.delay_s, series.y)
    return recorded_signals


def means_of(signals: Mapping[str, Sequence[FloatArray]]) -> dict[str, float]:
    """Return the mean of each signal over all manoeuvres, from which an expression counts it."""
    return {
        name: float(np.mean(np.concatenate(parts))) for name, parts in signals.items() if name in FROM_MEAN
    }


def forcing(
    terms: Mapping[str, float],
    equations: Sequence[str],
    means: Mapping[str, float],
    values: Mapping[str, FloatArray],
) -> FloatArray:
    """Return what the terms add to the rates on each step, shape (E, equations).

    Parameters
    ----------
    terms
        Coefficient of each term, by its text.
    equations
        Letters of the axis' equations.
    means
        Value from which each signal counts; 0 for a missing one.
    values
        Signals in the middle of each of E - 1 steps, by name.
    """
    steps = len(next(iter(values.values())))
    added = np.zeros((steps, len(equations)))
    counted = {name: y - means.get(name, 0.0) for name, y in values.items()}
    for text, coefficient in terms.items():
        term = _term(text)
        added[:, equations.index(term.equation)] += coefficient * term.factor(counted, _FUNCTIONS)
    return padded(added)
