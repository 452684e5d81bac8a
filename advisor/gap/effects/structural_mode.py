"""A structural mode oscillates and turns the gyro with the structure."""

from dataclasses import replace

import numpy as np

from advisor.gap.kit.effect import ANY, Effect, Values, Variant, always
from advisor.gap.records.flights import PreparedManeuvers
from advisor.gap.simulator.layout import INDEX
from advisor.process.arrays import FloatArray

_MODES_HZ = (2.5, 4.0, 6.0, 8.5)
"""Frequencies of the structural mode, Hz, at which the search starts."""
_MODE = Variant(
    "structural_mode", "pitch_rate_sensor", ("gain", "rate_gain", "omega_rad_s", "damping"),
    tuple((0.0, 0.0, 2.0 * np.pi * hz, 0.05) for hz in _MODES_HZ), (0.02, 0.02, 0.1, 0.005),
    ((-50.0, 50.0), (-50.0, 50.0), (12.0, 80.0), (0.003, 0.15)), 0.0,
    entries=("mode_gain", "mode_rate_gain", "mode_rad_s", "mode_damping"),
    places=("omega_rad_s", "damping"),
    in_file={
        "frequency_hz": ("omega_rad_s", 2.0 * np.pi), "damping": ("damping", 1.0),
        "gain": ("rate_gain", 1.0), "displacement_gain": ("gain", 1.0),
    },
)  # fmt: skip


def _with_attitude(p: FloatArray, values: Values, flights: PreparedManeuvers) -> None:
    """Add the structural mode to the attitude too, which an autopilot integrates from the gyro."""
    _MODE.apply(p, values, flights)
    p[:, INDEX["mode_attitude"]] = 1.0


_MODE_OF_ALL = replace(_MODE, apply_with=_with_attitude, fixed={"with_attitude": 1.0})

EFFECT = Effect(
    name="structural_mode",
    block="pitch_rate_sensor",
    keys={
        "frequency_hz": 0.0, "damping": 0.0, "gain": ANY, "displacement_gain": ANY, "with_attitude": 0.0,
    },
    variants=always(replace(_MODE, likewise=(_MODE_OF_ALL,))),
    said="The structure swings at {frequency_hz:.1f} Hz in the pitch rate",
)  # fmt: skip
