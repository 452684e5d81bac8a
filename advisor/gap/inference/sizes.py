"""Prior width of every effect's parameters, before the flight.

A width is the typical size of the parameter on an aircraft that has the effect. Widths follow from physics
and from data sheets of servos and sensors. No test flight set these widths.
"""

from dataclasses import replace

import numpy as np

from advisor.gap.fitting.prior import derivative_scale
from advisor.gap.kit.effect import Variant
from advisor.gap.records.flights import PreparedManeuvers
from advisor.gap.simulator.layout import natural_frequency
from advisor.process.arrays import FloatArray

_OF_READING = {"skew_s": 0.1, "scale": 0.1, "step": 0.1}
"""Prior: standard deviations of late stamps, s, and of relative errors of any reading. A stream that is
renewed at 10 Hz is late by its interval: ArduPlane's air speed by 118 ms."""
BENT = 0.5
"""Prior: standard deviation of a nonlinear term at the largest flown deviation, relative to the linear
term."""
_SLOWEST_RAD_S = 0.5
"""Numerical: least frequency of the short period for the prior width of an arm, rad/s."""
_LEAST_ALPHA_RAD, _LEAST_DELTA_RAD = 0.05, 0.02
"""Numerical: least deviations of angle of attack and elevator for the width of a nonlinear term, rad."""
_OF_EFFECT = {
    "actuator_lag.lag_s": 0.05, "transport_delay.delay_s": 0.05, "actuator_rate_limit.rate_rad_s": 1.5,
    "actuator_backlash.half_width_rad": 0.01, "actuator_deadband.half_width_rad": 0.01,
    "actuator_deadband.neutral_rad": 0.01, "alpha_lag.lag_s": 0.08,
    "pitch_rate_bias.bias_rad_s": 0.01, "structural_mode.frequency_hz": 4.0,
    "structural_mode.omega_rad_s": 25.0, "structural_mode.damping": 0.05, "structural_mode.gain": 1.0,
    "structural_mode.rate_gain": 0.3,
    "alpha_dot.M_alpha_dot": 1.5, "unsteady_lift.share": 0.3, "unsteady_lift.lag_s": 0.4,
    "nonlinear_lift.stall_rad": 0.2, "nonlinear_lift.sharpness": 40.0, "ground_effect.lift_h": 0.3,
    "ground_effect.scale_m": 5.0, "airspeed_variation.exponent": 0.5, "airspeed_variation.exponent_M": 0.5,
    "thrust_moment.lag_s": 0.5,
    "mass_change.step": 0.15, "mass_change.inertia": 0.15, "cg_shift.step": 0.2, "icing.Z_alpha": 0.15,
    "icing.Z_delta_e": 0.15, "icing.M_alpha": 0.15, "icing.M_delta_e": 0.15,
}  # fmt: skip
"""Prior: standard deviation of each effect's parameters, in the unit of the search."""
ARM_SHARES = {"alpha_vane_offset": 0.2, "accelerometer_offset": 0.1}
"""Prior: standard deviation of an arm, as a share of the distance flown per radian of the short period.

A small UAV flies 2.5 m in one radian of its short period. A jet with a nose boom of 13 m flies 50 m."""
_NATURAL = 0.02
"""Prior: size of an effect natural to every aircraft, as a share of its size on an aircraft with the
effect."""
_OF_DATA_SHEETS = {
    "actuator_lag": 0.2, "transport_delay": 0.2, "actuator_backlash": 0.15, "actuator_deadband": 0.15,
    "pitch_rate_scale": 0.1,
}  # fmt: skip
"""Prior: natural share of effects whose natural size data sheets state. The lag and the delay of a servo are
known to 10 ms. A servo ignores 2 to 4 µs of its command, 0.2 deg, and its gears play as much: 1.5 mrad to
either side. The scale of a MEMS gyro is right to 1 %."""
_OF_RANGE = 0.5
"""Prior: standard deviation of any other parameter, as a share of the largest searched value."""


def with_sizes(variant: Variant, derivatives: FloatArray, flights: PreparedManeuvers) -> Variant:
    """Return the variant with a Gaussian prior about zero on each parameter that has none.

    Parameters
    ----------
    derivatives
        Shape (6,): derivatives of the simulator, or fitted derivatives if the file states none.
    """
    if variant.prior_std:
        return variant
    z_alpha, _, _, m_alpha, _, m_delta = derivative_scale(derivatives)
    alpha, delta = _departures(flights)
    way_m = flights.reference_m_s / max(natural_frequency(derivatives), _SLOWEST_RAD_S)
    span = max(float(flights.flights[-1].started_s - flights.flights[0].started_s), 1.0)
    of_number = {
        "M_delta2": BENT * m_delta / delta, "M_delta3": BENT * m_delta / delta**2,
        "M_alpha2": BENT * m_alpha / alpha, "M_alpha3": BENT * m_alpha / alpha**2,
        "Z_alpha2": BENT * z_alpha / alpha, "Z_alpha3": BENT * z_alpha / alpha**2,
        "M_throttle": 0.5 * m_delta * delta, "M_h": m_delta * delta, "Z_h": z_alpha * alpha,
        "at_s": span, "over_s": span, "rate_per_s": 0.2 / span,
        "arm_m": ARM_SHARES.get(variant.effect, 0.0) * way_m,
    }  # fmt: skip
    stds = [
        width_of(variant.effect, name, of_number.get(name, std))
        for name, std in zip(variant.names, of_range(variant), strict=True)
    ]
    return replace(variant, prior_std=tuple(stds))


def width_of(effect: str, name: str, other: float = np.nan) -> float:
    """Return the prior width of a servo's or a reading's parameter on any axis; ``other`` of another
    parameter."""
    return _OF_EFFECT.get(f"{effect}.{name}", _OF_READING.get(name, other))


def of_range(variant: Variant) -> tuple[float, ...]:
    """Return the prior widths of parameters of which only the searched range is known."""
    return tuple(_OF_RANGE * max(map(abs, bounds)) for bounds in variant.bounds)


def natural_shares(variant: Variant) -> FloatArray:
    """Return the size of each parameter on every aircraft, as a share of its prior width, shape (numbers,).

    A position, a time or a rate is as free on every aircraft as on an aircraft with the effect.
    """
    share = _OF_DATA_SHEETS.get(variant.effect, _NATURAL)
    return np.array([1.0 if name in variant.places else share for name in variant.names])


def natural_nats(sizes: FloatArray, std: FloatArray, share: FloatArray) -> float:
    """Return the log density ratio, nats, of sizes natural to every aircraft to those of an effect.

    Parameters
    ----------
    sizes, std
        Shape (k,): an effect's parameters, and their prior widths on an aircraft with the effect.
    share
        Shape (k,): natural widths, as shares of ``std``.
    """
    return float(-0.5 * np.sum((sizes / std) ** 2 * (share**-2 - 1.0)) - np.sum(np.log(share)))


def _departures(flights: PreparedManeuvers) -> tuple[float, float]:
    """Return half of the flown range of angle of attack and of elevator, rad."""
    alphas = [np.ptp(f.outputs["alpha"].y) / 2.0 for f in flights.flights if "alpha" in f.outputs]
    deltas = [np.ptp(f.u) / 2.0 for f in flights.flights]
    return float(max([_LEAST_ALPHA_RAD, *alphas])), float(max([_LEAST_DELTA_RAD, *deltas]))
