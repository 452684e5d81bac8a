"""Probability that a movement of a control is a separate input, and not a response of the hands to the
motion.

Two models of the control compete. In the first, hands go on as in the seconds before: a loop with a delay,

    u(t) = a + Kq·q(t − τ) + Kθ·[θ(t − τ) − θ0] + Ki·∫θ + w(t),   Kq, Kθ, Ki ≥ 0,

in which w is the hands' remnant, coloured noise of first order (McRuer & Krendel, Mathematical Models of
Human Pilot Behavior, AGARDograph 188, 1974). Hands may take over at the begin of the movement. In the second,
the loop ends where the movement begins. The movement has levels and edges of one length, or is larger than
the remnant before. All models have the same seconds before and the same samples. Each costs its likelihood
and half of log n for each number (Schwarz 1978); the difference is the log-odds.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import exp, log

import numpy as np

from advisor.flight.maneuvers.binned import Motion, binned
from advisor.flight.maneuvers.maneuver import Span
from advisor.flight.maneuvers.stepped_input import Cost, Own, squares, stepped_input
from advisor.flight.signals.motion import integrated
from advisor.flight.signals.record import Channel
from advisor.process.arrays import FloatArray

_DELAYS_S = (0.0, 0.1, 0.2, 0.3)
"""Delays of the loop, s: that of a damper, and those of hands, 0.1 to 0.3 (McRuer & Krendel 1974)."""
_TAKEN_OVER = ((0.0, 0.1), (0.1, 0.1), (0.0, 0.9))
"""Begin and length, s, of the ramps whose mixture describes how hands take over. Hands take over within the
first two bins, or slowly.
"""
_KEEPS = (0.5, 0.8, 0.95)
"""Correlations of the remnant from bin to bin: time constants of 0.15, 0.45 and 2 s."""
_GAINS = 4
"""Number of the loop's gains: on the rate, on the angle from two targets, and on its integral."""


@dataclass(frozen=True, slots=True)
class Odds:
    """Comparison of both models."""

    log_odds: float
    """Log-odds of an own input, in units of likelihood."""
    begins_s: float
    """Time at which the own input begins, s."""
    ends_s: float
    """Time of its last step, s."""

    @property
    def probability(self) -> float:
        """Probability of an own input, if both models are equally likely beforehand."""
        return 1.0 / (1.0 + exp(-min(max(self.log_odds, -700.0), 700.0)))


def odds_of_own_input(
    span: Span,
    control: Channel,
    rate: Channel,
    angle: Channel | None,
    effect: float,
    tests: Sequence[tuple[float, float]] = (),
) -> Odds | None:
    """Return the odds that a movement is an input of its own.

    Parameters
    ----------
    span
        Extent of the movement.
    control, rate, angle
        Channels from ``HISTORY_S`` before the movement to its end, rad and rad/s. Without an angle, the
        integral of the rate is used.
    effect
        Control's effect on the rate. Only the sign is used: hands steady the aircraft.
    tests
        Earlier tests of this control, from begin to end of the free response, s. They show no hands.

    Returns
    -------
    Odds or None
        None if too few seconds before the movement show the hands.
    """
    if min(len(control), len(rate)) < 3:
        return None
    bins = binned(span, control, tests)
    if bins is None:
        return None
    if angle is None or len(angle) < 3:
        angle = Channel("angle", rate.t, integrated(rate.t, rate.y))
    motion = Motion(bins, rate, angle, -1.0 if effect > 0.0 else 1.0)
    whole = (span.start_s, span.last_step_s)
    loop = 0.5 * _GAINS * log(bins.count) + log(len(_DELAYS_S))
    rivals = [_compared(Cost(bins, keep, loop), motion, whole) for keep in _KEEPS]
    own = min((rival.own for rival in rivals), key=lambda it: it.nats)
    return Odds(min(rival.hands for rival in rivals) - own.nats, own.begins_s, own.ends_s)


@dataclass(frozen=True, slots=True)
class _Rivals:
    """Costs of both models at one correlation of the remnant, in units of likelihood."""

    hands: float
    own: Own


@dataclass(frozen=True, slots=True)
class _Loop:
    """Loop with one delay, fitted to the seconds before the movement and to the movement."""

    before: float
    """Sum of squares of the seconds before the movement, with gains fitted to these seconds."""
    within: float
    """Sum of squares of the movement, with gains fitted to the movement."""
    terms: FloatArray
    """Shape (k, m + n): the loop's terms in the seconds before and in the movement."""


def _compared(cost: Cost, motion: Motion, whole: tuple[float, float]) -> _Rivals:
    """Return the costs of both models at one correlation of the remnant."""
    loops = [_loop(cost, motion.terms(delay_s, _TAKEN_OVER)) for delay_s in _DELAYS_S]
    before = min(loop.before for loop in loops)
    cost = cost.grown(before)
    until = _Until(cost, [loop.terms for loop in loops])
    usual = cost.of(until(cost.bins.within)) + cost.loop
    other_gains = cost.of(min(loop.before + cost.ratio * loop.within for loop in loops))
    other_gains += 2.0 * cost.loop + log(cost.bins.count) + log(len(_TAKEN_OVER))
    smooth = cost.of_two(before, squares(cost.moved[cost.bins.movement])) + cost.loop
    own = min(Own(smooth, *whole), stepped_input(cost, until, before, whole), key=lambda it: it.nats)
    return _Rivals(min(usual, other_gains), own)


class _Until:
    """Least weighted sum of squares of the seconds before and of a movement's first bins, for one loop.

    Parameters
    ----------
    loops
        Terms of the loop of each delay, shape (k, m + n).
    """

    def __init__(self, cost: Cost, loops: Sequence[FloatArray]) -> None:
        bins = cost.bins
        self._before = len(bins.hands)
        weight = np.ones(bins.count)
        weight[self._before :] = np.sqrt(cost.ratio)
        y = cost.moved[np.concatenate([bins.hands, np.arange(bins.first, len(bins.moved))])]
        self._y, self._loops = weight * y, [weight * terms for terms in loops]

    def __call__(self, within: int) -> float:
        """Return the sum of squares with the first ``within`` bins of the movement."""
        rows = slice(self._before + within)
        return min(squares(_left(terms[:, rows], self._y[rows])) for terms in self._loops)


def _loop(cost: Cost, terms: FloatArray) -> _Loop:
    """Return the fits of a loop's terms to the seconds before and to the movement."""
    bins, here = cost.bins, cost.bins.movement
    level = np.ones(len(bins.moved))
    level[here] = 0.0
    series = np.array([*terms, level, -level])
    white = cost.white(series)
    # Hands rest before the movement, whatever the motion was.
    white[:, bins.first] = series[:, bins.first]
    rows = np.concatenate([bins.hands, np.arange(bins.first, len(bins.moved))])
    before = _left(white[:, bins.hands], cost.moved[bins.hands])
    within = _left(white[:-2, here], cost.moved[here])
    return _Loop(squares(before), squares(within), white[:, rows])


def _left(terms: FloatArray, y: FloatArray) -> FloatArray:
    """Return the residual of a series after a fit of terms, shape (k, n), with coefficients of at least 0."""
    from scipy.optimize import nnls  # not on the start path

    size = np.maximum(np.abs(terms).max(axis=1), 1e-12)
    coefficients, _ = nnls(terms.T / size, y)
    residual: FloatArray = y - (coefficients / size) @ terms
    return residual
