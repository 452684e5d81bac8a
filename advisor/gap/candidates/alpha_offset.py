"""The least offset of the angle of attack that is removed before a fit, and that a plan foresees."""

from advisor.gap.decision import SIGMAS

_LEAST_RAD = 0.003
"""Least offset of α that is removed before the fit, rad."""


def least_offset_rad(std_rad: float) -> float:
    """Return the least offset of α in rad that is told from zero, given its standard deviation."""
    return max(_LEAST_RAD, SIGMAS * std_rad)
