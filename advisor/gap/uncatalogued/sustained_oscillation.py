"""Something that swings at one frequency, and where it is."""

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.gap.fitting.fit import Fitted, rms_of
from advisor.gap.fitting.problem import Problem
from advisor.gap.noise.probes import SENSOR_CHANNELS
from advisor.gap.uncatalogued.spectral_line import SpectralLine, spectral_line_in
from advisor.gap.uncatalogued.unexplained import (
    LEAST_GAIN,
    LEAST_OF_GAP,
    OF_PEAK,
    Unexplained,
    innovation_noise,
    instruments_of,
    ranking_of,
)

_OF_PEAK_SWINGING = 0.005
"""Share of a channel's peak that a swing of the aircraft must be: no error of a model looks like that."""
_VISIBLE = 0.05
"""Power of a swing, beside the instruments' noise, from which on there is something to explain."""
_SHAKEN = 4.0
"""Power of a swing of the accelerometer alone: an engine shakes every one, and samples make a slow swing of
that."""


def sustained_oscillation(
    problem: Problem, first: Fitted, last: Fitted, tolerance: FloatArray
) -> Unexplained | None:
    """What swings of itself, where it is more than an instrument's noise. Arguments as in ``unexplained_residual``."""
    noise, instruments = innovation_noise(problem), np.maximum(instruments_of(problem), 1e-12)
    line = spectral_line_in(problem, last, noise)
    if line is None or line.probes[0].gain < LEAST_GAIN or line.probes[0].block == "air":
        return None
    best = line.probes[0]
    least = OF_PEAK if best.block in SENSOR_CHANNELS else _OF_PEAK_SWINGING
    if not np.any(line.power > np.maximum(least * problem.flights.peaks, tolerance) ** 2):
        return None
    beside = line.power / instruments**2
    if float(np.mean(beside)) < _VISIBLE or (_may_be_vibration(line) and np.max(beside) < _SHAKEN):
        return None
    powers = (rms_of(problem, last.innovations) / noise) ** 2
    taken = float(np.sum((rms_of(problem, first.innovations) / noise) ** 2 - powers))
    if best.explained * float(np.sum(powers)) < LEAST_OF_GAP * taken:
        return None
    note = f"It swings by itself, {line.hz:.2g} times a second."
    return Unexplained(best.block, best.explained, ranking_of(line.probes, best.block), line.power, note)


def _may_be_vibration(line: SpectralLine) -> bool:
    """Whether a swing is the accelerometer's, or a force's so fast that nothing else feels it."""
    best = line.probes[0]
    accelerometer = next((p.gain for p in line.probes if p.block == "accelerometer"), 0.0)
    return best.block in ("accelerometer", "force_equation") and accelerometer > best.gain - LEAST_GAIN
