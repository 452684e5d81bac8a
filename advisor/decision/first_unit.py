"""Step duration of the first input of each control: by the aircraft file's model, then by the log.

The manoeuvres of a log that no rule uses still show the aircraft's motion.
"""

from collections.abc import Iterable, Mapping
from math import inf, pi, sqrt

import numpy as np

from advisor.aircraft.reference import SIDE_PARAMETERS
from advisor.decision.inputs import SHORTEST_UNIT_S
from advisor.model.axes.lateral import Trim, modes_of, state_matrix
from advisor.model.short_period import ShortPeriod
from advisor.oem.axes.lateral.estimate import LateralModes
from advisor.oem.estimate import Estimate, NoEstimate

DEFAULT_UNIT_S = 0.5
"""Time unit of the first 3-2-1-1, s, without a model and without an estimate. The unit suits a natural
frequency of 4 rad/s, which lies between small aircraft and jets."""
_SHORTEST_S, _LONGEST_S = 0.1, 3.0
"""Shortest and longest time unit, s, that is matched to an aircraft."""
_LEAST_AILERON_S = 0.5
"""Shortest step of the aileron, s. Shorter steps of a fast roll give no visible bank."""
_STIFFNESS = ("Z_alpha", "M_alpha", "M_q")
"""Derivatives of pitch without which a model has no natural frequency."""


def frequency(model: ShortPeriod) -> float:
    """Return the natural frequency in rad/s; for a model without one, the rate of the fastest mode."""
    natural = model.natural_frequency
    return natural if np.isfinite(natural) and natural > 0.0 else float(np.max(np.abs(model.eigenvalues)))


def matched_unit_s(model: ShortPeriod) -> float:
    """Return the time unit of a 3-2-1-1 that is matched to the aircraft, s."""
    return float(np.clip(2.0 / max(frequency(model), 1e-9), _SHORTEST_S, _LONGEST_S))


def first_unit_s(model: Mapping[str, float], estimates: Iterable[Estimate | NoEstimate] = ()) -> float:
    """Return the time unit of the first 3-2-1-1, s, rounded to tenths as a pilot can count them.

    Parameters
    ----------
    model
        Derivatives of the aircraft file by their names.
    estimates
        Estimates of manoeuvres that no rule uses, in the order flown.
    """
    unit = DEFAULT_UNIT_S
    shown = [e for e in estimates if isinstance(e, Estimate) and _knows_its_stiffness(e)]
    if set(_STIFFNESS) <= set(model):
        unit = matched_unit_s(ShortPeriod.from_mapping(model))
    elif shown:
        unit = matched_unit_s(ShortPeriod(shown[-1].theta))
    return max(round(unit, 1), SHORTEST_UNIT_S)


def _knows_its_stiffness(estimate: Estimate) -> bool:
    k = estimate.names.index("M_alpha")
    return abs(float(estimate.theta[k])) > float(estimate.std[k])


def side_unit_s(control: str, model: Mapping[str, float], airspeed_m_s: float | None) -> float | None:
    """Return the step of a doublet by the file's model, s; None if the model does not determine the step.

    The aileron's step is two time constants of the roll. The rudder's step is half a Dutch roll.
    """
    damping, stiffness = model.get("L_p", 0.0), model.get("N_beta", 0.0)
    if control == "aileron":
        return aileron_unit_s(-1.0 / damping) if damping < 0.0 else None
    if stiffness <= 0.0:
        return None
    swinging = None
    if {"Y_beta", "L_beta", "L_p", "N_r"} <= set(model):
        theta = np.array([model.get(name, 0.0) for name in SIDE_PARAMETERS])
        swinging = modes_of(state_matrix(theta, Trim(airspeed_m_s or inf))).dutch_roll
    return rudder_unit_s(sqrt(stiffness) if swinging is None else abs(swinging))


def shown_unit_s(control: str, modes: Iterable[LateralModes]) -> float | None:
    """Return the median step of a doublet by the modes of estimates, s; None without such a mode."""
    if control == "aileron":
        steps = [aileron_unit_s(q.value) for m in modes if (q := m.roll_time_constant) is not None]
    else:
        steps = [rudder_unit_s(q.value) for m in modes if (q := m.dutch_roll_omega) is not None]
    return float(np.median(steps)) if steps else None


def aileron_unit_s(time_constant_s: float) -> float:
    """Return the aileron's step, s: two time constants of the roll."""
    return max(2.0 * time_constant_s, _LEAST_AILERON_S)


def rudder_unit_s(omega: float) -> float:
    """Return the rudder's step, s: half a Dutch roll of frequency ``omega``, rad/s."""
    return max(pi / omega, SHORTEST_UNIT_S)
