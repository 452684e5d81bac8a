"""The vector of numbers the gap's simulation is driven by: what each entry is, zero meaning "absent".

Six shared derivatives of Eqs. (1)-(2), four numbers free in every manoeuvre (initial states and
trim), and one entry per parameter of every candidate effect. All effect entries are zero in the
plain model, so adding an effect means freeing its entries and nothing else.
"""

from collections import namedtuple
from collections.abc import Callable, Sequence
from typing import Any
from zlib import crc32

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.model import response

DERIVATIVES = ("Z_alpha", "Z_q", "Z_delta_e", "M_alpha", "M_q", "M_delta_e")
NUISANCES = ("alpha_start", "q_start", "Z_trim", "M_trim")
"""Free in every manoeuvre: deviation of α and q at its start, and the trim terms of Eqs. (1)-(2)
at the trimmed α and δe instead of at zero."""
EFFECT_ENTRIES = (
    # input; the latency is the few milliseconds between a command's stamp and its effect, in every model
    "delay_s", "latency_s", "lag_s", "lag_damping", "slowness_s_rad",
    "half_play_rad", "play_side", "half_deadband_rad", "neutral_rad", "stop_up_rad", "stop_down_rad",
    "breakaway_rad", "sliding_share", "loop_s",
    # moment equation
    "M_delta2", "M_delta3", "M_alpha2", "M_alpha3", "M_alpha_dot", "M_h",
    "M_throttle", "engine_lag_s", "M_thrust", "washed_share", "blown_share",
    # laws of the moment that have no name
    "M_q_abs", "M_q_q", "M_alpha_q", "M_alpha_delta_e",
    # force equation
    "Z_alpha2", "Z_alpha3", "stall_rad", "stall_sharpness", "lift_share", "lift_lag_s", "moment_share",
    "Z_memory", "memory_rad", "Z_separated", "separation_rad", "attachment_rad",
    "Z_h", "lift_h", "scale_m", "speed_power", "moment_power",
    # sensors
    "alpha_lag_s", "alpha_scale", "vane_arm_m", "q_bias", "q_scale",
    "mode_gain", "mode_rate_gain", "mode_rad_s", "mode_damping", "imu_arm_m",
    # stamps
    "alpha_skew_s", "q_skew_s", "a_z_skew_s", "theta_skew_s",
    # instruments whose reading is a scaled or bent one, and has no name for it
    "a_z_scale", "theta_scale", "a_z_read2", "a_z_read3", "alpha_read2", "alpha_read3", "q_pull", "q_pull2",
    # error of the air speed: a parabola in time over the record, from -1 to 1
    "speed_level_m_s", "speed_slope_m_s", "speed_bow_m_s",
    # by how much the true air speed is above the one that is read, in all manoeuvres
    "speed_scale",
    # a filter 1/(1 + T p + c T² p²) in one instrument: its T and c, and which output it is in
    "filter_lag_s", "filter_shape", "filter_output",
    # a vane that friction holds until the air has turned by this much, and that turns as far as to stops
    "vane_play_rad", "vane_stop_up_rad", "vane_stop_down_rad",
    # 1: the attitude swings with the structure, too
    "mode_attitude",
)  # fmt: skip
ENTRIES = (*DERIVATIVES, *NUISANCES, *EFFECT_ENTRIES)
INDEX = {name: i for i, name in enumerate(ENTRIES)}

OUTPUTS = response.OUTPUTS
"""What is simulated and compared, in this order."""
SKEWS = ("alpha_skew_s", "q_skew_s", "a_z_skew_s", "theta_skew_s")
"""Entry that shifts the stamps of each output."""
FILTER = ("filter_lag_s", "filter_shape", "filter_output")
"""Entries that filter one output."""


def places(names: Sequence[str]) -> Any:
    """Place of each name in a list of names, as compiled functions read the place: ``places(names).name``."""
    named: Callable[..., Any] = namedtuple
    return named("Places", names)(*range(len(names)))


AT, READ, FILTERED = places(ENTRIES), places(OUTPUTS), places(FILTER)
SLOW = places(("speed", "a_x", "bank", "throttle", "height", "thrust", "turn"))
SPEED, A_X, BANK, THROTTLE, HEIGHT, THRUST, TURN = SLOW
"""Rows of the slow inputs, one value a step."""
DISTURBED = places(("input", "force", "moment", "air"))
DISTURB_INPUT, DISTURB_FORCE, DISTURB_MOMENT, DISTURB_AIR = DISTURBED
"""Rows of the disturbances, one value a step: added to δ, α̇, q̇ and to the angle of the air."""
TRIM = places(("alpha", "theta", "reference", "scaled"))
ALPHA_TRIM, THETA_FROM, REFERENCE, SCALED = TRIM
"""Places in a manoeuvre's trim: α and θ at its start, rad, the speed that derivatives are given at, m/s, and
1 where they scale with the speed flown."""


def key_of(*lists: Any) -> int:
    """Number that stands for lists of ``places``: another one where a name or its place is another."""
    return crc32(repr(lists).encode())


LAYOUT = key_of(AT, READ, SLOW, DISTURBED, TRIM)
"""What compiled functions of the simulation were compiled for, and are told at every call."""
OTHER_LAYOUT = """The simulation was compiled for another list of numbers: delete its compiled files, \
__pycache__/*.nbi in advisor/gap/simulator, and start again."""


def natural_frequency(derivatives: FloatArray) -> float:
    """Undamped frequency of the short period in rad/s, 0 without one, of derivatives of shape (6,)."""
    z_alpha, z_q, _, m_alpha, m_q, _ = derivatives
    return float(np.sqrt(max(z_alpha * m_q - (1.0 + z_q) * m_alpha, 0.0)))


def short_period(p: FloatArray) -> FloatArray:
    """Z_α, Z_q, M_α, M_q of the two equations solved for their rates: M_α̇ α̇ written out by Eq. (1).

    ``p`` has shape (entries,).
    """
    z_alpha, z_q, m_alpha, m_q = p[[INDEX[name] for name in ("Z_alpha", "Z_q", "M_alpha", "M_q")]]
    lagging = p[INDEX["M_alpha_dot"]]
    return np.array([z_alpha, z_q, m_alpha + lagging * z_alpha, m_q + lagging * (1.0 + z_q)])
