"""Limits at which a script ends an input at once and gives the surfaces back."""

from dataclasses import dataclass

from advisor.aircraft.aircraft import Aircraft

LOWEST_M = 30.0
"""Usual height above home below which no input begins and every input ends, m. A pilot needs 2 s to see and
to recover, in which an aircraft at 30 deg nose down and 20 m/s loses 20 m."""


@dataclass(frozen=True, slots=True)
class FlightLimits:
    """Limits of a script, each with its unit in the name."""

    bank_deg: float
    airspeed_percent: float
    """Largest change of the air speed from its value before the input, %."""
    lowest_m: float
    pitch_deg: float = 30.0
    """Largest change of the pitch angle from its value before the input, deg. At a larger change, the weight
    along the path accelerates the aircraft by more than a third of g.
    """
    stick_percent: float = 10.0
    """Largest motion of a stick during an input, % of its travel from neutral. A larger motion means that a
    pilot takes over.
    """
    link_s: float = 3.0
    """Longest silence of the ground station, s. The limit applies if a ground station was heard before."""

    @classmethod
    def of(cls, aircraft: Aircraft, lowest_m: float = LOWEST_M) -> "FlightLimits":
        limits = aircraft.limits
        return cls(limits.bank_deg, limits.airspeed_change_percent, lowest_m)
