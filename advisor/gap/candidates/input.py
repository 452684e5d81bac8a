"""Between command and surface: delay, lag, rate limit, play, dead-band."""

from dataclasses import replace

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.gap.candidates.variant import Values, Variant
from advisor.gap.records.flights import Flights
from advisor.gap.simulator.layout import INDEX

BLOCK = "input"
_SMALL_ANGLE = 0.00175
"""0.1 deg: no linkage is free of less ..."""
_IF_BEYOND_DOUBT = 0.4
"""... worth a word, but that share of it, as a pulse of 1 us moves a surface, shows in a quiet record."""
_DAMPING = 0.7
"""Of a servo of second order: that of position loops tuned to be quick without overshoot."""


LATENCY = Variant(
    "latency",
    BLOCK,
    ("latency_s",),
    ((0.001,),),
    (5e-4,),
    ((-0.004, 0.005),),
    0.0,
    entries=("latency_s",),
    is_nuisance=True,
)
"""Part of every model: stamps have a resolution, and a command takes effect a few milliseconds after."""


def _delay(p: FloatArray, values: Values, _: Flights) -> None:
    """The whole delay: where it is free, the few milliseconds of latency are part of it."""
    p[:, INDEX["delay_s"]] += values[0]
    p[:, INDEX["latency_s"]] = 0.0


def _second_order(p: FloatArray, values: Values, _: Flights) -> None:
    """Trails a ramp as the lag of first order does, but begins to move more gently."""
    p[:, INDEX["lag_s"]] += values[0]
    p[:, INDEX["lag_damping"]] = _DAMPING


def _deadband(p: FloatArray, values: Values, flights: Flights) -> None:
    """A band about one neutral deflection of the aircraft, wherever each manoeuvre was trimmed.

    It need not lie about the trim: whoever trims, pilot or autopilot, ends up on one edge of the band.
    """
    trims = np.array([flight.u_trim for flight in flights.flights])
    p[:, INDEX["half_deadband_rad"]] += values[0]
    p[:, INDEX["neutral_rad"]] = np.median(trims) + values[1] - trims


def _deadband_about_trim(p: FloatArray, values: Values, _: Flights) -> None:
    """A band that moves with the trim: about wherever the command rested before each manoeuvre."""
    p[:, INDEX["half_deadband_rad"]] += values[0]
    p[:, INDEX["neutral_rad"]] = values[1]


def _limited_from_midway(p: FloatArray, values: Values, flights: Flights) -> None:
    """A step between two stamps, wherever it was, happened midway on average: from then on the servo runs.

    Read as linear it would run from the first stamp on, at its limit before the step was there.
    """
    intervals = np.concatenate([np.diff(flight.t_u) for flight in flights.flights])
    p[:, INDEX["slowness_s_rad"]] += values[0]
    p[:, INDEX["delay_s"]] += 0.5 * float(np.median(intervals))


DELAY = Variant(
    "transport_delay",
    BLOCK,
    ("delay_s",),
    ((0.005,), (0.03,), (0.1,)),
    (1e-3,),
    ((0.0, 0.5),),
    0.004,
    apply_with=_delay,
)
LAG = Variant(
    "actuator_lag",
    BLOCK,
    ("lag_s",),
    ((0.02,), (0.1,)),
    (1e-3,),
    ((0.0, 1.0),),
    0.004,
    entries=("lag_s",),
)

# Searched as slowness 1/ρ: zero is "no limit", and the cost is smooth there.
_RATE_LIMIT = Variant(
    "actuator_rate_limit",
    BLOCK,
    ("rate_rad_s",),
    ((0.4,), (1.2,), (3.0,)),
    (0.02,),
    ((0.0, 30.0),),
    0.05,
    entries=("slowness_s_rad",),
    inverted=True,
)
_DEADBAND = Variant(
    "actuator_deadband",
    BLOCK,
    ("half_width_rad", "neutral_rad"),
    ((0.0012, 0.0), (0.004, 0.0), (0.015, 0.0), (0.035, 0.0), (0.01, 0.006), (0.01, -0.006)),
    (2e-4, 2e-4),
    ((0.0, 0.1), (-0.1, 0.1)),
    _SMALL_ANGLE,
    _IF_BEYOND_DOUBT,
    apply_with=_deadband,
    places=("neutral_rad",),
)
_DEADBAND_ABOUT_TRIM = replace(
    _DEADBAND,
    starts=((0.0012, 0.0), (0.004, 0.0), (0.015, 0.0), (0.035, 0.0)),
    apply_with=_deadband_about_trim,
    fixed={"about_trim": 1.0},
)
_TRIMS_DIFFER_RAD = 0.005
"""Between manoeuvres, from which on a band that moves with the trim is another than one that does not."""


def variants(flights: Flights) -> list[Variant]:
    """Effects of the block, described to first order, and the lag to second order, too."""
    moves = float(np.ptp([f.u_trim for f in flights.flights])) > _TRIMS_DIFFER_RAD
    return [
        DELAY,
        LAG,
        Variant(
            "actuator_lag",
            BLOCK,
            ("lag_s",),
            ((0.03,), (0.1,)),
            (1e-3,),
            ((0.0, 1.0),),
            0.004,
            apply_with=_second_order,
            fixed={"damping": _DAMPING},
        ),
        replace(_RATE_LIMIT, likewise=(replace(_RATE_LIMIT, apply_with=_limited_from_midway),)),
        Variant(
            "actuator_backlash",
            BLOCK,
            ("half_width_rad",),
            ((0.003,), (0.008,), (0.02,)),
            (2e-4,),
            ((0.0, 0.1),),
            _SMALL_ANGLE,
            _IF_BEYOND_DOUBT,
            entries=("half_play_rad",),
            sides=("play_side", tuple(np.linspace(-1.0, 1.0, 8))),
        ),
        _DEADBAND,
        *([_DEADBAND_ABOUT_TRIM] if moves else []),
    ]
