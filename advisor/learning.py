"""What a campaign learns of the instruments on the way, and uses from then on.

A servo's lag that the crew does not give is estimated from all accepted manoeuvres together. As soon as the
lag is known to a tenth, single estimates, verdicts and criteria are those with the lag."""

from dataclasses import replace

from advisor.aircraft import Aircraft
from advisor.oem.estimate import Estimate
from advisor.oem.instruments import KNOWN_TO


def learnt(aircraft: Aircraft, model: Estimate | None, *, exactly: bool = False) -> Aircraft:
    """The aircraft with the servo's lag as the joint estimate tells it; the same one when nothing is new.

    Parameters
    ----------
    aircraft
        As the crew gives it, with what was learnt before.
    model
        Joint estimate over the accepted manoeuvres, made with the lag unknown.
    exactly
        Take the newest value even when it lies within its own error of the one used, as at the end of a log.
    """
    elevator = aircraft.elevator
    lag = model.instrument("servo_lag_s") if model is not None else None
    if elevator.lag_s is not None or lag is None or not lag.std < KNOWN_TO * lag.value:
        return aircraft
    used = elevator.lag_found_s
    near = used is not None and abs(lag.value - used) <= (0.0 if exactly else lag.std)
    return aircraft if near else replace(aircraft, elevator=replace(elevator, lag_found_s=lag.value))
