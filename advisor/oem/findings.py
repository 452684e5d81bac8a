"""Findings about instruments: estimated values compared with stated values.

The findings hold for the estimate they come from. A contradiction refuses no estimate that uses the value
from the data. A contradicted sign of the elevator prevents use, because the fit does not show which sign is
wrong.
"""

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import PARAMETERS
from advisor.flight.signals.instrument_finding import InstrumentFinding, Quantity
from advisor.oem.estimate import Estimate, InstrumentEstimate
from advisor.oem.instrument_fit import CONTRADICTS
from advisor.oem.instruments import KNOWN_TO
from advisor.oem.known_instruments import InstrumentName
from advisor.words.quantiles import NORMAL_95

_PLACES: dict[str, tuple[str, Quantity, str]] = {
    "servo_lag_s": ("elevator", "lag_s", "elevator: {{lag_s: {:.3f}}}"),
    "command_delay_s": ("elevator", "delay_s", "elevator: {{delay_s: {:.3f}}}"),
    "vane_arm_m": ("alpha", "arm_m", "alpha: {{vane_arm_m: {:.2f}}}"),
    "alpha_delay_s": ("alpha", "delay_s", ""),
    "accelerometer_arm_m": ("a_z", "arm_m", "accelerometer: {{arm_m: {:.2f}}}"),
}
"""Channel, quantity and aircraft-file line of each instrument parameter, by its name."""


def findings_of(estimate: Estimate, aircraft: Aircraft) -> tuple[InstrumentFinding, ...]:
    """Return the findings of an estimate about the instruments, including those that agree with the aircraft
    file.

    Parameters
    ----------
    estimate
        Estimate from one manoeuvre or from several manoeuvres together.
    aircraft
        Aircraft file that was used for the estimate.
    """
    return (*(_finding(x, aircraft) for x in estimate.instruments), *_sign(estimate))


def _finding(x: InstrumentEstimate, aircraft: Aircraft) -> InstrumentFinding:
    channel, quantity, _ = _PLACES[x.name]
    stated = aircraft.elevator.delay_s if x.name == "command_delay_s" else x.stated
    value, std = (x.value, x.std) if x.stated is None else (x.unstated_value, x.unstated_std)
    worth = x.contradicts or (x.stated is None and std < KNOWN_TO * abs(value))
    return InstrumentFinding(
        channel,
        quantity,
        stated,
        value,
        std,
        contradicts=x.contradicts,
        text=_text(x, stated, value, std),
        fix=line_of(x.name, value) if worth else "",
        used=x.contradicts or x.stated is None,
    )


def _text(x: InstrumentEstimate, stated: float | None, value: float, std: float) -> str:
    apart = value - (stated or 0.0)
    later = "later" if apart > 0.0 else "earlier"
    match x.name:
        case "servo_lag_s" if x.contradicts:
            return f"the surface responds {abs(apart):.2f} s {later} than elevator.lag_s says"
        case "servo_lag_s" if stated is not None:
            return f"{value_in_words(x.name, value, std)}, as elevator.lag_s says"
        case "command_delay_s" if x.contradicts and stated is not None:
            return f"the command acts {abs(apart):.3f} s {later} than elevator.delay_s says"
        case "vane_arm_m" if x.contradicts:
            return f"alpha reads like a vane {value:.2f} m ahead, and alpha.vane_arm_m says {stated:.2f} m"
        case _:
            return value_in_words(x.name, value, std)


def value_in_words(name: InstrumentName, value: float, std: float) -> str:
    """Return the value of an instrument with its 95 % interval, as the beginning of a sentence."""
    half = NORMAL_95 * std
    match name:
        case "servo_lag_s":
            return f"the servo's lag is {value:.3f} ± {half:.3f} s"
        case "command_delay_s":
            side = "before" if value < 0.0 else "after"
            return f"the command acts {abs(1e3 * value):.0f} ± {1e3 * half:.0f} ms {side} its stamps"
        case "vane_arm_m":
            place = f"{abs(value):.2f} ± {half:.2f} m {_side(value)} the centre of gravity"
            return f"alpha reads like a vane {place}"
        case "alpha_delay_s":
            side = "early" if value < 0.0 else "late"
            return f"alpha is {abs(1e3 * value):.0f} ± {1e3 * half:.0f} ms {side} relative to the motion"
        case "accelerometer_arm_m":
            place = f"{abs(value):.2f} ± {half:.2f} m {_side(value)} the centre of gravity"
            return f"the accelerometer reads as if it were {place}"
        case _:
            return (
                "the moment that does not change with air speed, such as the thrust's, equals"
                f" {np.degrees(value):+.1f} ± {np.degrees(half):.1f} deg of elevator"
            )


def _side(arm_m: float) -> str:
    """Return on which side of the centre of gravity an arm lies."""
    return "ahead of" if arm_m >= 0.0 else "behind"


def line_of(name: InstrumentName, value: float) -> str:
    """Return the line for the aircraft file; empty if the file has no key for the instrument."""
    return _PLACES[name][2].format(value) if name in _PLACES else ""


def _sign(estimate: Estimate) -> tuple[InstrumentFinding, ...]:
    """Return a finding if the elevator's stated sign turns the aircraft the wrong way; else none.

    The elevator is positive trailing edge down, so that M_δe is negative on every aircraft.
    """
    j = PARAMETERS.index("M_delta_e")
    value, std = float(estimate.theta[j]), float(estimate.std[j])
    if "M_delta_e" in estimate.not_identifiable or not value > CONTRADICTS * std:
        return ()
    return (
        InstrumentFinding(
            "elevator",
            "sign",
            1.0,
            -1.0,
            contradicts=True,
            text=f"the elevator's sign is wrong: M_delta_e comes out as {value:+.3g}, and it is negative on"
            " every aircraft",
            fix="turn the sign of every deflection in elevator.calibration (trailing edge down is positive)",
        ),
    )
