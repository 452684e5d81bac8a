"""The control that a pilot moves, and the motion by which the aircraft answers."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Loop:
    """Channels of one control and of its answer, with their names in sentences."""

    control: str
    """Channel of the deflection."""
    rate: str
    """Channel of the angular rate that answers."""
    angle: str
    """Channel of the angle that the rate turns; empty where none is measured."""
    rate_said: str


PITCH = Loop("elevator", "q", "theta", "pitch rate")
ROLL = Loop("aileron", "p", "bank", "roll rate")
YAW = Loop("rudder", "r", "", "yaw rate")
