"""Builds elevator histories as pilots, autopilots and parsers' enemies produce them."""

from dataclasses import dataclass, field

import numpy as np

from advisor.process.arrays import FloatArray

PATTERNS: dict[str, tuple[tuple[float, float], ...]] = {
    "3-2-1-1": ((3.0, -1.0), (2.0, 1.0), (1.0, -1.0), (1.0, 1.0)),
    "reverse 3-2-1-1": ((3.0, 1.0), (2.0, -1.0), (1.0, 1.0), (1.0, -1.0)),
    "doublet": ((1.0, -1.0), (1.0, 1.0)),
    "pulse": ((1.0, 1.0),),
    "other": ((2.0, 1.0), (1.0, -1.0), (1.0, 1.0)),
}
"""Levels of each input as (units of time, share of the amplitude); "other" is a 2-1-1."""


@dataclass
class Stream:
    """An elevator history and what was flown in it."""

    t: FloatArray
    u: FloatArray
    flown: list[tuple[str, float, float]] = field(default_factory=list)
    """(kind, first step s, last step s)."""


def stamps(rng: np.random.Generator, duration_s: float, rate_hz: float, jitter: float = 0.0) -> FloatArray:
    """Uneven stamps: each interval varied by a share of itself, none lost."""
    n = int(duration_s * rate_hz)
    return np.cumsum((1.0 + jitter * rng.uniform(-1.0, 1.0, n)) / rate_hz)


def coloured(rng: np.random.Generator, t: FloatArray, bandwidth_hz: float) -> FloatArray:
    """Gauss-Markov noise of unit standard deviation."""
    decay = np.exp(-2.0 * np.pi * bandwidth_hz * np.diff(t, prepend=t[0]))
    kicks = rng.standard_normal(len(t)) * np.sqrt(1.0 - decay**2)
    out = np.empty(len(t))
    state = rng.standard_normal()
    for i, (keep, kick) in enumerate(zip(decay, kicks, strict=True)):
        state = keep * state + kick
        out[i] = state
    return out


def steps(
    t: FloatArray, start_s: float, unit_s: float, levels: tuple[tuple[float, float], ...]
) -> FloatArray:
    """The pattern as ideal steps, zero outside."""
    u = np.zeros(len(t))
    onset = start_s
    for units, level in levels:
        u[(t >= onset) & (t < onset + units * unit_s)] = level
        onset += units * unit_s
    return u


def length(levels: tuple[tuple[float, float], ...]) -> float:
    """Duration of a pattern in units."""
    return sum(units for units, _ in levels)


def slewed(t: FloatArray, u: FloatArray, time_s: float) -> FloatArray:
    """Steps drawn out into ramps of this length: a moving average looking both ways."""
    if time_s <= 0.0:
        return u
    integral = np.concatenate(([0.0], np.cumsum(u[:-1] * np.diff(t))))
    after = np.interp(t + time_s / 2, t, integral)
    before = np.interp(t - time_s / 2, t, integral)
    return (after - before) / time_s
