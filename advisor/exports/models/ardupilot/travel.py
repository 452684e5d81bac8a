"""Deflection of a surface per full travel of ArduPilot's servo outputs, from the aircraft file's calibration.

ArduPilot's simulated surfaces are numbers from -1 to 1, at 1000 and 2000 us. Coefficients of a control are
therefore per 500 us, with the sign of the calibration.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.controls import Pairs
from advisor.model.lateral import LATERAL
from advisor.words.problems import ConfigurationError

NEUTRAL_US, HALF_TRAVEL_US = 1500.0, 500.0
OUTPUTS = {"aileron": 1, "elevator": 2, "rudder": 4}
"""Control to the servo output from which ArduPilot's plane reads it."""
FUNCTIONS = {"aileron": 4, "elevator": 19, "rudder": 21}
"""Control to the value of SERVOn_FUNCTION that moves it."""


@dataclass(frozen=True)
class Travel:
    """Line through the ends of a calibration."""

    neutral_rad: float
    """Deflection at 1500 us."""
    per_half_rad: float
    """Change of the deflection per 500 us."""
    low_us: float
    high_us: float
    """Ends of the calibration."""

    @property
    def trim_us(self) -> float:
        """Pulse width without a deflection, within the ends."""
        at = NEUTRAL_US - HALF_TRAVEL_US * self.neutral_rad / self.per_half_rad
        return min(max(at, self.low_us), self.high_us)


def travel_of(aircraft: Aircraft, control: str) -> Travel:
    """Return the travel of the elevator, aileron or rudder.

    Raises
    ------
    ConfigurationError
        The aircraft file has no calibration of this control.
    """
    parts = _calibrations(aircraft, control)
    if not parts:
        raise ConfigurationError(
            f"--export ardupilot: coefficients are per full travel of the servo; give {control}.calibration "
            "in the aircraft file."
        )
    total = sum(weight for weight, _ in parts)
    neutral = travel = 0.0
    for weight, pairs in parts:
        (low_us, low), (high_us, high) = min(pairs), max(pairs)
        slope = (high - low) / (high_us - low_us)
        neutral += weight / total * (low + slope * (NEUTRAL_US - low_us))
        travel += weight / total * slope * HALF_TRAVEL_US
    ends = parts[0][1]
    return Travel(math.radians(neutral), math.radians(travel), min(ends)[0], max(ends)[0])


def calibrated(aircraft: Aircraft, controls: Sequence[str] = ("elevator", *LATERAL.inputs)) -> list[str]:
    """Return the controls that have a calibration."""
    return [name for name in controls if _calibrations(aircraft, name)]


def _calibrations(aircraft: Aircraft, control: str) -> list[tuple[float, Pairs]]:
    """Return the weighted calibrations of a control."""
    stated = getattr(aircraft, control)
    if stated.calibration:
        return [(1.0, stated.calibration)]
    return [(o.weight, o.calibration) for o in getattr(stated, "outputs", ()) if o.calibration]
