"""The servo's lag, identified during a campaign and used in every later estimate.

The lag is estimated from all accepted manoeuvres together. Single estimates, verdicts and criteria use the
lag in two cases. The crew gives none, and the standard deviation is at most a tenth of the lag. Or the crew
gives one that the manoeuvres exclude.
"""

from dataclasses import replace

import numpy as np

from advisor.aircraft.aircraft import PARAMETERS, Aircraft
from advisor.decision.verdict import ManeuverVerdict
from advisor.model.short_period import SPEED_EXPONENTS
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.oem.instruments import KNOWN_TO

CONTRADICTS = 3.0
"""Difference between two estimates of one derivative, in standard deviations, that counts as a
contradiction."""


def may_learn(aircraft: Aircraft, all_of_them: bool) -> bool:
    """Return whether a joint estimate may improve the knowledge of the servo's lag.

    Parameters
    ----------
    aircraft
        The crew's aircraft, with a lag that was identified before.
    all_of_them
        Whether the joint estimate is made from all accepted manoeuvres. The newest alone do not improve a lag
        that is known already.
    """
    return aircraft.elevator.lag_found_s is None or all_of_them


def learnt(aircraft: Aircraft, model: Estimate | None, *, exactly: bool = False) -> Aircraft:
    """Return the aircraft with the servo's lag from the joint estimate; unchanged without news.

    Parameters
    ----------
    aircraft
        The crew's aircraft, with a lag that was identified before.
    model
        Joint estimate over the accepted manoeuvres, made with the crew's aircraft.
    exactly
        Take the newest value even within its standard deviation of the value in use, as at the end of a log.
    """
    if model is None:
        return aircraft
    elevator, lag = aircraft.elevator, model.instrument("servo_lag_s")
    if elevator.lag_s is not None and (lag is None or not lag.contradicts):
        # The manoeuvres together do not exclude the crew's lag (any more).
        return aircraft if elevator.lag_found_s is None else _using(aircraft, None)
    if lag is None or not lag.std < KNOWN_TO * lag.value:
        return aircraft
    used = elevator.lag_found_s
    near = used is not None and abs(lag.value - used) <= (0.0 if exactly else lag.std)
    return aircraft if near else _using(aircraft, lag.value)


def _using(aircraft: Aircraft, lag_s: float | None) -> Aircraft:
    return replace(aircraft, elevator=replace(aircraft.elevator, lag_found_s=lag_s))


def told(aircraft: Aircraft) -> str:
    """Return the sentence for the event log about the lag that every estimate uses now."""
    found, stated = aircraft.elevator.lag_found_s, aircraft.elevator.lag_s
    if found is None:
        return "the manoeuvres together agree with elevator.lag_s again; every estimate uses it now"
    against = "" if stated is None else f", against {stated:.3f} s in elevator.lag_s,"
    return (
        f"the servo's lag is {found:.3f} s{against} by all manoeuvres together; every estimate uses it now;"
        f" for the aircraft file: elevator: {{lag_s: {found:.3f}}}"
    )


def reserved(
    verdict: ManeuverVerdict, estimate: Estimate | NoEstimate, model: Estimate | None
) -> ManeuverVerdict:
    """Return the verdict, with a caution where the joint estimate contradicts the control derivative.

    A record that does not determine the servo's lag alone has M_δe wrong by up to a factor of two. The fit of
    such a record is as good as any, and the stated error is small.
    """
    if model is None or isinstance(estimate, NoEstimate) or not verdict.accepted:
        return verdict
    if model.instrument("servo_lag_s") is None or estimate.servo_lag_s > 0.0:
        return verdict
    scale = 1.0
    if model.airspeed_m_s and estimate.airspeed_m_s:
        scale = (model.airspeed_m_s / estimate.airspeed_m_s) ** SPEED_EXPONENTS["M_delta_e"]
    j = PARAMETERS.index("M_delta_e")
    here, std = scale * float(estimate.theta[j]), scale * float(estimate.std[j])
    together, error = float(model.theta[j]), float(model.std[j])
    if abs(here - together) <= CONTRADICTS * np.hypot(std, error):
        return verdict
    sentence = (
        f"ACCEPTED, but not its M_delta_e of {here:.3g}: with the servo's lag that all manoeuvres tell"
        f" it is {together:.3g}"
    )
    return replace(verdict, sentence=sentence)
