"""The instruments, identified during a campaign and used in every later estimate.

Unknown instruments are estimated from all accepted manoeuvres together. Single estimates, verdicts and
criteria take the instruments as given, with their errors (``oem.known_instruments``). A servo's lag that the
crew leaves open must be known to a tenth.
"""

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.oem.estimate import Estimate
from advisor.oem.instruments import knows_the_lag
from advisor.oem.known_instruments import FoundInstruments, found_of, with_found

CONTRADICTS = 3.0
"""Difference between two estimates of a derivative, in standard deviations, above which they contradict each
other."""
MUCH_SURER = 1.5
"""Ratio of standard deviations above which the more certain value replaces the value in use."""


def may_learn(aircraft: Aircraft, all_of_them: bool) -> bool:
    """Return whether a joint estimate may improve the values of the instruments.

    Parameters
    ----------
    aircraft
        The crew's aircraft, with instruments that were identified earlier.
    all_of_them
        Whether the joint estimate uses all accepted manoeuvres. The newest manoeuvres alone do not improve
        these values.
    """
    return found_of(aircraft) is None or all_of_them


def learnt(
    aircraft: Aircraft, model: Estimate | None, *, one_power_on: bool = True, exactly: bool = False
) -> Aircraft:
    """Return the aircraft with the instruments from the joint estimate; unchanged without new values.

    Parameters
    ----------
    aircraft
        The crew's aircraft, with instruments that were identified earlier.
    model
        Joint estimate over the accepted manoeuvres, made with the crew's aircraft.
    one_power_on
        Whether all these manoeuvres are of one power-on. The delay of the command differs between power-ons.
    exactly
        Take the newest values even if they differ by less than a standard deviation from those in use. True
        at the end of a log.
    """
    if model is None or model.found is None:
        return aircraft
    fresh = model.found if one_power_on else model.found.without("command_delay_s")
    if aircraft.elevator.lag_s is None and not knows_the_lag(model.instrument("servo_lag_s")):
        return aircraft
    used = found_of(aircraft)
    return aircraft if used is not None and _is_no_news(used, fresh, exactly) else with_found(aircraft, fresh)


def _is_no_news(used: FoundInstruments, found_instruments: FoundInstruments, exactly: bool) -> bool:
    """Return whether the values in use lie within the new standard deviations, and are similarly certain.

    ``exactly`` asks for the same values and errors.
    """
    if used.names != found_instruments.names:
        return False
    if exactly:
        names = ("values", "std", "covariance")
        return all(np.array_equal(getattr(used, x), getattr(found_instruments, x)) for x in names)
    near = np.abs(found_instruments.values - used.values) <= found_instruments.std
    return bool(np.all(near & (used.std <= MUCH_SURER * found_instruments.std)))


def of_another_power_on(aircraft: Aircraft) -> Aircraft:
    """Return the aircraft before any manoeuvre of a power-on: with the delay of the command unknown."""
    given = found_of(aircraft)
    return aircraft if given is None else with_found(aircraft, given.without("command_delay_s"))


def lag_said(aircraft: Aircraft) -> str:
    """Return the event log's sentence on the lag that every estimate uses now; empty without a lag."""
    given, stated = found_of(aircraft), aircraft.elevator.lag_s
    lag_s = None if given is None else given.value("servo_lag_s")
    if given is None or lag_s is None:
        return ""
    std = float(given.std[given.names.index("servo_lag_s")])
    if stated is not None and abs(lag_s - stated) <= CONTRADICTS * std:
        return f"all manoeuvres together give a servo lag of {lag_s:.3f} s, as elevator.lag_s says"
    against = "" if stated is None else f", against {stated:.3f} s in elevator.lag_s,"
    return (
        f"the servo's lag is {lag_s:.3f} s{against} by all manoeuvres together; "
        "every estimate uses this lag now;"
        f" for the aircraft file: elevator: {{lag_s: {lag_s:.3f}}}"
    )
