"""Sentences about the certainty of a diagnosis, and about the evidence for its answer."""

import math
from collections.abc import Iterable

_SAYABLE_NATS = 12.0
"""Log odds, nats, above which the text says no odds: 160,000 to 1."""
_NOTHING = 0.005
"""Probability below which a row is omitted, because the row would say 0 %."""
_MOST = 4
"""Largest number of alternatives in one sentence."""


def is_shown(probability: float) -> bool:
    """Return whether a probability rounds to more than 0 %."""
    return probability >= _NOTHING


def in_percent(probability: float) -> str:
    """Return a probability as ``93 %``, with ``<1 %`` and ``>99 %`` at the ends."""
    if probability >= 1.0 - _NOTHING:
        return ">99 %"
    return f"{100.0 * probability:.0f} %" if is_shown(probability) else "<1 %"


def how_sure(alternatives: Iterable[tuple[str, float]], alone: Iterable[tuple[str, float]] = ()) -> str:
    """Return a sentence about the likeliest alternatives; empty without probabilities.

    Parameters
    ----------
    alone
        Probabilities from this flight alone, with equal prior probabilities of all answers.
    """
    by_flight = dict(alone)
    shown = [f"{words} {in_percent(p)}" for words, p in alternatives if is_shown(p)]
    first = next(iter(alternatives), ("", 0.0))[0]
    if shown and first in by_flight:
        shown[0] += f" (by this flight alone {in_percent(by_flight[first])})"
    if not shown:
        return ""
    more = ", others less" if len(shown) > _MOST else ""
    return f"Probability: {', '.join(shown[:_MOST])}{more}."


def weighed(reasons: Iterable[tuple[float, str]]) -> list[tuple[str, str]]:
    """Return one row for each reason with its nats, then a row with the sum and the odds.

    A reason of 0.0 nats has no row.
    """
    rows = [(_signed(nats), said, nats) for nats, said in reasons]
    total = sum(nats for *_, nats in rows)
    shown = [(number, said) for number, said, _ in rows if number not in (_signed(0.0), _signed(-0.0))]
    return [*shown, (_signed(total), f"together: {_odds(total)}")]


def _signed(nats: float) -> str:
    return f"{nats:+.1f}".replace("-", "−")


def _odds(nats: float) -> str:
    if abs(nats) > _SAYABLE_NATS:
        return "as good as certain" if nats > 0.0 else "as good as excluded"
    odds = math.exp(abs(nats))
    return f"{odds:.1f} to 1 for the answer" if nats >= 0.0 else f"{odds:.1f} to 1 against the answer"
