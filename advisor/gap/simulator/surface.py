"""From command to surface: delay, lag, rate limit, play, dead band and stops, each switched off by zero."""

import numpy as np

from advisor.gap.simulator.layout import AT, LAYOUT, OTHER_LAYOUT
from advisor.gap.simulator.servo import ARRIVED_RAD, through_friction, through_servo
from advisor.process.arrays import FloatArray
from advisor.process.compiled import kernel

_READ = (
    AT.delay_s, AT.latency_s, AT.lag_s, AT.lag_damping, AT.slowness_s_rad,
    AT.half_play_rad, AT.play_side, AT.half_deadband_rad, AT.neutral_rad, AT.stop_up_rad, AT.stop_down_rad,
    AT.breakaway_rad, AT.sliding_share, AT.loop_s,
)  # fmt: skip
"""Entries of the simulator that change a deflection."""

_UNLIMITED = 1e6
"""Rate of a servo without a rate limit, rad/s: fast enough for a step to take no time."""


@kernel()
def surfaces(
    layout: int, h: float, n: int, t_u: FloatArray, u: FloatArray, held: bool, trim: float, p: FloatArray
) -> tuple[FloatArray, np.ndarray]:
    """Return the distinct deflections among the rows of ``p``, shape (k, entries), and the index for each
    row.

    Deflections have shape (different, 2, n): the mean over each step, and that mean minus the deflection at
    the start of the step. The second result has shape (k,), int64. Raises ValueError where the function was
    compiled for another ``layout`` (``layout.LAYOUT``).
    """
    if layout != LAYOUT or p.shape[1] != len(AT):
        raise ValueError(OTHER_LAYOUT)
    different = np.empty((len(p), 2, n))
    which, first = np.empty(len(p), dtype=np.int64), np.empty(len(p), dtype=np.int64)
    count = 0
    for j in range(len(p)):
        found = 0
        while found < count and _differ(p[j], p[first[found]]):
            found += 1
        which[j] = found
        if found == count:
            different[count, 0] = surface(h, n, t_u, u, held, trim, p[j])
            different[count, 1] = above_start(different[count, 0])
            first[count] = j
            count += 1
    return different, which


@kernel()
def _differ(one: FloatArray, other: FloatArray) -> bool:
    differ = False
    for entry in _READ:
        differ = differ or one[entry] != other[entry]
    return differ


@kernel()
def above_start(mean: FloatArray) -> FloatArray:
    """Return the mean over each step minus the value at the start of the step, shape (n,).

    Two steps meet at the step's start, and the flatter step decides.
    """
    n = len(mean)
    out = np.empty(n)
    for j in range(n):
        before, here = mean[max(j - 1, 0)], mean[j]
        jump = here - before
        left = 0.5 * _lesser(before - mean[max(j - 2, 0)], jump)
        right = 0.5 * _lesser(jump, mean[min(j + 1, n - 1)] - here)
        out[j] = jump - left if abs(left) <= abs(right) else right
    return out


@kernel()
def _lesser(one: float, other: float) -> float:
    """Return the smaller of two differences of equal sign; zero where their signs differ."""
    lesser = one if abs(one) < abs(other) else other
    return lesser if one * other > 0.0 else 0.0


@kernel()
def surface(
    h: float, n: int, t_u: FloatArray, u: FloatArray, held: bool, trim: float, p: FloatArray
) -> FloatArray:
    """Return the mean deflection over each step, relative to trim, after all parts from command to surface.

    The command consists of pieces that end at its stamps. Nonlinear parts take every piece separately, so
    that an edge inside a step keeps its area. Linear parts use the mean of the command over the step. The
    mean deflection is smooth in the delay. A command before the first step moves the servo until then.
    """
    out = np.empty(n)
    k = 0
    late = p[AT.delay_s] + p[AT.latency_s]
    tau, slow = p[AT.lag_s], p[AT.slowness_s_rad]
    play = max(p[AT.half_play_rad], 0.0)
    decay = np.exp(-h / tau) if tau > 1e-6 else 0.0
    # A second-order servo that trails a ramp by τ = 2 ζ/ω, solved exactly for the mean command of a step.
    zeta = p[AT.lag_damping] if tau > 1e-3 else 0.0
    omega = 2.0 * zeta / max(tau, 1e-3)
    damped = np.sqrt(max(1.0 - zeta * zeta, 1e-6))
    fade = np.exp(-zeta * omega * h)
    swing_cos, swing_sin = np.cos(omega * damped * h), np.sin(omega * damped * h) / damped
    holds = p[AT.breakaway_rad]
    by_pieces = (slow > 0.0 or play > 0.0 or holds > 0.0) and omega == 0.0
    most = 1.0 / slow if slow > 0.0 else _UNLIMITED
    rate = 0.0
    servo = np.nan
    link = way = 0.0
    last = len(u) - 1
    for i in range(min(0, int(np.floor(t_u[0] / h))), n):
        at, b = i * h - late, (i + 1) * h - late
        while k > 0 and t_u[k] > at:
            k -= 1
        total = area = 0.0
        while at < b - 1e-12:
            while k < last and t_u[k + 1] <= at + 1e-12:
                k += 1
            upto, begin, end = _piece(k, at, b, t_u, u, held, trim)
            begin, end, mean = _limited(begin, end, p)
            if np.isnan(servo):
                servo = begin
                link = begin + p[AT.play_side] * max(play, holds)
            if holds > 0.0:
                link, way, swept = through_friction(
                    link, way, begin, end, upto - at, holds, p[AT.sliding_share] * holds, p[AT.loop_s]
                )
                area += swept
            elif by_pieces:
                servo, link, swept = through_servo(servo, link, begin, end, upto - at, tau, most, play)
                area += swept
            total += mean * (upto - at)
            at = upto
        if by_pieces:
            out[max(i, 0)] = area / h
            continue
        want = total / h
        if omega > 0.0:
            off, before_rate = servo - want, rate
            to = want + fade * ((swing_cos + zeta * swing_sin) * off + swing_sin * rate / omega)
            rate = fade * ((swing_cos - zeta * swing_sin) * rate - omega * swing_sin * off)
            mean = 0.5 * (servo + to) + h * (before_rate - rate) / 12.0
        else:
            to, mean = _first_order(servo, want, h, tau, decay)
        if slow > 0.0 and abs(to - servo) * slow > h:
            to = servo + np.sign(to - servo) * h / slow
            mean = 0.5 * (servo + to)
        servo = to
        if play > 0.0:
            before = link
            link = min(max(link, servo - play), servo + play)
            mean = 0.5 * (before + link)
        out[max(i, 0)] = mean
    return out


