"""What the next input starts from and must respect: trim, instruments, limits."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from advisor.aircraft import Aircraft
from advisor.decision.foresight import Instruments
from advisor.decision.history import Flown
from advisor.decision.information import knowledge
from advisor.flight.maneuver import Maneuver
from advisor.flight.messages import FloatArray
from advisor.oem.estimate import Estimate
from advisor.oem.problem import Signal
from advisor.oem.surface import Servo

FULL_TRAVEL_RAD = float(np.radians(25.0))
"""Elevator travel either side of trim where no calibration says otherwise."""
BOLDER = 1.5
"""The next input, and its response, may be this much larger than any flown so far: build up step by step."""
LINEAR_RAD = float(np.radians(5.0))
"""Excursion of α up to which the short-period model is taken as linear, where no limit is given."""
ALPHA_MARGIN = 0.9
"""Of an angle-of-attack limit; the response is only as sure as the model."""


@dataclass(frozen=True, slots=True)
class Conditions:
    """As of the last manoeuvre."""

    theta: FloatArray
    trim_rad: float
    lead_s: float
    free_s: float
    instruments: Instruments
    flown: Signal
    """The elevator of the last manoeuvre."""
    largest_rad: float
    """Largest amplitude allowed."""
    alpha_rad: float
    """Largest excursion of α allowed."""
    travel_rad: float
    """Elevator travel from trim to the nearer stop: what 100 % stick means."""
    nose_up_first: bool
    """Direction of the last manoeuvre's first step."""
    last_std: FloatArray
    """(8,) errors of the last manoeuvre's estimate."""


def find_conditions(history: Sequence[Flown], aircraft: Aircraft) -> Conditions | None:
    """What the usable manoeuvres say of trim, instruments and limits; None before the first."""
    flown = [(e, m.maneuver) for m in history if (e := m.usable) and m.maneuver is not None]
    if not flown:
        return None
    estimate, last = flown[-1]
    fits = estimate.fits[0]
    span, elevator = last.span, last.channels["elevator"]
    theta = knowledge([e for e, _ in flown], aircraft.campaign).belief.theta
    trim = _trim(last)
    travel = _travel(aircraft, trim)
    largest_seen = max(_excursion(e) for e, _ in flown)
    alpha = max(largest_seen, min(BOLDER * largest_seen, LINEAR_RAD))
    if aircraft.limits.alpha_deg is not None:
        start = float(np.median(fits["alpha"].fitted[:5]))
        alpha = max(ALPHA_MARGIN * (np.radians(aircraft.limits.alpha_deg) - start), 0.25 * largest_seen)
    largest = max(float(np.max(np.abs(_about_trim(m)))) for _, m in flown)
    return Conditions(
        theta=theta,
        trim_rad=trim,
        lead_s=max(span.start_s - span.record_from_s, 0.5),
        free_s=max(span.end_s - span.last_step_s, 1.0),
        instruments=Instruments(
            step_s=(_step(fits["alpha"].t), _step(fits["q"].t)),
            noise=(fits["alpha"].noise, fits["q"].noise),
            servo=Servo(aircraft.elevator.lag_s or 0.0, aircraft.elevator.delay_s or 0.0),
        ),
        flown=Signal(elevator.t - elevator.t[0], elevator.y),
        largest_rad=min(BOLDER * largest, ALPHA_MARGIN * travel),
        alpha_rad=float(alpha),
        travel_rad=travel,
        nose_up_first=_nose_up_first(last),
        last_std=estimate.std,
    )


def _trim(maneuver: Maneuver) -> float:
    """Elevator before the first step, rad."""
    elevator, span = maneuver.channels["elevator"], maneuver.span
    lead = elevator.cut(span.record_from_s, span.start_s)
    return float(np.median(lead.y)) if len(lead) else float(elevator.y[0])


def _about_trim(maneuver: Maneuver) -> FloatArray:
    return maneuver.channels["elevator"].y - _trim(maneuver)


def _nose_up_first(maneuver: Maneuver) -> bool:
    """Whether the first large movement is trailing edge up."""
    moved = _about_trim(maneuver)
    return bool(moved[np.argmax(np.abs(moved) >= 0.5 * np.max(np.abs(moved)))] < 0.0)


def _excursion(estimate: Estimate) -> float:
    """Largest deviation of the fitted α from where it began, rad."""
    return max(
        float(np.max(np.abs(fits["alpha"].fitted - fits["alpha"].fitted[0]))) for fits in estimate.fits
    )


def _step(t: FloatArray) -> float:
    return float(np.median(np.diff(t)))


def _travel(aircraft: Aircraft, trim_rad: float) -> float:
    ends_deg = aircraft.elevator.ends_deg
    ends = np.radians(ends_deg) if ends_deg else [-FULL_TRAVEL_RAD, FULL_TRAVEL_RAD]
    return float(max(min(max(ends) - trim_rad, trim_rad - min(ends)), 0.1 * FULL_TRAVEL_RAD))
