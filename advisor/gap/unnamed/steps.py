"""An instrument that reads in steps: its error goes up and down with what it reads, once a step.

No error of a model does that many times between the lowest and the highest reading, and noise not at all. In
quiet such a reading rests on one step or hops between two, which passes for noise.
"""

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.gap.fitting.fit import Fitted, rms_of
from advisor.gap.fitting.problem import Problem
from advisor.gap.noise.probes import SENSOR_CHANNELS
from advisor.gap.unnamed.leftover import OF_PEAK, Leftover

_FINEST, _COARSEST = OF_PEAK * np.sqrt(12.0), 0.6
"""Steps that are looked for, as shares of a channel's peak: errors of finer ones are small, and coarser ones
are seen as any other law is."""
_CELLS = 16
"""Into which the finest step is divided, to count the readings in ..."""
_FURTHER = 4
"""... and how many times as far as the readings reach they are counted: periods that are tried differ by a
quarter of one over the whole range of readings."""
_WIDEST = 1000.0
"""Peaks over which readings may reach: a model that has left the flight says nothing of an instrument."""
_GAIN = 100.0
"""Log likelihood that steps must bring ..."""
_SHARE = 0.1
"""... share of the channel's error that they must take up ..."""
_DEPTH = 0.4
"""... and how much of the error of exact steps they must have: noise before rounding blurs them."""
_GATHERED = 0.5
"""How much the readings must gather on the steps, 1 where they are nowhere else: noise after the rounding
spreads them from a fifth of a step on. A surface that sticks, and a stall, leave errors that go up and down
with a reading, too, but readings everywhere."""
_FINE = 0.1
"""Share of a channel's error without any name from which on what is left of it is worth an explanation."""
_NONE = (0.0, 0.0, 0.0)


def stepping(problem: Problem, first: Fitted, last: Fitted) -> Leftover | None:
    """The instrument that reads in steps, with a note that says how coarse; None where none does.

    Beside what was named, where that took nearly all, it is how finely a sound instrument reads.
    """
    taken = rms_of(problem, last.left) ** 2 < _FINE * rms_of(problem, first.left) ** 2
    found = [(_steps(problem, last, c), c) for c in problem.flights.telling if not taken[c]]
    (gain, step, power), c = max(found, key=lambda pair: pair[0][0], default=(_NONE, 0))
    if gain < _GAIN:
        return None
    block = next(b for b, channel in SENSOR_CHANNELS.items() if channel == problem.channels[c])
    in_quiet = np.zeros(len(problem.channels))
    in_quiet[c] = power
    percent = 100.0 * step / problem.flights.peaks[c]
    note = f"It reads in steps of {percent:.1f} % of the largest motion."
    return Leftover(block, 1.0, ((block, 1.0),), in_quiet, note)


def _steps(problem: Problem, last: Fitted, channel: int) -> tuple[float, float, float]:
    """Of the likeliest step of one channel: log likelihood, its size, and mean square of its error in quiet.

    Rounding to a step s makes an error whose first harmonic over the reading has the amplitude s/π.
    """
    name, peak = problem.channels[channel], problem.flights.peaks[channel]
    flights = list(zip(problem.flights.flights, last.left, strict=True))
    errors = [left[problem.rows(flight)[channel]] for flight, left in flights]
    readings = np.concatenate([f.outputs[name].y for f, _ in flights])
    model = readings - np.concatenate(errors)
    quiet = np.concatenate([f.is_quiet(f.outputs[name].t) for f, _ in flights])
    error = np.concatenate([e - np.mean(e) for e in errors])
    at_all = max(float(error @ error), 1e-300)
    # Half of the finest step's own error, and less: other numbers take up a part of it.
    if at_all < len(error) * (0.5 * OF_PEAK * peak) ** 2 or np.ptp(model) > _WIDEST * peak:
        return _NONE
    steps, amplitudes, explained = _harmonics(model, error, _FINEST * peak, _COARSEST * peak)
    deep = np.hypot(*amplitudes) > _DEPTH * steps / np.pi
    shares = np.where(deep & (explained > _SHARE * at_all), explained / at_all, 0.0)
    likeliest = int(np.argmax(shares))
    if shares[likeliest] == 0.0:
        return _NONE
    if np.abs(np.mean(np.exp(2j * np.pi * readings / steps[likeliest]))) < _GATHERED:
        return _NONE
    phase = 2.0 * np.pi * (model - np.min(model)) / steps[likeliest]
    course = amplitudes[:, likeliest] @ np.array([np.cos(phase), np.sin(phase)])
    course -= np.mean(course)
    gain = -0.5 * len(error) * float(np.log1p(-min(shares[likeliest], 0.999)))
    return gain, float(steps[likeliest]), float(np.mean(course[quiet] ** 2)) if np.any(quiet) else 0.0


def _harmonics(
    reading: FloatArray, error: FloatArray, finest: float, coarsest: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """First harmonics over the reading of an error without mean, by least squares, for all steps at once.

    Their sums over the samples are Fourier transforms of readings that were counted in cells.

    Returns
    -------
    steps, amplitudes, explained
        Shape (k,); (2, k) of cosine and sine, from the lowest reading on; (k,) the sum of squares taken up.
    """
    cell = finest / _CELLS
    cells = np.rint((reading - np.min(reading)) / cell).astype(int)
    points = 1 << int(np.ceil(np.log2(_FURTHER * max(np.max(cells), coarsest / cell))))
    k = np.arange(int(np.ceil(points * cell / coarsest)), points // _CELLS + 1)
    n, errors = len(error), np.fft.rfft(np.bincount(cells, error, points))[k]
    counted = np.fft.rfft(np.bincount(cells, minlength=points))
    mean, twice = counted[k] / n, counted[2 * k]
    cos_cos = 0.5 * (n + twice.real) - n * mean.real**2
    sin_sin = 0.5 * (n - twice.real) - n * mean.imag**2
    cos_sin = -0.5 * twice.imag + n * mean.real * mean.imag
    determinant = np.maximum(cos_cos * sin_sin - cos_sin**2, 1e-9 * n**2)
    cosines = (sin_sin * errors.real + cos_sin * errors.imag) / determinant
    sines = -(cos_cos * errors.imag + cos_sin * errors.real) / determinant
    explained = cosines * errors.real - sines * errors.imag
    return points * cell / k, np.array([cosines, sines]), explained
