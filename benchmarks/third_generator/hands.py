"""Hands that fly between the tests: a delay, a remnant, and the time in which they take over."""

from dataclasses import replace

import numpy as np
from numpy.random import Generator
from scipy.signal import lfilter

from .fleet import Floats
from .flight import STEP_S
from .plan import Plan

DELAY_S = (0.12, 0.3)
"""Least and greatest delay of a hand, s (McRuer & Krendel 1974: 0.1 to 0.3)."""
REMNANT = (0.02, 0.12)
"""Least and greatest standard deviation of the remnant, over the median amplitude of the tests."""
COLOUR_S = (0.1, 0.6)
"""Least and greatest time constant of the remnant's colour, s."""
NERVE_S = 0.05
"""Second time constant of the remnant, s: muscles make no jumps."""
TAKE_OVER_S = (0.05, 1.5)
"""Least and greatest time in which hands take over after a test, s."""
GAIN = (0.6, 2.0)
"""Least and greatest gain of the hand on the pitch angle, over that of the generator's pilot."""
STILL = (0.0, 0.3)
"""Least and greatest remnant during a test, over that between the tests."""


def by_hand(plan: Plan, rng: Generator) -> Plan:
    """Return the plan flown by hands with a delay and a remnant, without a damper of the autopilot."""
    size = float(rng.uniform(*REMNANT)) * float(np.median([m.amplitude_rad for m in plan.maneuvers]))
    gains = plan.gains._replace(
        pitch=plan.gains.pitch * float(rng.uniform(*GAIN)),
        delay_s=min(float(rng.uniform(*DELAY_S)), 0.6 / plan.own_rad_s),
        damper=0.0,
        take_over_s=float(np.exp(rng.uniform(*np.log(TAKE_OVER_S)))),
    )
    remnant = size * _coloured(plan.steps, float(rng.uniform(*COLOUR_S)), rng)
    still = plan.stick + float(rng.uniform(*STILL)) * remnant
    return replace(plan, gains=gains, remnant=remnant, stick=still)


def _coloured(count: int, memory_s: float, rng: Generator) -> Floats:
    """Return noise of unit size through two lags, shape (count,)."""
    poles = np.exp([-STEP_S / memory_s, -STEP_S / NERVE_S])
    series = lfilter([1.0], np.poly(poles), rng.normal(size=count))
    return np.asarray(series / np.std(series))
