"""Cost of models of a control, and the input of levels and edges with the least cost.

Straight lines between the samples of a sine lose the fraction (πf/f_s)²/3 on average: 1 % at 2.8 Hz and 50
samples a second. The loss grows with the frequency like the loss by a servo's lag. On a fast roll the loss
moved L_p by 5 %.

Two models of the control compete. In the first, hands go on as in the seconds before: a loop with a delay,

    u(t) = a + Kq·q(t − τ) + Kθ·[θ(t − τ) − θ0] + Ki·∫θ + w(t),   Kq, Kθ, Ki ≥ 0,

in which w is the hands' remnant, coloured noise of first order (McRuer & Krendel, Mathematical Models of
Human Pilot Behavior, AGARDograph 188, 1974). Hands may take over at the begin of the movement. In the second,
the loop ends where the movement begins. The movement has levels and edges of one length, or is larger than
the remnant before. All models have the same seconds before and the same samples. Each costs its likelihood
and half of log n for each number (Schwarz 1978); the difference is the log-odds.
"""

from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import dataclass, replace
from itertools import pairwise
from math import exp, inf, log

import numpy as np

from advisor.flight.maneuvers.maneuver import Maneuver, Span
from advisor.flight.maneuvers.movement import BAND, FREE_S, is_still
from advisor.flight.maneuvers.steady_speed import BIN_S, FEWEST, LEVEL, Bins, Motion, binned
from advisor.flight.signals.derived_alpha import integrated
from advisor.flight.signals.record import Channel
from advisor.process.arrays import FloatArray, IntArray

_REMNANT = 0.02
"""Variance of the remnant over that of the movement. Each displayed quantity, angle and rate, has 1 %
(Levison, Baron & Kleinman, IEEE Transactions on Man-Machine Systems 10, 1969)."""
_EDGE_BINS = 4
"""Least distance of the first and the last step of an own input, in bins. A hand-flown edge lasts 0.2 to
0.4 s."""
_WIDTHS = (1, 2, 3, 4)
"""Lengths of the input's edges, in bins: 0.1 to 0.4 s."""
_SMALL = 0.2
"""Least height of an edge of the input, over the highest edge. The first edge of a 3-2-1-1 with balanced
areas has a quarter."""
_NEW = 1e-6
"""Least fraction of a step's shape that earlier steps do not contain."""
_ROUNDING = 1e-8
"""Least variance of a model's residual, over that of the movement: rounding of the samples' means."""
_LEAST = 1e-16
"""Least sum of squares of a residual, rad²."""
_SHOWN = log(19.0)
"""Least log-odds for the conclusion that hands have flown before the input. The level is that of all
intervals.
"""
_MOST_STEPS = 14
"""Largest number of steps of an own input: two edges for each step of a 3-2-1-1 and its return, twice."""


@dataclass(frozen=True, slots=True)
class Own:
    """An own input within a movement, and its cost."""

    nats: float
    begins_s: float
    ends_s: float


class Cost:
    """Costs of models at one correlation of the remnant, in units of likelihood."""

    def __init__(self, bins: Bins, keep: float, loop: float) -> None:
        self.bins, self._keep = bins, keep
        self.moved = self.white(bins.moved)
        size = float(np.mean(bins.moved[bins.movement] ** 2))
        self._floor = _REMNANT * (1.0 - keep**2) * size
        self._least = _ROUNDING * size + _LEAST
        self.ratio = 1.0
        """Ratio of the remnant's variance before the movement to the variance within."""
        self.step = 1.5 * log(bins.within)
        """Cost of a step: half of log n for its size, and log n for its time."""
        self.loop = loop
        """Cost of a loop's gains and delay."""

    def white(self, y: FloatArray) -> FloatArray:
        """Return a series without the remnant's correlation, along the last axis."""
        out = y.copy()
        out[..., 1:] -= self._keep * y[..., :-1]
        return out

    def grown(self, before: float) -> "Cost":
        """Return the costs with a remnant that grows with the movement.

        Parameters
        ----------
        before
            Sum of squares of the seconds before.
        """
        other = copy(self)
        remnant = before / len(self.bins.hands) + self._least
        other.ratio = remnant / (remnant + self._floor)
        return other

    def of(self, left: float) -> float:
        """Return the cost of a weighted sum of squares over all bins."""
        bins = self.bins
        return 0.5 * (bins.count * log(left + self._least * bins.count) - bins.within * log(self.ratio))

    def of_two(self, before: float, within: float) -> float:
        """Return the cost with another variance within the movement; infinite unless it is larger."""
        n, m = self.bins.within, len(self.bins.hands)
        least, larger = before / m + self._least, within / n + self._floor
        if larger <= least:
            return inf
        count = log(self.bins.count)
        return 0.5 * (m * (log(least) + count) + n * (log(larger) + count) + log(n))


def stepped_input(
    cost: Cost, until: Callable[[int], float], before: float, whole: tuple[float, float]
) -> Own:
    """Return the input of levels and equal edges with the least cost, from the begin or after hands.

    Parameters
    ----------
    until
        Function that returns the sum of squares of the seconds before and of a movement's first bins.
    before
        Sum of squares of the seconds before.
    whole
        Begin and last step of the movement, s.
    """
    return min((_of_width(cost, until, before, whole, w) for w in _WIDTHS), key=lambda it: it.nats)


