"""Flights that are made up for ``reference/effects.md``: every channel moves, so that none is left out."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import Maneuver, Span
from advisor.flight.signals.record import Channel
from advisor.gap.candidates.known import variants_for
from advisor.gap.kit.effect import Variant
from advisor.gap.records.prepare import prepare


@dataclass(frozen=True)
class Plan:
    """A flight by its number of manoeuvres and its mean air speed."""

    maneuvers: int
    speed_m_s: float

    @property
    def what(self) -> str:
        """The flight in words."""
        return f"{self.maneuvers} manoeuvres at {self.speed_m_s:g} m/s"


PLANS = (Plan(7, 22.0), Plan(9, 60.0))
"""A bound that differs between the two belongs to the flight, not to the effect."""


def described(effect: str, plan: Plan) -> Sequence[Variant]:
    """Every description of an effect that the flight allows."""
    return [w for v in _variants(plan) if v.effect == effect for w in (v, *v.likewise)]


@cache
def _variants(plan: Plan) -> Sequence[Variant]:
    flown = [_maneuver(n, plan.speed_m_s) for n in range(plan.maneuvers)]
    return variants_for(prepare(flown, Aircraft()))


def _maneuver(number: int, speed_m_s: float) -> Maneuver:
    """A record with every channel in motion and a trim of its own: no effect is left out for want of one."""
    t = np.arange(0.0, 8.0, 0.02) + 30.0 * number
    rng = np.random.default_rng(number)
    trim = 0.02 * (number % 3)
    step = np.where((t >= t[0] + 1.0) & (t < t[0] + 2.0), 0.05, 0.0)
    shape = np.convolve(step, np.ones(20) / 20.0)[: len(t)]
    series = {
        "elevator": trim + step,
        "alpha": trim + shape,
        "q": shape - np.mean(shape),
        "a_z": -9.81 - 20.0 * shape,
        "theta": trim + shape,
        "airspeed": speed_m_s * (1.0 + 0.1 * (-1.0) ** number + 0.05 * shape),
        "climb_rate": shape,
        "height": 30.0 + 5.0 * number + shape * 20.0,
        "throttle": np.where(t > t[0] + 4.0, 0.2, 0.6),
    }
    noisy = {"alpha", "q", "a_z", "theta"}
    channels = {
        name: Channel(name, t, y + 1e-4 * (name in noisy) * rng.standard_normal(len(t)), "plan", "measured")
        for name, y in series.items()
    }
    span = Span(t[0], t[0] + 1.0, t[0] + 2.0, t[-1], "other", (), "quiet")
    return Maneuver(number + 1, 0, span, channels)
