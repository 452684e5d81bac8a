"""Natural periods, and from them the step duration of each control's first input.

Manoeuvres that no rule uses still show the aircraft's motion.
"""

from collections.abc import Callable, Iterable, Mapping
from math import inf, pi, sqrt

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import SIDE_PARAMETERS
from advisor.decision.inputs import SHORTEST_UNIT_S
from advisor.decision.response import Response, explained_share
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.model.axes.lateral import Trim, modes_of, state_matrix
from advisor.model.short_period import ShortPeriod
from advisor.oem.axis.estimate import AxisEstimate
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.words.quantities import NORMAL_95

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


def first_unit_s(
    control: str,
    aircraft: Aircraft,
    accepted: Iterable[Estimate | NoEstimate] = (),
    others: Iterable[Estimate | NoEstimate] = (),
) -> float:
    """Return the time unit of a control's first input, s, rounded to tenths as a pilot can count them.

    The accepted estimates come first, then the aircraft file, other estimates, and the usual unit.

    Parameters
    ----------
    others
        Estimates of manoeuvres that no rule uses.
    """
    by_file, by_estimate, usual_s = _UNITS[control]

    def shown(estimates: Iterable[Estimate | NoEstimate]) -> float | None:
        units = [unit for e in estimates if isinstance(e, Estimate) and (unit := by_estimate(e))]
        return float(np.median(units)) if units else None

    unit_s = shown(accepted) or by_file(aircraft) or shown(others) or usual_s
    return max(round(unit_s, 1), SHORTEST_UNIT_S)


def _elevator_by_file(aircraft: Aircraft) -> float | None:
    is_known = set(_STIFFNESS) <= set(aircraft.model)
    return matched_unit_s(ShortPeriod.from_mapping(aircraft.model)) if is_known else None


def _elevator_shown(estimate: Estimate) -> float | None:
    return matched_unit_s(ShortPeriod(estimate.theta)) if _knows_the_motion(estimate) else None


def _aileron_by_file(aircraft: Aircraft) -> float | None:
    damping = aircraft.model.get("L_p", 0.0)
    return _aileron_s(-1.0 / damping) if damping < 0.0 else None


def _aileron_shown(estimate: Estimate) -> float | None:
    roll = estimate.modes.get("roll_time_constant") if isinstance(estimate, AxisEstimate) else None
    return None if roll is None else _aileron_s(roll.value)


def _aileron_s(time_constant_s: float) -> float:
    """Return the aileron's step, s: two time constants of the roll."""
    return max(2.0 * time_constant_s, _LEAST_AILERON_S)


def _rudder_by_file(aircraft: Aircraft) -> float | None:
    """Return half a Dutch roll of the file's model, s; None if the model does not determine it."""
    model, stiffness = aircraft.model, aircraft.model.get("N_beta", 0.0)
    if stiffness <= 0.0:
        return None
    swinging = None
    if {"Y_beta", "L_beta", "L_p", "N_r"} <= set(model):
        theta = np.array([model.get(name, 0.0) for name in SIDE_PARAMETERS])
        swinging = modes_of(state_matrix(theta, Trim(aircraft.reference_airspeed_m_s or inf))).dutch_roll
    return pi / (sqrt(stiffness) if swinging is None else abs(swinging))


def _rudder_shown(estimate: Estimate) -> float | None:
    omega = estimate.modes.get("dutch_roll_omega") if isinstance(estimate, AxisEstimate) else None
    return None if omega is None else pi / omega.value


_UNITS: Mapping[str, tuple[Callable[[Aircraft], float | None], Callable[[Estimate], float | None], float]] = {
    "elevator": (_elevator_by_file, _elevator_shown, 0.5),
    "aileron": (_aileron_by_file, _aileron_shown, 1.0),
    "rudder": (_rudder_by_file, _rudder_shown, 1.0),
}
"""Unit of each control by the aircraft file, by an estimate, and the usual one, s.

The elevator's usual unit suits a natural frequency of 4 rad/s, which lies between small aircraft and jets.
A doublet's usual step lies between half a Dutch roll of a small aircraft (0.9 s) and of a jet (1.7 s). It is
at least two roll time constants of both (0.1 and 0.5 s).
"""


def natural_period(maneuver: Maneuver, estimate: Estimate | NoEstimate | None) -> float:
    """Return the natural period of the short-period motion in s, 2π/ω with ω² = Z_α M_q − (1 + Z_q) M_α.

    Without a valid estimate, the period follows from the input, which crews match to the aircraft. That
    period is 2.5 times the shortest step, or twice the median lobe of a multisine.
    """
    if isinstance(estimate, Estimate) and _knows_the_motion(estimate):
        natural = ShortPeriod(estimate.theta).natural_frequency
        if natural > 0.0:
            return 2.0 * pi / natural
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
    omega = estimate.modes.get("dutch_roll_omega") if isinstance(estimate, AxisEstimate) else None
    return _USUAL_DUTCH_ROLL_S if omega is None else 2.0 * pi / omega.value
