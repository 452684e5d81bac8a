"""Nuisance parameters: natural delays, filters and scales that are part of every model and never named."""

import numpy as np

from advisor.flight.instruments.evidence import COMPUTED_WIDTH
from advisor.flight.instruments.lateness import lateness_std
from advisor.gap.kit.variant import Values, Variant
from advisor.gap.records.flights import PreparedManeuvers
from advisor.gap.simulator.layout import INDEX, OUTPUTS, ROLL_YAW, SKEWS, SQUARES
from advisor.oem.instruments import COUPLING_PRIOR
from advisor.process.arrays import FloatArray

_FILTERS_S = 0.01
"""Prior standard deviation of the delay of an autopilot's filters, s. ArduPlane's default, a second-order
low-pass of 20 Hz, delays by 11 ms."""
REACH = 2.0
"""Largest delay of an autopilot's filters, in standard deviations of the prior."""
_OWN_FILTER_S = 0.045
"""Prior standard deviation of the lag of an angle of attack that an autopilot computes, s. Angles of attack
that an autopilot filters are 20 to 90 ms late."""

LOOP = Variant(
    "latency", "input", ("latency_s",), ((0.001,),), (5e-4,), ((-0.004, 0.005),), 0.0,
    entries=("latency_s",), is_nuisance=True,
)  # fmt: skip
"""Nuisance parameter until the command's motion is known: delay of the command between its stamps. Stamps
have a resolution, and a command takes effect within a loop of the autopilot."""

PROPELLER = Variant(
    "propeller", "moment_equation", ("M_thrust", "washed_share", "blown_share"), ((0.0, 0.0, 0.0),),
    (0.05, 0.05, 0.05), ((-100.0, 100.0), (-1.0, 2.0), (-10.0, 10.0)), 0.0,
    entries=("M_thrust", "washed_share", "blown_share"), prior_std=(5.0, 0.5, 3.0), is_nuisance=True,
)  # fmt: skip
"""Nuisance parameters of every model with a measured air speed. The thrust's part of the trim does not grow
with V². An elevator in the propeller's wake meets a higher dynamic pressure, by thrust over disk area
(Glauert). Thrust is drag, which grows with V², plus the acceleration along the path. In a light single-engine
aircraft the wake adds about a fifth of the elevator's power."""

INERTIA = Variant(
    "inertia", "moment_equation", ("inertia_share", "inertia_product"), ((0.0, 0.0),), (0.02, 0.02),
    ((-0.5, 0.5), (-0.15, 0.15)), 0.0, entries=("inertia_share", "inertia_product"),
    prior_std=(COUPLING_PRIOR.std, 0.05), is_nuisance=True,
)  # fmt: skip
"""Nuisance parameters of every model whose manoeuvres roll (``rolls``): the moments of p·r and of r² - p².
The factor of p·r is (I_zz - I_xx)/I_yy, relative to its prior mean. The other factor is I_xz/I_yy:
.05 where the principal axes tilt by 5 degrees (Etkin & Reid, Dynamics of Flight, 1996, ch. 4)."""

STATIC_PORT = 0.02
"""Prior: relative standard deviation of the air speed's error by the static port, which reads a pressure that
the wing changes."""
AIRSPEED = Variant(
    "true_air_speed", "accelerometer", ("scale",), ((0.0,),), (0.002,), ((-0.7, 3.0),), 0.0,
    entries=("speed_scale",), prior_std=(0.05,), is_nuisance=True,
)  # fmt: skip
"""Nuisance parameter of every model with a_z: the relative excess of the true over the read air speed. Data
sheets state 5 %. The read speed may be an indicated one, 3 to 5 % below the true one at 600 m."""

GYRO = Variant(
    "gyro_bias", "pitch_rate_sensor", ("bias_rad_s",), ((0.0,),), (5e-4,), ((-0.015, 0.015),), 0.0,
    entries=("q_bias",), prior_std=(0.003,), is_nuisance=True,
)  # fmt: skip
"""Nuisance parameter of every model: the bias of the pitch rate. The zero rate of a MEMS gyro moves by .01 to
.05 deg/s per kelvin after its calibration: .17 deg/s in flight."""

