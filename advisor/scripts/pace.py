"""Time constants of an aircraft, from which the steps of its test inputs follow."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import isfinite, pi, sqrt

import numpy as np

from advisor.model.short_period import ShortPeriod

USUAL_PERIOD_S = 1.0
"""Period of the short-period mode of an unknown aircraft, s. Small aircraft have 0.5 to 1.5 s. A 3-2-1-1
excites periods from half to twice the period for which it is designed.
"""
_DUTCH_ROLL_PERIODS = 2.0
"""Period of the Dutch roll relative to the short period, if no model states the period. Small aircraft and
jets have 1.5 to 3.
"""
_ROLL_SHARE = 0.2
"""Roll time constant relative to the short period, if no model states the constant. Aircraft have
0.1 to 0.3.
"""
_OF_PERIOD = ("M_alpha", "M_q", "Z_alpha")
"""Derivatives that give the short period. Z_q counts as 0 where it is not stated."""


@dataclass(frozen=True, slots=True)
class Pace:
    """Time constants with the source of each."""

    period_s: float
    """Period of the short-period motion, s."""
    roll_s: float
    """Roll time constant, s."""
    dutch_roll_s: float
    """Period of the Dutch roll, s."""
    why: Mapping[str, str]
    """Source of each time constant, by the field's name."""


def pace_of(model: Mapping[str, float], source: str, period_s: float | None = None) -> Pace:
    """Return the time constants of an aircraft.

    Parameters
    ----------
    model
        Derivatives by name, rad and s; may be empty.
    source
        Source of the derivatives, as a noun: ``the aircraft file's model``.
    period_s
        Short period that the user states, s, in place of the model's. None: the user states none.
    """
    why = {}
    period, why["period_s"] = USUAL_PERIOD_S, "usual value of a small aircraft"
    if period_s is not None:
        period, why["period_s"] = period_s, "--period"
    elif (natural := _short_period_s(model)) is not None:
        period, why["period_s"] = natural, source
    roll, why["roll_s"] = _ROLL_SHARE * period, f"{_ROLL_SHARE:g} short periods, no L_p is known"
    if model.get("L_p", 0.0) < 0.0:
        roll, why["roll_s"] = -1.0 / model["L_p"], f"-1/L_p of {source}"
    dutch_roll = _DUTCH_ROLL_PERIODS * period
    why["dutch_roll_s"] = f"{_DUTCH_ROLL_PERIODS:g} short periods, no N_beta is known"
    if model.get("N_beta", 0.0) > 0.0:
        dutch_roll = 2.0 * pi / sqrt(model["N_beta"])
        why["dutch_roll_s"] = f"2π/√N_beta of {source}"
    return Pace(period, roll, dutch_roll, why)


def _short_period_s(model: Mapping[str, float]) -> float | None:
    """Return the short period of a model, s; None for a model without one."""
    if not set(_OF_PERIOD) <= set(model):
        return None
    frequency = ShortPeriod.from_mapping(model).natural_frequency
    return float(2.0 * np.pi / frequency) if isfinite(frequency) and frequency > 0.0 else None
