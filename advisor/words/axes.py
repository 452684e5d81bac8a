"""Names of the axes that a flight test has."""

from typing import Literal

AxisName = Literal["pitch", "lateral"]
"""An axis: pitch, which the elevator moves, or roll and yaw, which aileron and rudder move."""
AXES: tuple[AxisName, ...] = ("pitch", "lateral")
"""All axes, in the order of the reports."""
