"""A control that a pilot moves, and the motion with which the aircraft responds."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Loop:
    """Channels of one control and of its response, with their names in sentences."""

    control: str
    """Channel of the deflection."""
    rate: str
    """Channel of the angular rate that responds."""
    angle: str
    """Channel of the integrated angle; empty if no angle is measured."""
    rate_said: str


PITCH = Loop("elevator", "q", "theta", "pitch rate")
ROLL = Loop("aileron", "p", "bank", "roll rate")
YAW = Loop("rudder", "r", "", "yaw rate")
