"""From the stick to the surface: delay, lag, rate limit, play and dead band, each switched off by a zero."""

import numpy as np
from numba import njit

from advisor.flight.messages import FloatArray
from advisor.gap.layout import INDEX

_READ = tuple(INDEX[name] for name in (
    "delay_s", "latency_s", "lag_s", "lag_damping", "slowness_s_rad",
    "half_play_rad", "play_side", "half_deadband_rad", "neutral_rad",
))  # fmt: skip
DELAY, LATENCY, LAG, LAG_DAMPING, SLOWNESS, PLAY, PLAY_SIDE, DEADBAND, NEUTRAL = _READ


@njit(cache=True)
def surfaces(
    h: float, n: int, t_u: FloatArray, u: FloatArray, held: bool, trim: float, p: FloatArray, lanes: int
) -> FloatArray:
    """Deflections for every row of ``p``, shape (k, entries), in lanes as ``simulate`` takes them.

    Shape (packs, n, lanes). Most rows differ in numbers of which the surface knows nothing: those share a
    deflection. Lanes to spare repeat the last one.
    """
    packs = (len(p) + lanes - 1) // lanes
    different = np.empty((len(p), n))
    which = np.empty(packs * lanes, dtype=np.int64)
    count = 0
    for j in range(packs * lanes):
        if j == 0 or (j < len(p) and _differ(p[j], p[j - 1])):
            different[count] = surface(h, n, t_u, u, held, trim, p[j])
            count += 1
        which[j] = count - 1
    out = np.empty((packs, n, lanes))
    for pack in range(packs):
        for i in range(n):
            for lane in range(lanes):
                out[pack, i, lane] = different[which[pack * lanes + lane], i]
    return out


@njit(cache=True)
def _differ(one: FloatArray, other: FloatArray) -> bool:
    differ = False
    for entry in _READ:
        differ = differ or one[entry] != other[entry]
    return differ


@njit(cache=True)
def surface(
    h: float, n: int, t_u: FloatArray, u: FloatArray, held: bool, trim: float, p: FloatArray
) -> FloatArray:
    """Mean deflection over each step, relative to trim, after everything between stick and surface.

    The command is averaged over the step by its exact integral, so that an edge inside a step
    keeps its area and the result is smooth in the delay.
    """
    out = np.empty(n)
    k = 0
    late = p[DELAY] + p[LATENCY]
    tau, slow, play, dead = p[LAG], p[SLOWNESS], max(p[PLAY], 0.0), max(p[DEADBAND], 0.0)
    decay = np.exp(-h / tau) if tau > 1e-6 else 0.0
    # A servo of second order that trails a ramp by τ = 2 ζ/ω, solved exactly for what it is told in a step.
    zeta = p[LAG_DAMPING] if tau > 1e-3 else 0.0
    omega = 2.0 * zeta / max(tau, 1e-3)
    damped = np.sqrt(max(1.0 - zeta * zeta, 1e-6))
    fade = np.exp(-zeta * omega * h)
    swing_cos, swing_sin = np.cos(omega * damped * h), np.sin(omega * damped * h) / damped
    rate = 0.0
    servo = np.nan
    link = 0.0
    last = len(u) - 1
    for i in range(n):
        a, b = i * h - late, (i + 1) * h - late
        while k > 0 and t_u[k] > a:
            k -= 1
        total, at = 0.0, a
        if a < t_u[0]:
            upto = min(b, t_u[0])
            total += (upto - a) * u[0]
            at = upto
        while at < b - 1e-12:
            while k < last and t_u[k + 1] <= at + 1e-12:
                k += 1
            upto = b if k == last else min(b, t_u[k + 1])
            if held or k == last:
                total += (upto - at) * u[k]
            else:
                slope = (u[k + 1] - u[k]) / (t_u[k + 1] - t_u[k])
                total += (upto - at) * (u[k] + slope * (0.5 * (at + upto) - t_u[k]))
            at = upto
        want = total / h - trim
        if dead > 0.0:
            want = _beyond(want - p[NEUTRAL], dead) - _beyond(-p[NEUTRAL], dead)
        if np.isnan(servo):
            servo = want
            link = want + p[PLAY_SIDE] * play
        if omega > 0.0:
            off, before_rate = servo - want, rate
            to = want + fade * ((swing_cos + zeta * swing_sin) * off + swing_sin * rate / omega)
            rate = fade * ((swing_cos - zeta * swing_sin) * rate - omega * swing_sin * off)
            mean = 0.5 * (servo + to) + h * (before_rate - rate) / 12.0
        elif tau > 1e-6:
            to = decay * servo + (1.0 - decay) * want
            mean = want + (servo - want) * (tau / h) * (1.0 - decay)
        else:
            # First order in τ, so that the sensitivity to a lag exists at no lag at all.
            to, mean = want, want + (servo - want) * tau / h
        if slow > 0.0 and abs(to - servo) * slow > h:
            to = servo + np.sign(to - servo) * h / slow
            mean = 0.5 * (servo + to)
        servo = to
        if play > 0.0:
            before = link
            link = min(max(link, servo - play), servo + play)
            mean = 0.5 * (before + link)
        out[i] = mean
    return out


@njit(cache=True)
def _beyond(x: float, dead: float) -> float:
    return float(np.sign(x) * max(abs(x) - dead, 0.0))
