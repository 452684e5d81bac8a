"""A flight of multisines: a pilot levels the aircraft, and the script's inputs move all surfaces at once."""

from dataclasses import dataclass

import numpy as np

from advisor.scripts.inputs import CONTROLS
from advisor.scripts.table import ScriptTable

from .body import Body
from .motion import STEP_S, Floats, flown, level_state

CALL_S = 0.01
"""Time between two calls of the script, s."""
BEFORE_S, AFTER_S = 10.0, 2.0
"""Flight by the pilot before each input and after the last one, s."""
US_PER_RAD = -16.0 * 180.0 / np.pi
"""Pulse of one radian, us: 1100 to 1900 us are 25 deg to -25 deg."""


@dataclass(frozen=True)
class Flown:
    """A flight on the time grid."""

    t: Floats
    state: Floats
    """Shape (n, 9): u, v, w, p, q, r, φ, θ and height above home, SI."""
    felt: Floats
    """Shape (n, 3): specific force in body axes, m/s²."""
    pulses: Floats
    """Shape (n, 3): pulses of elevator, aileron and rudder, us."""
    marks: tuple[tuple[float, str], ...]
    """Texts of the script with their times, s."""


def fly(body: Body, table: ScriptTable, lags_s: Floats, inputs: int) -> Flown:
    """Fly ``inputs`` multisines of a script's table, with servos of first order."""
    (entry,) = table.entries
    test = entry.test
    assert test.sines is not None
    sizes = [entry.sizes[control].rad for control in CONTROLS]
    whole = BEFORE_S + test.length_s + test.rest_s
    t = np.arange(0.0, inputs * whole + AFTER_S, STEP_S)
    since = np.where(t < inputs * whole, np.mod(t, whole) - BEFORE_S, -1.0)
    called = np.floor(since / CALL_S + 1e-6) * CALL_S
    share = np.where((since >= 0.0) & (called < test.length_s), called / test.length_s, 0.0)
    asked = [size * test.sines[c].values(share) for c, size in zip(CONTROLS, sizes, strict=True)]
    d = body.derivatives(body.speed)
    pitch, rate = 0.25 * abs(d["M_alpha"] / d["M_delta_e"]), 0.3 * abs(d["M_q"] / d["M_delta_e"])
    roll = abs(d["L_p"] / d["L_delta_a"])
    gains = np.array([pitch, rate, 0.5 * roll, 0.2 * roll, 0.3 / body.speed])
    states, forces, pulses = flown(
        level_state(body.speed, body.alpha), np.array(asked).T, (since < 0.0).astype(float), gains,
        np.array([body.alpha, body.elevator]), np.maximum(lags_s, 1e-4), US_PER_RAD, body.numbers,
    )  # fmt: skip
    starts = BEFORE_S + whole * np.arange(inputs)
    begins = [(float(s), f"ADVISOR BEGIN {n} multisine") for n, s in enumerate(starts, 1)]
    ends = [
        (float(s + test.length_s + test.rest_s), f"ADVISOR END {n} done") for n, s in enumerate(starts, 1)
    ]
    return Flown(t, states, forces, pulses, tuple(sorted([*begins, *ends])))