def _of_width(
    cost: Cost, until: Callable[[int], float], before: float, whole: tuple[float, float], width: int
) -> Own:
    """Return the input with the least cost whose edges are ``width`` bins long."""
    bins, n = cost.bins, cost.bins.within
    shapes = _edges(n, width)
    left, steps = _steps(cost, before, shapes)
    order = np.sort(np.array(steps, dtype=int))
    own = cost.ratio * np.append(np.cumsum((left**2)[::-1])[::-1], 0.0)
    fixed = cost.loop + log(len(_WIDTHS))
    best = cost.of(before + float(own[0])) + fixed + cost.step * len(steps)
    first = 0
    for k, begin in enumerate(order.tolist()):
        # One edge is no input: hands that take over make one.
        if begin < FEWEST or begin + _EDGE_BINS > order[-1]:
            continue
        left_over = cost.of(until(begin) + float(own[begin]))
        later = left_over + fixed + cost.step * (len(order) - k) + log(n) + _SHOWN
        if later < best:
            best, first = later, k
    order = order[first:]
    if len(order) == 0:
        return Own(best, *whole)
    begin, end = _extent(cost, order, shapes)
    return Own(
        best,
        whole[0] if begin == 0 else bins.begin_s(begin),
        whole[1] if end == n else bins.begin_s(end),
    )


def _extent(cost: Cost, order: IntArray, shapes: FloatArray) -> tuple[int, int]:
    """Return the first bin of the input that the steps form, and the bin of its last step.

    Before the input, hands hold no level away from the earlier level. Hands that rest for a free response
    after the input stay near that level. If hands flew until the first step, their level is the reference. If
    no hands are recognised, the extent is the whole movement, 0 to n.
    """
    n = cost.bins.within
    control = cost.bins.moved[cost.bins.movement]
    after_hands = order[0] >= FEWEST
    if after_hands:
        control = control - np.median(control[order[0] - LEVEL : order[0] - 1])
    moved = np.abs(control)
    fitted = np.linalg.lstsq(shapes[order][:, order[0] :].T, control[order[0] :], rcond=None)
    sizes = np.asarray(fitted[0], dtype=np.float64)
    edges = np.split(np.arange(len(order)), np.flatnonzero(np.diff(order) >= _EDGE_BINS) + 1)
    heights = np.array([_height(sizes[edge]) for edge in edges])
    least = _SMALL * np.max(heights)
    large = [edge for k, edge in enumerate(edges) if heights[k] >= least or (after_hands and k == 0)]
    near = BAND * float(np.max(moved))
    groups = [[large[0]]]
    for before, after in pairwise(large):
        rests = moved[order[before[-1]] + 1 : order[after[0]]]
        if len(rests) * BIN_S >= FREE_S[0] and float(np.median(rests)) < near:
            groups.append([])
        groups[-1].append(after)
    chosen = int(np.argmax([sum([_height(sizes[edge]) for edge in group]) for group in groups]))
    begin = int(order[groups[chosen][0][0]])
    if float(np.median(moved[: begin + 1])) >= near and is_still(control[:begin], float(np.max(moved))):
        begin = 0  # The first level of the input.
    last = n if chosen == len(groups) - 1 else int(order[groups[chosen][-1][-1]])
    return begin, last


def _height(steps: FloatArray) -> float:
    """Return the height of an edge that is made of steps, rad."""
    return float(np.max(np.abs(np.cumsum(steps))))


def _edges(n: int, width: int) -> FloatArray:
    """Return an edge of unit height that begins in each of ``n`` bins, shape (n, n)."""
    since = np.arange(n) - np.arange(n)[:, None] + 1.0
    return np.asarray(np.clip(since / width, 0.0, 1.0))


def _steps(cost: Cost, before: float, edges: FloatArray) -> tuple[FloatArray, list[int]]:
    """Return the movement's residual after its steps, and the steps' bins. Steps are added while each lowers
    the cost.

    Parameters
    ----------
    before
        Sum of squares of the seconds before.
    edges
        Shape (n, n): edge of unit height that begins in each bin.
    """
    n, shapes = cost.bins.within, cost.white(edges)
    moved = cost.moved[cost.bins.movement]
    left, steps = moved, list[int]()
    while len(steps) < min(_MOST_STEPS, n - 1):
        basis, _ = np.linalg.qr(shapes[steps].T)
        new = shapes - (shapes @ basis) @ basis.T
        size = np.einsum("ij,ij->i", new, new)
        gain = np.where(size > _NEW, (new @ left) ** 2 / np.maximum(size, _NEW), 0.0)
        k = int(np.argmax(gain))
        now = before + cost.ratio * squares(left)
        if cost.of(now) - cost.of(now - cost.ratio * float(gain[k])) < cost.step:
            break
        steps.append(k)
        basis, _ = np.linalg.qr(shapes[steps].T)
        left = moved - basis @ (basis.T @ moved)
    return left, steps


def squares(y: FloatArray) -> float:
    """Return the sum of squares of a series."""
    return float(y @ y)


_PARTS = 4
"""Number of straight lines between two samples. Four lines lose a sixteenth of the loss of one line."""


def command_of(maneuver: Maneuver, control: str) -> Channel:
    """Return the command of a control, without the samples before the record.

    A command that consists of sines gets further points between its samples.
    """
    command = maneuver.channels[control]
    if maneuver.span.kind != "multisine":
        return command
    kept = np.isfinite(command.y)
    t, y = between_samples(command.t[kept], command.y[kept])
    return replace(command, t=t, y=y)


def between_samples(t: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return times and values of a cubic spline through samples, with further points between the samples."""
    from scipy.interpolate import CubicSpline  # not on the start path

    part = np.arange(_PARTS) / _PARTS
    fine = np.append((t[:-1, None] + np.diff(t)[:, None] * part).ravel(), t[-1])
    return fine, CubicSpline(t, y)(fine)


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
