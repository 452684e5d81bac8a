"""Sustained oscillations: a line in the spectrum, in quiet as well as with a moving stick.

Propeller vibration, sloshing fuel, a hunting servo or a shaking sensor continue where nothing is flown. The
noise of the flight is estimated there, so most of such an oscillation passes for coloured noise. Coloured
noise, however, does not concentrate power in one line, and the whitened residual shows the line. The block in
which an oscillation of that frequency explains all channels best is its source.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.gap.fitting.fit import EffectFit
from advisor.gap.fitting.linear import pulse_response
from advisor.gap.fitting.problem import EffectProblem, row_weights
from advisor.gap.fitting.step import factor
from advisor.gap.noise.probes import DYNAMIC, SENSOR_CHANNELS, Probe
from advisor.gap.simulator.layout import OUTPUTS
from advisor.oem.arrow import solved

_SWINGS = 5.0
"""Record: least number of periods in a record. Slower motion is a drift, or the aircraft's own."""
_LINE = 3.0
"""Numerical: half width of a line, in inverse lengths of a record: Hann's window and a little damping."""
_ABOVE = 3.8
"""Least power of a line relative to white noise, and relative to the highest power elsewhere. A damped motion
reaches 3.4."""
_POINTS = 4096
"""Numerical: least number of points of the spectrum."""


@dataclass(frozen=True)
class SpectralLine:
    """A sustained oscillation."""

    hz: float
    """Frequency, Hz."""
    probes: tuple[Probe, ...]
    """Oscillation of that frequency in every block, likeliest first; sizes are amplitudes."""
    power: FloatArray
    """Shape (channels,): mean square of the oscillation in each channel, SI."""


def spectral_line_in(problem: EffectProblem, fitted: EffectFit, noise: FloatArray) -> SpectralLine | None:
    """Return the oscillation in the residual of a fit; None where no channel has a line in its spectrum.

    Parameters
    ----------
    noise
        Shape (channels,): noise of the innovations.
    """
    lines = (line_of(*_records(problem, fitted, c)) for c in problem.flights.telling)
    hz, stands_out = max(lines, key=lambda line: line[1])
    if stands_out < _ABOVE:
        return None
    blocks = [b for b in DYNAMIC if b != "air" or problem.flights.shows_air]
    blocks += [b for b, channel in SENSOR_CHANNELS.items() if channel in problem.channels]
    found = sorted((_swing(problem, fitted, noise, b, hz) for b in blocks), key=lambda x: -x[0].gain)
    return SpectralLine(hz, tuple(probe for probe, _ in found), found[0][1])


def line_of(records: Sequence[FloatArray], interval_s: float) -> tuple[float, float]:
    """Return the frequency of the strongest line, Hz, and its prominence.

    The prominence is the power of the line over white noise of equal variance, or over the highest power off
    the line, whichever is smaller. Samples count as equally spaced.
    """
    long = [r for r in records if len(r) > 2.0 * _SWINGS]
    if not long:
        return 0.0, 0.0
    points = max(_POINTS, *map(len, long))
    hz = np.fft.rfftfreq(points, interval_s)
    power = np.mean([_spectrum(r, points) for r in long], axis=0)
    per_record = 1.0 / (interval_s * float(np.median([len(r) for r in long])))
    fast = hz >= _SWINGS * per_record
    if not np.any(fast):
        return 0.0, 0.0
    peak = int(np.argmax(np.where(fast, power, 0.0)))
    off = np.abs(hz - hz[peak]) > _LINE * per_record
    return float(hz[peak]), float(power[peak] / max(1.0, float(np.max(power[off], initial=0.0))))


def ringing_hz(problem: EffectProblem, fitted: EffectFit, lowest: float, highest: float) -> float | None:
    """Return the frequency between two limits with the most residual power of the pitch rate; None without
    samples."""
    if "q" not in problem.channels:
        return None
    records, interval_s = _records(problem, fitted, problem.channels.index("q"))
    points = max(_POINTS, *map(len, records))
    hz = np.fft.rfftfreq(points, interval_s)
    power = np.mean([_spectrum(r, points) for r in records], axis=0)
    inside = (hz > lowest) & (hz < highest)
    return float(hz[int(np.argmax(np.where(inside, power, 0.0)))]) if np.any(inside) else None


def _spectrum(record: FloatArray, points: int) -> FloatArray:
    """Return the power at each frequency, with a mean of 1 for white noise."""
    window = np.hanning(len(record))
    swing = np.fft.rfft((record - record.mean()) * window, points)
    return np.asarray(np.abs(swing) ** 2 / max(float(window @ window) * float(np.var(record)), 1e-300))


def _records(problem: EffectProblem, fitted: EffectFit, channel: int) -> tuple[list[FloatArray], float]:
    """Return the innovations of one channel by manoeuvre, and the interval of its samples in s."""
    name = problem.channels[channel]
    records, intervals = [], []
    for flight, e in zip(problem.flights.flights, fitted.innovations, strict=True):
        records.append(e[problem.rows(flight)[channel]])
        intervals.append(np.diff(flight.outputs[name].t))
    return records, float(np.median(np.concatenate(intervals)))


def _swing(
    problem: EffectProblem, fitted: EffectFit, noise: FloatArray, block: str, hz: float
) -> tuple[Probe, FloatArray]:
    """Return a swing in one block, its amplitude and phase free in every manoeuvre; and its power by
    channel."""
    p = problem.driving(fitted.point)
    gain, before, sizes = 0.0, 0.0, []
    power, count = np.zeros(len(problem.channels)), np.zeros(len(problem.channels))
    for i, flight in enumerate(problem.flights.flights):
        turning = np.exp(2j * np.pi * hz * flight.h * np.arange(flight.n + 1))
        if block in SENSOR_CHANNELS:
            response = np.zeros((4, flight.n + 1), dtype=complex)
            response[OUTPUTS.index(SENSOR_CHANNELS[block])] = turning
        else:
            pulse = pulse_response(problem, flight, p[i], DYNAMIC[block])
            response = turning * np.cumsum(pulse * turning.conj(), axis=1) * flight.h
        seen = problem.read_grids(flight, [response.real, response.imag], p[i])
        w = row_weights(problem, i, 1.0 / noise)
        B, A = problem.innovations(i, seen) * w[:, None], fitted.linear[i].own * w[:, None]
        r = fitted.innovations[i] * w
        chol = factor(A, fitted.linear[i].prior)
        AB = A.T @ B
        score = B.T @ r - AB.T @ solved(chol, A.T @ r)
        found = np.linalg.lstsq(B.T @ B - AB.T @ solved(chol, AB), score, rcond=1e-10)[0]
        gain += 0.5 * float(score @ found)
        before += float(r @ r)
        sizes.append(float(np.hypot(*found)))
        swung = seen @ found
        for c, rows in enumerate(problem.rows(flight)):
            power[c] += float(np.sum(swung[rows] ** 2))
            count[c] += len(swung[rows])
    explained = min(2.0 * gain / max(before, 1e-300), 1.0)
    return Probe(block, gain, float(np.median(sizes)), explained), power / np.maximum(count, 1.0)
