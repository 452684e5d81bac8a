"""Test inputs as hands fly them: slewed edges, unequal amplitudes, a little tremor."""

from dataclasses import dataclass

import numpy as np
from numpy.random import Generator
from scipy.ndimage import gaussian_filter1d
from scipy.signal import lfilter

from .fleet import Floats
from .flight import STEP_S

KINDS = ("doublet", "3-2-1-1", "multistep", "sweep")
SHARES = (0.25, 0.4, 0.2, 0.15)


@dataclass(frozen=True)
class Maneuver:
    """One test: when hands leave the trim, when the input begins and ends, and where it was flown."""

    kind: str
    start_s: float
    input_s: float
    input_end_s: float
    end_s: float
    airspeed_m_s: float
    height_m: float
    amplitude_rad: float
    damper_on: bool


def input_shape(kind: str, own_rad_s: float, rng: Generator) -> Floats:
    """Deflection over its amplitude, at every 5 ms."""
    unit = max(float(rng.uniform(1.5, 2.1)) / own_rad_s, 0.28)
    if kind == "sweep":
        return _sweep(own_rad_s, rng)
    if kind == "doublet":
        lengths, levels = [2.0, 2.0], [1.0, -1.0]
    elif kind == "3-2-1-1":
        lengths, levels = [3.0, 2.0, 1.0, 1.0], [0.8, -1.0, 1.0, -1.0]
    else:
        count = int(rng.integers(4, 8))
        lengths = list(rng.uniform(0.8, 2.6, count))
        levels = [float(rng.uniform(0.5, 1.0)) * (1.0 if k % 2 == 0 else -1.0) for k in range(count)]
    levels = [level * float(rng.uniform(0.8, 1.2)) for level in levels]
    edge = min(float(rng.uniform(0.10, 0.35)), 0.8 * unit)
    corners, before, at = [(0.0, 0.0)], 0.0, 0.0
    for length, level in zip(lengths, levels, strict=True):
        corners += [(at + edge, level), (at + max(length * unit, edge), level)]
        at, before = at + max(length * unit, edge), level
    corners.append((at + edge * abs(before), 0.0))
    time = np.arange(0.0, corners[-1][0] + 0.05, STEP_S)
    series = np.interp(time, [t for t, _ in corners], [level for _, level in corners])
    tremor = gaussian_filter1d(rng.normal(size=time.size), 0.06 / STEP_S)
    series += 0.015 * tremor / max(float(np.std(tremor)), 1e-9) * (np.abs(series) > 0.02)
    return np.asarray(gaussian_filter1d(series, 0.015 / STEP_S))


def _sweep(own_rad_s: float, rng: Generator) -> Floats:
    low, high = 0.35 * own_rad_s, float(rng.uniform(1.6, 2.4)) * own_rad_s
    length = float(rng.uniform(2.2, 3.0)) * 2.0 * np.pi / (0.5 * (low + high)) * 1.5
    time = np.arange(0.0, length, STEP_S)
    phase = low * time + 0.5 * (high - low) * time**2 / length
    fade = np.clip(np.minimum(time, length - time) / (0.12 * length), 0.0, 1.0)
    return np.asarray(0.8 * fade * np.sin(phase))


def peak_alpha(series: Floats, model: dict[str, float]) -> float:
    """Largest angle of attack of the linear model, per unit of the input [rad/rad]."""
    a = np.array([[model["Z_alpha"], 1.0 + model["Z_q"]], [model["M_alpha"], model["M_q"]]])
    b = np.array([model["Z_delta_e"], model["M_delta_e"]])
    # alpha / delta_e = (Z_d s + Z_d (-M_q) + (1 + Z_q) M_d) / (s^2 - tr s + det), by the bilinear rule.
    top = np.array([0.0, b[0], -b[0] * a[1, 1] + a[0, 1] * b[1]])
    bottom = np.array([1.0, -np.trace(a), float(np.linalg.det(a))])
    s = 2.0 / STEP_S
    rule = np.array([[s * s, -2 * s * s, s * s], [s, 0.0, -s], [1.0, 2.0, 1.0]])
    answer = lfilter(top @ rule, bottom @ rule, np.concatenate([series, np.zeros(400)]))
    return float(np.max(np.abs(answer)))
