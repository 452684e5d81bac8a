"""The instruments: the α channel, the rate gyro, and the position of the accelerometer."""

from dataclasses import replace

import numpy as np

from advisor.flight.instruments.evidence import COMPUTED_WIDTH
from advisor.flight.signals.messages import FloatArray
from advisor.gap.candidates.variant import Values, Variant
from advisor.gap.records.flights import PreparedManeuvers
from advisor.gap.simulator.layout import INDEX

_MODES_HZ = (2.5, 4.0, 6.0, 8.5)
"""Frequencies in Hz at which the search for a structural mode starts."""
_LEAST_BIAS_RAD_S = 0.00175
"""Least bias that is named, rad/s (0.1 deg/s): the rest after a gyro was set to zero on the ground."""
_LEAST_ARM_M, _OF_A_DELAY = 0.02, 0.75
"""Least arm that is named, m; and the least arm over the air speed, as a share of the least delay."""
_OWN_FILTER_S = 0.045
"""Prior standard deviation of the lag of an angle of attack that an autopilot computes, s. Such angles are 20
to 90 ms late."""
_VANE_CHORDS, _IMU_CHORDS = 4.0, 1.0
"""Standard deviations of an arm over the chord. A vane on a nose boom is four chords ahead. An accelerometer
lies within the wing's chord."""

_MODE = Variant(
    "structural_mode", "pitch_rate_sensor", ("gain", "rate_gain", "omega_rad_s", "damping"),
    tuple((0.0, 0.0, 2.0 * np.pi * hz, 0.05) for hz in _MODES_HZ), (0.02, 0.02, 0.1, 0.005),
    ((-50.0, 50.0), (-50.0, 50.0), (12.0, 80.0), (0.003, 0.15)), 0.0,
    entries=("mode_gain", "mode_rate_gain", "mode_rad_s", "mode_damping"),
    places=("omega_rad_s", "damping"),
)  # fmt: skip


def _with_attitude(p: FloatArray, values: Values, flights: PreparedManeuvers) -> None:
    """Add the structural mode to the attitude too, which an autopilot integrates from the gyro."""
    _MODE.apply(p, values, flights)
    p[:, INDEX["mode_attitude"]] = 1.0


_MODE_OF_ALL = replace(_MODE, apply_with=_with_attitude, fixed={"with_attitude": 1.0})

TRUE_AIR_SPEED = Variant(
    "true_air_speed", "accelerometer", ("scale",), ((0.0,),), (0.002,), ((-0.7, 3.0),), 0.0,
    entries=("speed_scale",), prior_std=(0.02,), is_nuisance=True,
)  # fmt: skip
"""Nuisance parameter of every model with α and a_z: the relative excess of the true over the read air speed.
The read speed may be an indicated one, and a static port reads a pressure that the wing changes."""

OWN_ALPHA = Variant(
    "own_alpha", "alpha_sensor", ("lag_s", "scale"), ((0.0, 0.0),), (1e-3, 0.002),
    ((0.0, 2.0 * _OWN_FILTER_S), (-2.0 * COMPUTED_WIDTH, 2.0 * COMPUTED_WIDTH)), 0.0,
    entries=("alpha_lag_s", "alpha_scale"), prior_std=(_OWN_FILTER_S, COMPUTED_WIDTH), is_nuisance=True,
)  # fmt: skip
"""Nuisance parameters of every model with an angle of attack that an autopilot computes: its filter, and its
scale."""


def variants(least_s: float, flights: PreparedManeuvers) -> list[Variant]:
    """Return the effects of the three sensors; a delay below ``least_s`` seconds is not named.

    In a turning flight path, a vane ahead of the centre of gravity makes α late by arm over speed. The
    accelerometer's position has an equal effect, and the gyro's filter adds three quarters of the least
    delay.

    A constant offset of α is judged outside the fits, from the climb rate.
    """
    least_arm_m = max(_LEAST_ARM_M, _OF_A_DELAY * least_s * flights.reference_m_s)
    chord_m = flights.chord_m
    vane, imu = ((() if chord_m is None else (share * chord_m,)) for share in (_VANE_CHORDS, _IMU_CHORDS))
    return [
        Variant(
            "alpha_lag", "alpha_sensor", ("lag_s",), ((0.02,), (0.1,)), (1e-3,), ((0.0, 1.0),), least_s,
            entries=("alpha_lag_s",),
        ),
        Variant(
            "alpha_scale", "alpha_sensor", ("scale",), ((0.0,),), (0.002,), ((-0.8, 3.0),), 0.01,
            entries=("alpha_scale",),
        ),
        Variant(
            "alpha_vane_offset", "alpha_sensor", ("arm_m",), ((0.0,),), (0.02,), ((-20.0, 20.0),),
            least_arm_m, entries=("vane_arm_m",), prior_std=vane,
        ),
        Variant(
            "pitch_rate_bias", "pitch_rate_sensor", ("bias_rad_s",), ((0.0,),), (5e-4,), ((-0.5, 0.5),),
            _LEAST_BIAS_RAD_S, entries=("q_bias",),
        ),
        Variant(
            "pitch_rate_scale", "pitch_rate_sensor", ("scale",), ((0.0,),), (0.002,), ((-0.8, 3.0),), 0.01,
            entries=("q_scale",),
        ),
        replace(_MODE, likewise=(_MODE_OF_ALL,)),
        Variant(
            "accelerometer_offset", "accelerometer", ("arm_m",), ((0.0,),), (0.01,), ((-10.0, 10.0),),
            least_arm_m, entries=("imu_arm_m",), prior_std=imu,
        ),
    ]  # fmt: skip
