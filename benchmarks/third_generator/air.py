"""Moving air: Dryden turbulence and single updrafts along the flight path."""

import numpy as np
from numpy.random import Generator
from scipy.signal import lfilter

from .fleet import Floats
from .flight import STEP_S


def dryden(count: int, rms: float, scale_m: float, speed: float, rng: Generator) -> Floats:
    """Vertical gusts [m/s] with Dryden's spectrum (MIL-F-8785C): second-order, from white noise."""
    lag = scale_m / speed
    s = 2.0 / STEP_S
    rule = np.array([[s * s, -2 * s * s, s * s], [s, 0.0, -s], [1.0, 2.0, 1.0]])
    top = np.array([0.0, np.sqrt(3.0) * lag, 1.0]) @ rule
    bottom = np.array([lag**2, 2.0 * lag, 1.0]) @ rule
    pulse = np.zeros(int(20.0 * lag / STEP_S))
    pulse[0] = 1.0
    gain = rms / float(np.linalg.norm(lfilter(top, bottom, pulse)))
    before = int(5.0 * lag / STEP_S)
    return np.asarray(lfilter(top, bottom, gain * rng.normal(size=count + before))[before:])


def cosine_gust(count: int, start_s: float, length_s: float, peak: float) -> Floats:
    """One gust of 1 - cos form [m/s]."""
    time = STEP_S * np.arange(count) - start_s
    inside = (time > 0.0) & (time < length_s)
    return np.where(inside, 0.5 * peak * (1.0 - np.cos(2.0 * np.pi * time / length_s)), 0.0)


def edged_updraft(count: int, start_s: float, length_s: float, peak: float, edge_s: float) -> Floats:
    """Rising air between two edges [m/s]."""
    time = STEP_S * np.arange(count) - start_s
    return 0.5 * peak * (np.tanh(time / edge_s) - np.tanh((time - length_s) / edge_s))
