"""A pitch gyro that is mounted askew: it reads a part of the roll rate, though nothing pitches.

IEEE Std 1431 calls it the misalignment of the input axis. What the gyro reads of a roll the attitude knows
nothing of; a moment that comes with a roll would pitch the aircraft.
"""

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.gap.fitting.fit import Fitted
from advisor.gap.fitting.problem import Problem
from advisor.gap.records.flights import Flight
from advisor.gap.unnamed.leftover import Leftover

_LEAST = 0.05
"""Share of the roll rate: three degrees. No instrument is mounted better than within one or two."""
_SIGMAS = 5.0
"""Standard deviations of their mean, by the scatter between manoeuvres, that the shares must have ..."""
_SHARE = 0.5
"""... and part of what is left in the pitch rate that they must explain."""
_FELT = 0.5
"""Part of it that the attitude may show at most."""


def crossed_axes(problem: Problem, last: Fitted) -> Leftover | None:
    """The share of the roll rate in what is left of the pitch rate; None where there is next to none."""
    flights = problem.flights
    if not {"q", "theta"} <= set(flights.channels) or any(f.roll_rate is None for f in flights.flights):
        return None
    q, theta = flights.channels.index("q"), flights.channels.index("theta")
    read, felt, rates, power, total = [], [], [], 0.0, 0.0
    for flight, left in zip(flights.flights, last.left, strict=True):
        rows = problem.rows(flight)
        rolled, e = _about_mean(_rolled(flight, "q", 0)), _about_mean(left[rows[q]])
        if not np.any(rolled):
            return None
        read.append(float(rolled @ e / (rolled @ rolled)))
        bank, pitched = _detrended(_rolled(flight, "theta", 1)), _detrended(left[rows[theta]])
        felt.append(float(bank @ pitched / max(float(bank @ bank), 1e-12)))
        rates.append(float(np.mean(rolled**2)))
        power += float(rolled @ e) * read[-1]
        total += float(e @ e)
    share, scatter = float(np.mean(read)), float(np.std(read)) / np.sqrt(max(len(read) - 1, 1))
    if len(read) < 2 or abs(share) < max(_LEAST, _SIGMAS * scatter) or power < _SHARE * total:
        return None
    if abs(float(np.mean(felt))) > _FELT * abs(share):
        return None
    quiet = np.zeros(len(flights.channels))
    quiet[q] = share**2 * float(np.mean(rates))
    note = f"The pitch rate reads {100.0 * share:+.0f} % of the roll rate: the gyro is mounted askew."
    block = "pitch_rate_sensor"
    return Leftover(block, power / total, ((block, 1.0),), quiet, note)


def _rolled(flight: Flight, channel: str, integrals: int) -> FloatArray:
    """The roll rate, or its integral, at the stamps of a channel."""
    assert flight.roll_rate is not None
    rate = flight.roll_rate if not integrals else np.cumsum(flight.roll_rate) * flight.h
    return np.interp(flight.outputs[channel].t, (np.arange(flight.n) + 0.5) * flight.h, rate)


def _about_mean(y: FloatArray) -> FloatArray:
    return np.asarray(y - np.mean(y))


def _detrended(y: FloatArray) -> FloatArray:
    t = np.linspace(-1.0, 1.0, len(y))
    return np.asarray(y - np.polyval(np.polyfit(t, y, 1), t))
