"""Orthogonal multisines: inputs on several controls at once that an estimate can separate.

Each control has harmonics of its own of one base frequency. Over the whole length the inputs are then
uncorrelated. The phases keep the peaks low by clipping, and a shift in time makes every input begin and end
at zero. Source: Klein and Morelli, *Aircraft System Identification*, Sec. 9.3. Van der Ouderaa, Schoukens and
Renneboog 1988 describe the clipping.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from advisor.process.arrays import FloatArray

_MOST_LINES = 7
"""Number of harmonics of one control. Seven harmonics on each of three controls gave 20 derivatives within 6
%.
"""
_STARTS = 4
"""Number of sets of phases from which the clipping begins: Schroeder's, and random ones of a fixed seed. The
clipping ends in a local minimum, and the best of four has a relative peak factor below 1.25."""
_CLIPPINGS = 60
"""Number of clippings from each start. The peaks of seven harmonics hardly fall after about 50."""
_CLIPPED = (0.75, 0.99)
"""First and last level of the clipping, as shares of the peak. The level rises with each clipping."""
_SAMPLES = 16
"""Samples for each period of the highest harmonic. A peak exceeds the samples by at most 2 %."""


@dataclass(frozen=True, slots=True)
class Multisine:
    """Sum of harmonics of equal power on one control, with a peak of 1."""

    harmonics: tuple[int, ...]
    """Number of periods of each sine within the multisine's length."""
    amplitude: float
    """Amplitude of every sine for which the peak of the sum is 1."""
    phases_rad: tuple[float, ...]

    def values(self, share: FloatArray) -> FloatArray:
        """Return the values at times that are given as shares of the length, shape (n,)."""
        turns = 2.0 * np.pi * np.outer(share, self.harmonics) + np.array(self.phases_rad)
        return np.asarray(self.amplitude * np.sin(turns).sum(axis=1))


def disjoint_harmonics(lowest: int, highest: int, controls: int) -> tuple[tuple[int, ...], ...]:
    """Return the harmonics of each control, which alternate from ``lowest`` to about
    ``highest``. An even spacing allows lower peaks.

    Raises
    ------
    ValueError
        The band has less than two harmonics for each control.
    """
    count = (highest - lowest) // controls + 1
    if count < 2:
        raise ValueError(f"harmonics {lowest} to {highest} are too few for {controls} controls")
    wanted = _MOST_LINES * controls
    step = max(1, round((highest - lowest) / (wanted - 1)))
    numbers = np.arange(lowest, highest + step + 1, step)[:wanted]
    numbers = numbers[: controls * (len(numbers) // controls)]
    return tuple(tuple(int(n) for n in numbers[k::controls]) for k in range(controls))


@cache
def multisine(harmonics: tuple[int, ...]) -> Multisine:
    """Return a multisine of low peaks that begins and ends at zero."""
    numbers = np.array(harmonics)
    share = _grid(harmonics)
    random = np.random.default_rng(len(numbers))
    starts = [_schroeder(len(numbers))]
    starts += [random.uniform(-np.pi, np.pi, len(numbers)) for _ in range(_STARTS - 1)]
    clipped = [phases for start in starts for phases in _clipping(numbers, start, share)]
    best = min(clipped, key=lambda phases: _relative_peak_factor(_sum(numbers, phases, share)))
    return _begun_at_zero(numbers, best, share)


def _clipping(numbers: NDArray[np.int_], phases: FloatArray, share: FloatArray) -> Iterator[FloatArray]:
    """Yield the phases after each clipping. The phases of a clipped sum give the sum lower peaks."""
    for level in np.linspace(*_CLIPPED, _CLIPPINGS):
        yield phases
        y = _sum(numbers, phases, share)
        peak = level * float(np.max(np.abs(y)))
        phases = np.angle(np.fft.rfft(np.clip(y, -peak, peak))[numbers]) + np.pi / 2.0


def _sum(numbers: NDArray[np.int_], phases: FloatArray, share: FloatArray) -> FloatArray:
    return np.asarray(np.sin(2.0 * np.pi * np.outer(share, numbers) + phases).sum(axis=1))


def _grid(harmonics: Sequence[int]) -> FloatArray:
    return np.arange(n := _SAMPLES * max(harmonics)) / n


def _schroeder(count: int) -> FloatArray:
    """Return phases for equal power, -π k (k - 1) / count with k from 1 (Schroeder 1970)."""
    k = np.arange(1, count + 1)
    return np.asarray(-np.pi * k * (k - 1) / count)


def _relative_peak_factor(y: FloatArray) -> float:
    return float(np.ptp(y) / (2.0 * np.sqrt(2.0) * np.sqrt(np.mean(y**2))))


def _begun_at_zero(numbers: NDArray[np.int_], phases: FloatArray, share: FloatArray) -> Multisine:
    """Return the sum shifted in time to the zero crossing with the least offset of the integral.

    The shift keeps power, peaks and orthogonality. The bank is the integral of the roll rate. Without an
    offset the bank swings about its value before the input.
    """
    y = _sum(numbers, phases, share)
    crossings = np.flatnonzero(np.sign(y) != np.sign(np.roll(y, -1)))
    offsets = np.cos(2.0 * np.pi * np.outer(share[crossings], numbers) + phases) @ (1.0 / numbers)
    nearest = int(crossings[np.argmin(np.abs(offsets))])
    best = phases + 2.0 * np.pi * numbers * _crossing(numbers, phases, share, nearest)
    return Multisine(
        tuple(int(n) for n in numbers),
        1.0 / float(np.max(np.abs(y))),
        tuple(float(phase) for phase in np.angle(np.exp(1j * best))),
    )


def _crossing(numbers: NDArray[np.int_], phases: FloatArray, share: FloatArray, k: int) -> float:
    """Return the time of the zero crossing after sample ``k``, as a share of the length."""
    low, high = share[k], share[k] + 1.0 / len(share)
    rises = float(_sum(numbers, phases, np.array([low]))[0]) < 0.0
    for _ in range(50):
        middle = 0.5 * (low + high)
        before = (float(_sum(numbers, phases, np.array([middle]))[0]) < 0.0) == rises
        low, high = (middle, high) if before else (low, middle)
    return float(low)
