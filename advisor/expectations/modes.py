"""Modes of the aircraft file's model, at the steady flight of the manoeuvres."""

from collections.abc import Mapping

import numpy as np

from advisor.aircraft.reference import SIDE_PARAMETERS
from advisor.model.axes.lateral import Trim, modes_of, state_matrix
from advisor.model.short_period import ShortPeriod
from advisor.report.qualities import OPTIONAL

_OF_PITCH = ("Z_alpha", "M_alpha", "M_q")
"""Derivatives without which a model has no short period. A Z_q that the file does not state is zero."""


def lacking(model: Mapping[str, float], mode: str) -> tuple[str, ...]:
    """Return the derivatives that a model lacks for a mode; empty for a sufficient model."""
    states_only = [name for name in SIDE_PARAMETERS if "delta" not in name and name not in OPTIONAL]
    needed = _OF_PITCH if mode.startswith("short_period") else states_only
    return tuple(name for name in needed if name not in model)


def mode_of(model: Mapping[str, float], mode: str, trim: Trim | None) -> float | None:
    """Return a mode of a sufficient model, SI; None for a mode that the model does not have.

    Parameters
    ----------
    model
        Derivatives by name, at the reference air speed.
    mode
        Key of ``MODES``.
    trim
        Steady flight of the lateral manoeuvres; None if none was flown.
    """
    if mode.startswith("short_period"):
        short = ShortPeriod.from_mapping(model)
        omega = short.natural_frequency
        number = omega if mode.endswith("omega") else -float(np.trace(short.a)) / (2.0 * omega)
        return number if np.isfinite(number) else None
    if trim is None:
        return None
    theta = np.array([model.get(name, 0.0) for name in SIDE_PARAMETERS])
    modes = modes_of(state_matrix(theta, trim))
    if mode == "spiral_pole":
        return modes.spiral
    if mode == "roll_time_constant":
        return -1.0 / modes.roll if modes.roll else None
    if modes.dutch_roll is None:
        return None
    omega = abs(modes.dutch_roll)
    return omega if mode == "dutch_roll_omega" else -modes.dutch_roll.real / omega
