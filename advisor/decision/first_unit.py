"""Natural periods, and from them the step duration of each control's first input.

The step follows from the aircraft file's model, then from the log. Manoeuvres that no rule uses still show
the aircraft's motion.
"""

from collections.abc import Iterable, Mapping
from math import inf, pi, sqrt

import numpy as np

from advisor.aircraft.reference import SIDE_PARAMETERS
from advisor.decision.inputs import SHORTEST_UNIT_S
from advisor.decision.response import Response, explained_share
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.model.axes.lateral import Trim, modes_of, state_matrix
from advisor.model.short_period import ShortPeriod
from advisor.oem.axes.lateral.estimate import LateralEstimate, LateralModes
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.words.quantiles import NORMAL_95

DEFAULT_UNIT_S = 0.5
"""Time unit of the first 3-2-1-1, s, without a model and without an estimate. The unit suits a natural
frequency of 4 rad/s, which lies between small aircraft and jets."""
_SHORTEST_S, _LONGEST_S = 0.1, 3.0
"""Shortest and longest time unit, s, that is matched to an aircraft."""
_LEAST_AILERON_S = 0.5
"""Shortest step of the aileron, s. Shorter steps of a fast roll give no visible bank."""
_USUAL_DUTCH_ROLL_S = 2.0
"""Period of the Dutch roll without an estimate, s. Small aircraft have periods of 1.8 s, and jets of 3.5
s."""
PITCH_RATE = Response("q", "pitch rate", "deg/s", "stick")
"""Output that shows the response to the elevator first."""
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
    shown = [e for e in estimates if isinstance(e, Estimate) and _knows_the_motion(e)]
    if set(_STIFFNESS) <= set(model):
        unit = matched_unit_s(ShortPeriod.from_mapping(model))
    elif shown:
        unit = matched_unit_s(ShortPeriod(shown[-1].theta))
    return max(round(unit, 1), SHORTEST_UNIT_S)


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


def natural_period(maneuver: Maneuver, estimate: Estimate | NoEstimate) -> float:
    """Return the natural period of the short-period motion in s, 2π/ω with ω² = Z_α M_q − (1 + Z_q) M_α.

    Without a valid estimate, the period follows from the input, which crews match to the aircraft. That
    period is 2.5 times the shortest step, or twice the median lobe of a multisine.
    """
    if isinstance(estimate, Estimate) and _knows_the_motion(estimate):
        square = estimate.value("Z_alpha") * estimate.value("M_q")
        square -= (1.0 + estimate.value("Z_q")) * estimate.value("M_alpha")
        if square > 0.0:
            return 2.0 * pi / sqrt(square)
    held_s = np.diff([onset for onset, _ in maneuver.span.steps])
    held_s = held_s[held_s > 0.0]  # two steps between two samples have one onset
    if len(held_s) == 0:
        return 1.0
    swept = maneuver.span.kind == "multisine"
    return 2.0 * float(np.median(held_s)) if swept else 2.5 * float(np.min(held_s))


def _knows_the_motion(estimate: Estimate) -> bool:
    """Return whether an estimate explains and predicts its response, and the stiffness is significant at
    95 %."""
    stiffness = estimate.names.index("M_alpha")
    determined = abs(float(estimate.theta[stiffness])) > NORMAL_95 * float(estimate.std[stiffness])
    fit = estimate.fits[0].get(PITCH_RATE.output) if estimate.fits else None
    holds = fit is None or explained_share(fit) >= PITCH_RATE.least_r2
    return determined and holds and estimate.prediction.get("q", 0.0) < 1.0


def dutch_roll_s(_: Maneuver, estimate: Estimate | NoEstimate) -> float:
    """Return the period of the Dutch roll, s."""
    omega = estimate.modes.dutch_roll_omega if isinstance(estimate, LateralEstimate) else None
    return _USUAL_DUTCH_ROLL_S if omega is None else 2.0 * pi / omega.value
