"""A sustained oscillation as unexplained residual, and the block in which it arises."""

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.gap.decision import BEYOND_DOUBT
from advisor.gap.fitting.fit import EffectFit, rms_of
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.result import VISIBLE
from advisor.gap.uncatalogued.spectral_line import SpectralLine, spectral_line_in
from advisor.gap.uncatalogued.unexplained import (
    LEAST_OF_GAP,
    OF_PEAK,
    Unexplained,
    innovation_noise,
    instruments_of,
    ranking_of,
)

_SHAKEN = 4.0
"""Least power of an oscillation in the accelerometer alone, relative to its noise. An engine shakes every
accelerometer, and sampling turns that into a slow oscillation."""


def sustained_oscillation(
    problem: EffectProblem, first: EffectFit, last: EffectFit, tolerance: FloatArray
) -> Unexplained | None:
    """Return a sustained oscillation that exceeds the instruments' noise, or None.

    The arguments are those of ``unexplained_residual``.
    """
    noise, instruments = innovation_noise(problem), np.maximum(instruments_of(problem), 1e-12)
    line = spectral_line_in(problem, last, noise)
    if line is None or line.probes[0].gain < BEYOND_DOUBT or line.probes[0].block == "air":
        return None
    best = line.probes[0]
    if not np.any(line.power > np.maximum(OF_PEAK * problem.flights.peaks, tolerance) ** 2):
        return None
    over_noise = line.power / instruments**2
    if float(np.mean(over_noise)) < VISIBLE or (_may_be_vibration(line) and np.max(over_noise) < _SHAKEN):
        return None
    powers = (rms_of(problem, last.innovations) / noise) ** 2
    taken = float(np.sum((rms_of(problem, first.innovations) / noise) ** 2 - powers))
    if best.explained * float(np.sum(powers)) < LEAST_OF_GAP * taken:
        return None
    note = f"It swings by itself, {line.hz:.2g} times a second."
    return Unexplained(best.block, best.explained, ranking_of(line.probes, best.block), line.power, note)


def _may_be_vibration(line: SpectralLine) -> bool:
    """Return whether the oscillation may be vibration of the accelerometer.

    A force that varies too fast for other channels looks the same.
    """
    best = line.probes[0]
    accelerometer = next((p.gain for p in line.probes if p.block == "accelerometer"), 0.0)
    return best.block in ("accelerometer", "force_equation") and accelerometer > best.gain - BEYOND_DOUBT
