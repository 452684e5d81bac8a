"""Conditions of the next input: trim, instruments, limits."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.decision.course import CriterionCourse
from advisor.decision.foresight import UNMEASURED, Instruments
from advisor.decision.history import CandidateManeuver, usable_ones
from advisor.decision.pooling import DERIVATIVES
from advisor.decision.prediction import response_to, trim_of
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.oem.estimate import Estimate
from advisor.oem.rows import Signal
from advisor.oem.surface import Servo
from advisor.process.arrays import FloatArray

FULL_TRAVEL_RAD = float(np.radians(25.0))
"""Travel of a control on either side of trim without a calibration, rad."""
BOLDER = 1.5
"""Largest ratio of the next input, and of its response, to the largest input so far. The amplitude is built
up in steps."""
LINEAR_RAD = float(np.radians(5.0))
"""Largest deviation of α from trim for which the model is taken as linear, rad, without a stated limit."""
ALPHA_MARGIN = 0.9
"""Share of an angle-of-attack limit that the next input may use. The margin allows for errors of the
model."""


@dataclass(frozen=True, slots=True)
class Conditions:
    """Trim, instruments and limits of the next input, after the last manoeuvre."""

    theta: FloatArray
    trim_rad: float
    lead_s: float
    free_s: float
    instruments: Instruments
    flown: Signal
    """Elevator of the last manoeuvre."""
    largest_rad: float
    """Largest amplitude of the elevator that the limits allow, rad."""
    alpha_rad: float
    """Largest deviation of α that the limits allow, rad."""
    travel_rad: float
    """Elevator travel from trim to the nearer stop, rad, which is 100 % stick."""
    nose_up_first: bool
    """Whether the last manoeuvre's first step was nose up."""
    last_covariance: FloatArray
    """Shape (8, 8): covariance of the last manoeuvre's estimate for given instruments."""


def find_conditions(
    history: Sequence[CandidateManeuver], aircraft: Aircraft, course: CriterionCourse
) -> Conditions | None:
    """Return trim, instruments and limits from the usable manoeuvres; None without one."""
    flown = [(m, e, m.maneuver) for m in history if (e := m.usable) and m.maneuver is not None]
    if not flown:
        return None
    _, estimate, last = flown[-1]
    fits = estimate.fits[0]
    span, elevator = last.span, last.channels["elevator"]
    theta = course.knowledge(usable_ones(history)).posterior.theta
    trim = trim_of(last)
    travel = travel_of(aircraft.elevator.ends_deg, trim)
    largest_seen = max(_excursion(m, e) for m, e, _ in flown)
    alpha = max(largest_seen, min(BOLDER * largest_seen, LINEAR_RAD))
    if aircraft.limits.alpha_deg is not None:
        # Where no angle of attack is measured, the limit can be kept about trim only.
        start = float(np.median(fits["alpha"].fitted[:5])) if "alpha" in fits else 0.0
        alpha = max(ALPHA_MARGIN * (np.radians(aircraft.limits.alpha_deg) - start), 0.25 * largest_seen)
    largest = max(float(np.max(np.abs(_about_trim(m)))) for *_, m in flown)
    return Conditions(
        theta=theta,
        trim_rad=trim,
        lead_s=max(span.start_s - span.record_from_s, 0.5),
        free_s=max(span.end_s - span.last_step_s, 1.0),
        instruments=_instruments(
            estimate, Servo(aircraft.elevator.lag_s or 0.0, aircraft.elevator.delay_s or 0.0)
        ),
        flown=Signal(elevator.t - elevator.t[0], elevator.y),
        largest_rad=min(BOLDER * largest, ALPHA_MARGIN * travel),
        alpha_rad=float(alpha),
        travel_rad=travel,
        nose_up_first=_nose_up_first(last),
        last_covariance=estimate.own_covariance,
    )


def _about_trim(maneuver: Maneuver) -> FloatArray:
    return maneuver.channels["elevator"].y - trim_of(maneuver)


def _nose_up_first(maneuver: Maneuver) -> bool:
    """Return whether the first large movement of the elevator is trailing edge up."""
    moved = _about_trim(maneuver)
    return bool(moved[np.argmax(np.abs(moved) >= 0.5 * np.max(np.abs(moved)))] < 0.0)


def _instruments(estimate: Estimate, servo: Servo) -> Instruments:
    fits = estimate.fits[0]
    q = fits["q"]
    if "alpha" in fits or "a_z" not in fits:
        alpha = fits.get("alpha", q)
        return Instruments((_step(alpha.t), _step(q.t)), (alpha.noise, q.noise), servo)
    force = fits["a_z"]
    noise = force.noise / (estimate.airspeed_m_s or 1.0)
    return Instruments((_step(q.t), _step(q.t)), (UNMEASURED, q.noise), servo, (_step(force.t), noise))


def _excursion(flown: CandidateManeuver, estimate: Estimate) -> float:
    """Return the largest change of α from its initial value, rad, from the fit, or from a prediction without
    a measured α.
    """
    if "alpha" not in estimate.fits[0]:
        response = response_to(flown, estimate.theta[list(DERIVATIVES)], None)
        return LINEAR_RAD if response is None else float(response.peak[0])
    fitted = estimate.fits[0]["alpha"].fitted
    return float(np.max(np.abs(fitted - fitted[0])))


def _step(t: FloatArray) -> float:
    return float(np.median(np.diff(t)))


def travel_of(ends_deg: tuple[float, float] | None, trim_rad: float = 0.0) -> float:
    """Return the travel of a control from trim to the nearer stop, rad: 100 % stick.

    Parameters
    ----------
    ends_deg
        Stops of the calibration, deg; None without a calibration.
    """
    low, high = np.radians(ends_deg) if ends_deg else (-FULL_TRAVEL_RAD, FULL_TRAVEL_RAD)
    return float(max(min(high - trim_rad, trim_rad - low), 0.1 * FULL_TRAVEL_RAD))
