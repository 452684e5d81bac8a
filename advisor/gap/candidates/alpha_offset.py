"""Least offset of the angle of attack that is subtracted before a fit."""

from advisor.gap.decision import SIGMAS

_LEAST_RAD = 0.003
"""Least offset of α that is subtracted before the fit, rad."""


def least_offset_rad(std_rad: float) -> float:
    """Return the least significant offset of α in rad, given the offset's standard deviation."""
    return max(_LEAST_RAD, SIGMAS * std_rad)