@kernel()
def _piece(
    k: int, at: float, until: float, t_u: FloatArray, u: FloatArray, held: bool, trim: float
) -> tuple[float, float, float]:
    """Return the end of the command piece that begins at time ``at``, and the values at both ends.

    ``k`` is the index of the last stamp up to ``at``, ``until`` the end of the step. Values in rad from trim.
    """
    if at < t_u[0]:
        return min(until, t_u[0]), u[0] - trim, u[0] - trim
    if k == len(u) - 1:
        return until, u[k] - trim, u[k] - trim
    upto = min(until, t_u[k + 1])
    slope = 0.0 if held else (u[k + 1] - u[k]) / (t_u[k + 1] - t_u[k])
    begin = u[k] + slope * (at - t_u[k]) - trim
    return upto, begin, begin + slope * (upto - at)


@kernel()
def _limited(begin: float, end: float, p: FloatArray) -> tuple[float, float, float]:
    """Return the ends and the mean of a linear command piece after the dead band and the stops.

    ``begin`` and ``end`` are relative to trim, rad; ``p`` has shape (entries,).
    """
    dead, neutral = max(p[AT.half_deadband_rad], 0.0), p[AT.neutral_rad]
    up, down = p[AT.stop_up_rad], p[AT.stop_down_rad]
    mean = 0.5 * (begin + end)
    if dead > 0.0:
        mean = _mean_beyond(begin - neutral, end - neutral, dead) - _beyond(-neutral, dead)
        begin = _beyond(begin - neutral, dead) - _beyond(-neutral, dead)
        end = _beyond(end - neutral, dead) - _beyond(-neutral, dead)
    if up > 0.0:
        mean -= _mean_over(begin, end, up)
        begin, end = min(begin, up), min(end, up)
    if down > 0.0:
        mean += _mean_over(-begin, -end, down)
        begin, end = max(begin, -down), max(end, -down)
    return begin, end, mean


@kernel()
def _first_order(servo: float, want: float, h: float, tau: float, decay: float) -> tuple[float, float]:
    """Return the deflection of a servo with a lag of ``tau`` s at the end of a step, and its mean over the
    step.

    ``want`` is the mean of the command over the step of ``h`` s, ``decay`` is exp(-h/tau).
    """
    if tau > 1e-6:
        return decay * servo + (1.0 - decay) * want, want + (servo - want) * (tau / h) * (1.0 - decay)
    # First order in τ, so that the sensitivity to a lag exists at no lag at all.
    return want, want + (servo - want) * tau / h


@kernel()
def _beyond(x: float, dead: float) -> float:
    return float(np.sign(x) * max(abs(x) - dead, 0.0))


@kernel()
def _mean_beyond(begin: float, end: float, dead: float) -> float:
    """Return the mean of the part beyond the dead band as the argument moves linearly from begin to end."""
    if abs(end - begin) < ARRIVED_RAD:
        return float(_beyond(begin, dead))
    squares = max(abs(end) - dead, 0.0) ** 2 - max(abs(begin) - dead, 0.0) ** 2
    return float(0.5 * squares / (end - begin))


@kernel()
def _mean_over(begin: float, end: float, top: float) -> float:
    """Return the mean of the part above a stop while the argument moves linearly from begin to end."""
    if abs(end - begin) < ARRIVED_RAD:
        return float(max(begin - top, 0.0))
    squares = max(end - top, 0.0) ** 2 - max(begin - top, 0.0) ** 2
    return float(0.5 * squares / (end - begin))
