"""Vector of simulator inputs in the gap diagnosis: the meaning of each entry.

The entries are the six derivatives of Eqs. (1)-(2), which manoeuvres share, four nuisance parameters of each
manoeuvre, and the parameters of every candidate effect. An entry of zero means that the effect is absent.
"""

from collections import namedtuple
from collections.abc import Callable, Sequence
from typing import Any
from zlib import crc32

import numpy as np

from advisor.model import outputs
from advisor.process.arrays import FloatArray

DERIVATIVES = ("Z_alpha", "Z_q", "Z_delta_e", "M_alpha", "M_q", "M_delta_e")
NUISANCES = ("alpha_start", "q_start", "Z_trim", "M_trim")
"""Nuisance parameters of each manoeuvre: initial deviations of α (rad) and q (rad/s), and the terms of
Eqs. (1)-(2) at the trim point."""
EFFECT_ENTRIES = (
    # input; latency is the delay of a few milliseconds between a command's stamp and its effect, in every
    # model
    "delay_s", "latency_s", "lag_s", "lag_damping", "slowness_s_rad",
    "half_play_rad", "play_side", "half_deadband_rad", "neutral_rad", "stop_up_rad", "stop_down_rad",
    "breakaway_rad", "sliding_share", "loop_s",
    # moment equation
    "M_delta2", "M_delta3", "M_alpha2", "M_alpha3", "M_alpha_dot", "M_h",
    "M_throttle", "engine_lag_s", "M_thrust", "washed_share", "blown_share",
    "inertia_share", "inertia_product",
    # laws outside the catalogue, of the moment and of the force
    "M_q_abs", "M_q_q", "M_alpha_q", "M_alpha_delta_e", "Z_q_abs", "Z_q_q",
    # force equation
    "Z_alpha2", "Z_alpha3", "stall_rad", "stall_sharpness", "lift_share", "lift_lag_s", "moment_share",
    "Z_memory", "memory_rad", "Z_separated", "separation_rad", "attachment_rad",
    "Z_h", "lift_h", "scale_m", "speed_power", "moment_power",
    # sensors
    "alpha_lag_s", "alpha_scale", "vane_arm_m", "q_bias", "q_scale",
    "mode_gain", "mode_rate_gain", "mode_rad_s", "mode_damping", "imu_arm_m",
    # stamps
    "alpha_skew_s", "q_skew_s", "a_z_skew_s", "theta_skew_s",
    # instruments with a scale error or a nonlinear reading, outside the catalogue
    "a_z_scale", "theta_scale", "a_z_read2", "a_z_read3", "alpha_read2", "alpha_read3", "q_pull", "q_pull2",
    # error of the air speed: a parabola in time over the record, from -1 to 1
    "speed_level_m_s", "speed_slope_m_s", "speed_bow_m_s",
    # relative excess of the true air speed over the air speed that is read, in all manoeuvres
    "speed_scale",
    # a filter 1/(1 + T p + c T² p²) in one instrument: T, c, and the index of the output
    "filter_lag_s", "filter_shape", "filter_output",
    # a vane with dry friction, as a play, and with stops
    "vane_play_rad", "vane_stop_up_rad", "vane_stop_down_rad",
    # 1: the attitude contains the structural mode too
    "mode_attitude",
)  # fmt: skip
EQUATION_ENTRIES = EFFECT_ENTRIES[EFFECT_ENTRIES.index("M_delta2") : EFFECT_ENTRIES.index("alpha_lag_s")]
"""Entries for effects in Eqs. (1)-(2)."""
ENTRIES = (*DERIVATIVES, *NUISANCES, *EFFECT_ENTRIES)
INDEX = {name: i for i, name in enumerate(ENTRIES)}

OUTPUTS = outputs.OUTPUTS
"""Names of the simulated and compared outputs, in their order."""
SKEWS = ("alpha_skew_s", "q_skew_s", "a_z_skew_s", "theta_skew_s")
"""Entries that shift the stamps of each output, in the order of ``OUTPUTS``."""
FILTER = ("filter_lag_s", "filter_shape", "filter_output")
"""Entries of the filter in one output."""


def places(names: Sequence[str]) -> Any:
    """Return the index of each name in a list, read in compiled functions as ``places(names).name``."""
    named: Callable[..., Any] = namedtuple
    return named("Places", names)(*range(len(names)))


AT, READ, FILTERED = places(ENTRIES), places(OUTPUTS), places(FILTER)
SLOW = places(("speed", "a_x", "bank", "throttle", "height", "thrust", "turn", "slip", "roll_yaw", "squares"))
SPEED, A_X, BANK, THROTTLE, HEIGHT, THRUST, TURN, SLIP, ROLL_YAW, SQUARES = SLOW
"""Row numbers of the slow inputs, which have one value per time step; ``roll_yaw`` is p·r and
``squares`` is r² - p²."""
DISTURBED = places(("input", "force", "moment", "air"))
DISTURB_INPUT, DISTURB_FORCE, DISTURB_MOMENT, DISTURB_AIR = DISTURBED
"""Row numbers of the disturbances, one value per time step, added to δ, α̇, q̇ and the angle of the air."""
TRIM = places(("alpha", "theta", "reference", "scaled"))
ALPHA_TRIM, THETA_FROM, REFERENCE, SCALED = TRIM
"""Indices in a manoeuvre's trim: initial α and θ (rad), reference speed of the derivatives (m/s), and 1 where
derivatives scale with the air speed."""


def key_of(*lists: Any) -> int:
    """Return a hash of index lists from ``places``, which changes with every name and every index."""
    return crc32(repr(lists).encode())


LAYOUT = key_of(AT, READ, SLOW, DISTURBED, TRIM)
"""Hash of the layout for which the simulation's functions were compiled; every call passes it."""
OTHER_LAYOUT = """The simulation was compiled for another list of numbers: delete its compiled files, \
__pycache__/*.nbi in advisor/gap/simulator, and start again."""


def natural_frequency(derivatives: FloatArray) -> float:
    """Return the undamped natural frequency of the short period in rad/s; 0 without a short period.

    ``derivatives`` has shape (6,).
    """
    z_alpha, z_q, _, m_alpha, m_q, _ = derivatives
    return float(np.sqrt(max(z_alpha * m_q - (1.0 + z_q) * m_alpha, 0.0)))


def short_period(p: FloatArray) -> FloatArray:
    """Return Z_α, Z_q, M_α, M_q of the equations solved for α̇ and q̇, with M_α̇ α̇ eliminated by Eq. (1).

    ``p`` has shape (entries,).
    """
    z_alpha, z_q, m_alpha, m_q = p[[INDEX[name] for name in ("Z_alpha", "Z_q", "M_alpha", "M_q")]]
    lagging = p[INDEX["M_alpha_dot"]]
    return np.array([z_alpha, z_q, m_alpha + lagging * z_alpha, m_q + lagging * (1.0 + z_q)])
