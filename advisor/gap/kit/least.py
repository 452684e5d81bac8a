"""Least sizes at which effects are named, for limits that several effects share."""

from advisor.gap.records.flights import PreparedManeuvers

LEAST_S = 0.004
FILTERED_S = 0.02
"""Least delay or lag that is named, s: a fifth of a sample at 50 Hz, and the delay of an autopilot's
filters."""
SMALL_ANGLE_RAD = 0.00175
"""Least angle that is named, rad (0.1 deg): no linkage has less play."""
ARM_M, _OF_A_DELAY = 0.02, 0.75
"""Least arm that is named, m, and the share of the least delay that gives the least arm over the air
speed."""


def least_delay_s(flights: PreparedManeuvers) -> float:
    """Return the least delay or lag of an instrument that is named, s.

    An autopilot's own estimates have passed its filters, and the delay of a filter is no fault.
    """
    return FILTERED_S if flights.alpha_is_derived else LEAST_S


def least_arm_m(flights: PreparedManeuvers) -> float:
    """Return the least arm of an instrument that is named, m.

    In a turning flight path, a vane ahead of the centre of gravity makes α late by arm over speed. The
    accelerometer's position has an equal effect, and the gyro's filter adds three quarters of the least
    delay.
    """
    return max(ARM_M, _OF_A_DELAY * least_delay_s(flights) * flights.reference_m_s)