OWN_ALPHA = Variant(
    "own_alpha", "alpha_sensor", ("lag_s", "scale"), ((0.0, 0.0),), (1e-3, 0.002),
    ((0.0, 2.0 * _OWN_FILTER_S), (-2.0 * COMPUTED_WIDTH, 2.0 * COMPUTED_WIDTH)), 0.0,
    entries=("alpha_lag_s", "alpha_scale"), prior_std=(_OWN_FILTER_S, COMPUTED_WIDTH), is_nuisance=True,
)  # fmt: skip
"""Nuisance parameters of every model with an angle of attack that an autopilot computes: its filter, and its
scale."""


def _late_imu(p: FloatArray, values: Values, _: PreparedManeuvers) -> None:
    """Delay pitch rate and acceleration by one common time."""
    p[:, [INDEX[SKEWS[OUTPUTS.index(channel)]] for channel in ("q", "a_z")]] += values[0]


IMU = Variant(
    "imu_late", "timing", ("late_s",), ((0.0,),), (1e-3,), ((0.0, REACH * _FILTERS_S),), 0.0,
    apply_with=_late_imu, prior_std=(_FILTERS_S,), is_nuisance=True,
)  # fmt: skip
"""Nuisance parameter of every model without an autopilot's angle of attack: the delay that unstated filters
of gyro and accelerometer cause. Neither a vane nor the attitude passes the filters of gyro and
accelerometer. With filters of 15 to 30 Hz the first answer was wrong in 15 of 27 flights without this
parameter, and in 3 with it."""


def rolls(flights: PreparedManeuvers) -> bool:
    """Return whether a standard error of the moments of inertia changes the likelihood of the pitch rate.

    The change of the pitch rate, without a part linear in time, is compared with the gyro's white noise.
    """
    power = np.zeros(2)
    for flight in flights.flights:
        turned = np.cumsum(flight.slow[[ROLL_YAW, SQUARES]], axis=1).T * flight.h
        course = np.vander(np.arange(len(turned)), 2)
        turned -= course @ np.linalg.lstsq(course, turned, rcond=None)[0]
        power += len(flight.outputs["q"].t) * np.mean(turned**2, axis=0)
    white = float(flights.white[flights.channels.index("q")])
    return bool(np.any(power * np.square(INERTIA.prior_std) > white**2))


def latency(flights: PreparedManeuvers) -> Variant:
    """Return the nuisance parameter for the command's delay behind its stamps.

    An autopilot renews the command at one rate and a stream samples it at another, with a phase that differs
    from flight to flight. The prior is that of the estimate (``lateness``). The prior's standard deviation is
    also the largest delay, because all 28 flights stay within it.
    """
    std = lateness_std([flight.t_u for flight in flights.flights])
    return Variant(
        "latency", "input", ("latency_s",), ((0.001,),), (5e-4,), ((-std, std),), 0.0,
        entries=LOOP.entries, prior_std=(std,), is_nuisance=True,
    )  # fmt: skip


def filters(flights: PreparedManeuvers) -> Variant:
    """Return the delays of an autopilot's own channels relative to its pitch rate, as nuisance parameters.

    The autopilot's own angle of attack is as late as the estimate assumes (``lateness``): held over an
    interval, and up to 90 ms late.
    """
    std = dict.fromkeys(("a_z", "theta"), _FILTERS_S)
    if "alpha" in flights.channels:
        std["alpha"] = lateness_std([flight.outputs["alpha"].t for flight in flights.flights])
    channels = [c for c in flights.channels if c in std]
    return Variant(
        "filters", "timing", tuple(f"{c}_late_s" for c in channels), ((0.0,) * len(channels),),
        (1e-3,) * len(channels), tuple((-REACH * std[c], REACH * std[c]) for c in channels), 0.0,
        entries=tuple(SKEWS[OUTPUTS.index(c)] for c in channels),
        prior_std=tuple(std[c] for c in channels), is_nuisance=True,
    )  # fmt: skip
