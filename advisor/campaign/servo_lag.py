"""The servo's lag, identified during a campaign and used in every later estimate.

The lag is estimated from all accepted manoeuvres together. Single estimates, verdicts and criteria use the
lag in two cases. The crew gives none, and the standard deviation is at most a tenth of the lag. Or the crew
gives one that the manoeuvres exclude.
"""

from dataclasses import replace

import numpy as np

from advisor.aircraft.aircraft import PARAMETERS, Aircraft, Elevator
from advisor.decision.verdict import ManeuverVerdict
from advisor.model.short_period import SPEED_EXPONENTS
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.oem.instruments import KNOWN_TO

CONTRADICTS = 3.0
"""Difference between two estimates of one derivative, in standard deviations, that counts as a
contradiction."""

MUCH_SURER = 1.5
"""Ratio of standard deviations above which the surer value replaces the one in use."""


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


def learnt(
    aircraft: Aircraft, model: Estimate | None, *, one_power_on: bool = True, exactly: bool = False
) -> Aircraft:
    """Return the aircraft with servo and command as the joint estimate tells them; unchanged without news.

    Parameters
    ----------
    aircraft
        The crew's aircraft, with what was identified before.
    model
        Joint estimate over the accepted manoeuvres, made with the crew's aircraft.
    one_power_on
        Whether all these manoeuvres are of one power-on. The delay of the command differs from one to the
        next.
    exactly
        Take the newest values even within their standard deviations of those in use, as at the end of a log.
    """
    if model is None:
        return aircraft
    lag, delay = model.instrument("servo_lag_s"), model.instrument("command_delay_s")
    known = lag is not None and lag.std < KNOWN_TO * lag.value
    found = replace(
        aircraft.elevator,
        lag_found_s=lag.value if lag is not None and known else None,
        lag_found_std_s=lag.std if lag is not None and known else None,
        delay_found_s=delay.value if delay is not None and one_power_on else None,
        delay_found_std_s=delay.std if delay is not None and one_power_on else None,
    )
    if found.lag_found_s is None and aircraft.elevator.lag_s is None:
        return aircraft
    return aircraft if not exactly and _is_no_news(aircraft.elevator, found) else _using(aircraft, found)


def _is_no_news(used: Elevator, found: Elevator) -> bool:
    """Return whether values in use lie within the new standard deviations, and are about as certain."""
    pairs = (
        (used.lag_found_s, used.lag_found_std_s, found.lag_found_s, found.lag_found_std_s),
        (used.delay_found_s, used.delay_found_std_s, found.delay_found_s, found.delay_found_std_s),
    )
    for before, before_std, now, std in pairs:
        if (before is None) != (now is None):
            return False
        if before is None or before_std is None or now is None or std is None:
            continue
        if abs(now - before) > std or before_std > MUCH_SURER * std:
            return False
    return True


def _using(aircraft: Aircraft, elevator: Elevator) -> Aircraft:
    return aircraft if elevator == aircraft.elevator else replace(aircraft, elevator=elevator)


def of_another_power_on(aircraft: Aircraft) -> Aircraft:
    """Return what is known of an aircraft in a power-on that no manoeuvre has told of: no delay of the
    command."""
    return _using(aircraft, replace(aircraft.elevator, delay_found_s=None, delay_found_std_s=None))


def told(aircraft: Aircraft) -> str:
    """Return the sentence for the event log about the lag that every estimate uses now; empty without a
    lag."""
    found, stated = aircraft.elevator.lag_found_s, aircraft.elevator.lag_s
    std = aircraft.elevator.lag_found_std_s or 0.0
    if found is None:
        return ""
    if stated is not None and abs(found - stated) <= CONTRADICTS * std:
        return f"the manoeuvres together tell a lag of the servo of {found:.3f} s, as elevator.lag_s says"
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
