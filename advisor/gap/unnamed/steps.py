"""An instrument that reads in steps: its error goes up and down with what it reads, once a step.

No error of a model does that many times between the lowest and the highest reading, and noise not at all. In
quiet such a reading rests on one step or hops between two, which passes for noise.
"""

import numpy as np

from advisor.gap.fitting.fit import Fitted
from advisor.gap.fitting.problem import Problem
from advisor.gap.noise.probes import SENSOR_CHANNELS
from advisor.gap.unnamed.leftover import OF_PEAK, Leftover

_FINEST, _COARSEST = OF_PEAK * np.sqrt(12.0), 0.15
"""Steps that are looked for, as shares of a channel's peak: errors of finer ones are small, and coarser ones
are seen as any other law is."""
_TRIED = 200
"""Steps between these: their periods differ by less than one over the whole range of readings."""
_GAIN = 100.0
"""Log likelihood that steps must bring ..."""
_SHARE = 0.1
"""... share of the channel's error that they must take up ..."""
_DEPTH = 0.4
"""... and how much of the error of exact steps they must have: noise before rounding blurs them."""


def stepping(problem: Problem, last: Fitted) -> Leftover | None:
    """The instrument that reads in steps, with a note that says how coarse; None where none does."""
    found = [(_steps(problem, last, c), c) for c in problem.flights.telling]
    (gain, step, power), c = max(found, key=lambda pair: pair[0][0], default=((0.0, 0.0, 0.0), 0))
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
    model = np.concatenate([f.outputs[name].y - e for (f, _), e in zip(flights, errors, strict=True)])
    quiet = np.concatenate([f.is_quiet(f.outputs[name].t) for f, _ in flights])
    error = np.concatenate([e - np.mean(e) for e in errors])
    at_all = max(float(error @ error), 1e-300)
    best = (0.0, 0.0, 0.0)
    if at_all < len(error) * (0.5 * OF_PEAK * peak) ** 2:
        # Half of the finest step's own error, and less: other numbers take up a part of it.
        return best
    for step in peak * np.geomspace(_FINEST, _COARSEST, _TRIED):
        phase = 2.0 * np.pi * model / step
        waves = np.column_stack([np.cos(phase), np.sin(phase)])
        waves -= waves.mean(axis=0)
        sizes = np.linalg.lstsq(waves.T @ waves, waves.T @ error, rcond=1e-9)[0]
        course = waves @ sizes
        share = float(course @ error) / at_all
        gain = -0.5 * len(error) * float(np.log1p(-min(share, 0.999)))
        deep = float(np.hypot(*sizes)) > _DEPTH * step / np.pi
        if share > _SHARE and deep and gain > best[0]:
            best = (gain, float(step), float(np.mean(course[quiet] ** 2)) if np.any(quiet) else 0.0)
    return best
