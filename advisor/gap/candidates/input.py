"""Between command and surface: delay, lag, rate limit, play, dead band."""

from dataclasses import replace

import numpy as np

from advisor.flight.instruments.lateness import lateness_std
from advisor.flight.signals.messages import FloatArray
from advisor.gap.candidates.variant import Values, Variant
from advisor.gap.records.flights import PreparedManeuvers
from advisor.gap.simulator.layout import INDEX

BLOCK = "input"
_SMALL_ANGLE = 0.00175
"""Least angle that is named, rad (0.1 deg): no linkage has less play."""
_IF_BEYOND_DOUBT = 0.4
"""Share of the least angle that is enough for an effect beyond doubt. In a quiet record such an angle shows,
being that of a servo pulse 1 us longer."""
_DAMPING = 0.7
"""Damping ratio of the second-order servo, as in position loops that are tuned to be quick without
overshoot."""


_LEAST_S = 0.004
"""Least delay or lag that is named, s: a fifth of a sample at 50 Hz."""


LOOP = Variant(
    "latency", BLOCK, ("latency_s",), ((0.001,),), (5e-4,), ((-0.004, 0.005),), 0.0,
    entries=("latency_s",), is_nuisance=True,
)  # fmt: skip
"""Nuisance parameter until the motion of the command between its stamps is known. Stamps have a resolution,
and a command takes effect within a loop of the autopilot."""


def latency(flights: PreparedManeuvers) -> Variant:
    """Return the delay of the command behind its stamps, a nuisance parameter of every model.

    An autopilot renews the command at one rate and a stream samples it at another, with a phase that differs
    from flight to flight. The prior is that of the estimate (``lateness``). Its standard deviation is also
    the largest such delay, because the 28 flights behind it stay within.
    """
    std = lateness_std([flight.t_u for flight in flights.flights])
    return Variant(
        "latency", BLOCK, ("latency_s",), ((0.001,),), (5e-4,), ((-std, std),), 0.0,
        entries=LOOP.entries, prior_std=(std,), is_nuisance=True,
    )  # fmt: skip


def _delay(p: FloatArray, values: Values, _: PreparedManeuvers) -> None:
    """Set the whole delay: where the delay is free, it includes that between command and telemetry."""
    p[:, INDEX["delay_s"]] += values[0]
    p[:, INDEX["latency_s"]] = 0.0


def _second_order(p: FloatArray, values: Values, _: PreparedManeuvers) -> None:
    """Set a second-order servo, which trails a ramp like a first-order lag but begins to move more gently."""
    p[:, INDEX["lag_s"]] += values[0]
    p[:, INDEX["lag_damping"]] = _DAMPING


def _deadband(p: FloatArray, values: Values, flights: PreparedManeuvers) -> None:
    """Set a dead band about one neutral deflection of the aircraft, whatever the trim of each manoeuvre.

    The band need not lie about the trim, because pilots and autopilots trim to one edge of the band.
    """
    trims = np.array([flight.u_trim for flight in flights.flights])
    p[:, INDEX["half_deadband_rad"]] += values[0]
    p[:, INDEX["neutral_rad"]] = np.median(trims) + values[1] - trims


def _deadband_about_trim(p: FloatArray, values: Values, _: PreparedManeuvers) -> None:
    """Set a dead band that moves with the trim, about the command before each manoeuvre."""
    p[:, INDEX["half_deadband_rad"]] += values[0]
    p[:, INDEX["neutral_rad"]] = values[1]


DELAY = Variant(
    "transport_delay", BLOCK, ("delay_s",), ((0.005,), (0.03,), (0.1,)), (1e-3,), ((0.0, 0.5),), _LEAST_S,
    apply_with=_delay,
)  # fmt: skip
"""The whole delay of the command. The model without it has the delay of telemetry (``latency``), so that only
a longer one changes anything."""
LAG = Variant(
    "actuator_lag", BLOCK, ("lag_s",), ((0.02,), (0.1,)), (1e-3,), ((0.0, 1.0),), _LEAST_S,
    entries=("lag_s",),
)  # fmt: skip

# The search uses the slowness 1/ρ: zero means no limit, and the cost is smooth there.
_RATE_LIMIT = Variant(
    "actuator_rate_limit", BLOCK, ("rate_rad_s",), ((0.4,), (1.2,), (3.0,)), (0.02,), ((0.0, 30.0),), 0.05,
    entries=("slowness_s_rad",), inverted=True,
)  # fmt: skip
_DEADBAND = Variant(
    "actuator_deadband", BLOCK, ("half_width_rad", "neutral_rad"),
    ((0.0012, 0.0), (0.004, 0.0), (0.015, 0.0), (0.035, 0.0), (0.01, 0.006), (0.01, -0.006)), (2e-4, 2e-4),
    ((0.0, 0.1), (-0.1, 0.1)), _SMALL_ANGLE, _IF_BEYOND_DOUBT, apply_with=_deadband,
    places=("neutral_rad",),
)  # fmt: skip
_DEADBAND_ABOUT_TRIM = replace(
    _DEADBAND,
    starts=((0.0012, 0.0), (0.004, 0.0), (0.015, 0.0), (0.035, 0.0)),
    apply_with=_deadband_about_trim,
    fixed={"about_trim": 1.0},
)
_TRIMS_DIFFER_RAD = 0.005
"""Least range of the trims in rad that distinguishes a dead band moving with the trim from a fixed one."""


def variants(flights: PreparedManeuvers) -> list[Variant]:
    """Return the effects of the block to first order, and the lag also to second order."""
    moves = float(np.ptp([f.u_trim for f in flights.flights])) > _TRIMS_DIFFER_RAD
    return [
        DELAY,
        LAG,
        Variant(
            "actuator_lag", BLOCK, ("lag_s",), ((0.03,), (0.1,)), (1e-3,), ((0.0, 1.0),), _LEAST_S,
            apply_with=_second_order, fixed={"damping": _DAMPING},
        ),
        _RATE_LIMIT,
        Variant(
            "actuator_backlash", BLOCK, ("half_width_rad",), ((0.003,), (0.008,), (0.02,)), (2e-4,),
            ((0.0, 0.1),), _SMALL_ANGLE, _IF_BEYOND_DOUBT, entries=("half_play_rad",),
            sides=("play_side", tuple(np.linspace(-1.0, 1.0, 8))),
        ),
        _DEADBAND,
        *([_DEADBAND_ABOUT_TRIM] if moves else []),
    ]  # fmt: skip
