"""Simple laws outside the catalogue: nonlinear readings, nonlinear damping, losses, friction and stops.

The catalogue scales α and q, but not a_z and θ. The catalogue has no nonlinear reading, and no gyro that is
sensitive to acceleration. Moments of the catalogue are nonlinear in deflection and α, but not in pitch rate.
The catalogue's servo may lag or reach a rate limit, but neither overshoots nor meets a stop. The catalogue's
α may lag, but no vane has friction or a stop. The catalogue's channels may be late, but have no filter. The
catalogue's lift may be nonlinear and delayed, but has no hysteresis. Ice reduces lift and elevator power, but
no effect reduces elevator power alone.
"""

from collections.abc import Sequence
from functools import partial

import numpy as np

from advisor.gap.kit.changes_between import steps_in
from advisor.gap.kit.effect import Values, Variant
from advisor.gap.records.flights import PreparedManeuvers
from advisor.gap.simulator.layout import FILTER, INDEX, OUTPUTS
from advisor.process.arrays import FloatArray

LIFT_MEMORY, FLOW_LETS_GO = "lift_memory", "flow_lets_go"
_FORCE = "force_equation"


def lift_memory(flights: PreparedManeuvers) -> Variant:
    """Return lift with the hysteresis of play, an elementary model of a gradual stall."""
    swing = float(np.median([np.ptp(f.outputs["alpha"].y) for f in flights.flights]))
    return Variant(
        LIFT_MEMORY, _FORCE, ("Z_memory", "half_width_rad"),
        tuple((0.0, share * swing) for share in (0.1, 0.3)), (0.05, 0.01 * swing),
        ((-20.0, 0.0), (0.01 * swing, 0.6 * swing)), 0.0,
        entries=("Z_memory", "memory_rad"), places=("half_width_rad",),
    )  # fmt: skip


def flow_lets_go(flights: PreparedManeuvers) -> Variant:
    """Return lift that is lost at one angle of attack and returns at a lower angle, like a relay."""
    trims = np.array([flight.alpha_trim for flight in flights.flights])
    above = [float(np.max(f.outputs["alpha"].y)) - f.alpha_trim for f in flights.flights]
    most, middle = float(np.median(above)), float(np.median(trims))

    def let_go(p: FloatArray, values: Values, _: PreparedManeuvers) -> None:
        lost, at, band = values
        p[:, INDEX["Z_separated"]] = lost
        p[:, INDEX["separation_rad"]] = at + middle - trims
        p[:, INDEX["attachment_rad"]] = at - band + middle - trims

    starts = tuple((0.0, at * most, band * most) for at in (0.4, 0.6, 0.8) for band in (0.2, 0.4, 0.7))
    return Variant(
        FLOW_LETS_GO, _FORCE, ("Z_separated", "at_rad", "band_rad"), starts,
        (0.005, 0.05 * most, 0.05 * most), ((-1.0, 1.0), (0.0, 1.2 * most), (0.01, 1.5 * most)), 0.0,
        apply_with=let_go, places=("at_rad", "band_rad"),
    )  # fmt: skip


SURFACE_STOP, VANE_STOP = "surface_stop", "vane_stop"
STOPS = "stop_up_rad", "stop_down_rad"
_TRIMMED_RAD = 0.002
"""Numerical: least distance of a stop from trim, rad."""


def surface_stops(flights: PreparedManeuvers) -> list[Variant]:
    """Return variants of an elevator with a stop up, down, or both."""
    trims = np.array([flight.u_trim for flight in flights.flights])
    flown = np.concatenate([flight.u for flight in flights.flights])
    return stops(SURFACE_STOP, "input", STOPS, trims, flown)


def vane_stops(flights: PreparedManeuvers) -> list[Variant]:
    """Return variants of a vane with a stop up, down, or both."""
    trims = np.array([flight.alpha_trim for flight in flights.flights])
    flown = np.concatenate([flight.outputs["alpha"].y for flight in flights.flights])
    return stops(VANE_STOP, "alpha_sensor", ("vane_stop_up_rad", "vane_stop_down_rad"), trims, flown)


def stops(
    effect: str, block: str, entries: tuple[str, str], trims: FloatArray, flown: FloatArray
) -> list[Variant]:
    """Return stops at the same angles in all manoeuvres, given relative to the median trim.

    ``trims`` has shape (manoeuvres,); ``flown`` holds all commands or readings, rad.
    """
    middle = float(np.median(trims))
    furthest = float(np.max(flown)) - middle, middle - float(np.min(flown))
    up, down = zip(entries, (1.0, -1.0), furthest, strict=True)

    def stopped(
        ways: Sequence[tuple[str, float, float]], p: FloatArray, values: Values, _: PreparedManeuvers
    ) -> None:
        for (entry, sign, _furthest), value in zip(ways, values, strict=True):
            p[:, INDEX[entry]] = np.maximum(value + sign * (middle - trims), _TRIMMED_RAD)

    variants = []
    for ways in ((up, down), (up,), (down,)):
        most = [way[2] for way in ways]
        if min(most) <= _TRIMMED_RAD:
            continue
        variants.append(
            Variant(
                effect, block, tuple(way[0] for way in ways),
                tuple(tuple(x * m for m in most) for x in (0.5, 0.8)),
                (1e-3,) * len(ways), tuple((_TRIMMED_RAD, 1.5 * m) for m in most), 0.0,
                apply_with=partial(stopped, ways),
            )
        )  # fmt: skip
    return variants


def _scale(name: str, block: str, channel: str) -> Variant:
    entries = (f"{channel}_scale",)
    return Variant(name, block, ("scale",), ((0.0,),), (0.002,), ((-0.8, 3.0),), 0.03, entries=entries)


def _curve(name: str, block: str, channel: str, unit: float) -> Variant:
    """Return a reading with linear, quadratic and cubic errors (IEEE Std 1293); ``unit``: typical change."""
    return Variant(
        name, block, ("scale", "square", "cube"), ((0.0, 0.0, 0.0),),
        (0.002, 0.002 / unit, 0.002 / unit**2),
        ((-0.8, 3.0), (-10.0 / unit, 10.0 / unit), (-100.0 / unit**2, 100.0 / unit**2)), 0.0,
        entries=tuple(f"{channel}_{order}" for order in ("scale", "read2", "read3")),
    )  # fmt: skip


def _filter(block: str, channel: str) -> Variant:
    """Return a filter of first or second order in one channel, without compensation."""

    def pass_through(p: FloatArray, values: Values, _: PreparedManeuvers) -> None:
        p[:, [INDEX[name] for name in FILTER]] = (*values, OUTPUTS.index(channel))

    return Variant(
        f"{channel}{_FILTERED}", block, ("lag_s", "shape"), ((0.03, 0.5), (0.08, 0.5), (0.08, 0.05)),
        (5e-4, 0.01), ((0.005, 0.6), (0.0, 1.0)), 0.0, apply_with=pass_through,
    )  # fmt: skip


_PULLED, _RINGS, _RUBS, _FILTERED = "gyro_pulled", "servo_rings", "vane_friction", "_filtered"
_STICKS = "servo_sticks"
_WEAKER = "elevator_loss"
_READINGS = {
    "a_z": (
        _curve("accelerometer_curve", "accelerometer", "a_z", 5.0),
        _filter("accelerometer", "a_z"),
    ),
    "alpha": (
        _curve("alpha_curve", "alpha_sensor", "alpha", 0.05),
        # Dry friction in the vane's bearing, modelled as a play like that of the elevator's linkage.
        Variant(
            _RUBS, "alpha_sensor", ("half_play_rad",), ((0.002,), (0.006,), (0.02,)), (1e-4,),
            ((0.0, 0.1),), 0.00087, entries=("vane_play_rad",),
        ),
    ),
    "theta": (_scale("attitude_scale", "attitude_sensor", "theta"), _filter("attitude_sensor", "theta")),
    "q": (
        _filter("pitch_rate_sensor", "q"),
        # IEEE Std 1431: drift proportional to acceleration, and to its square.
        Variant(
            _PULLED, "pitch_rate_sensor", ("per_m_s2", "per_m_s2_squared"), ((0.0, 0.0),), (1e-4, 1e-5),
            ((-0.1, 0.1), (-0.02, 0.02)), 0.0, entries=("q_pull", "q_pull2"),
        ),
    ),
}  # fmt: skip


def _terms(
    name: str, block: str, entries: tuple[str, str], steps: tuple[float, float], most: tuple[float, float]
) -> Variant:
    """Return two terms of an equation, each within ``most`` of zero."""
    bounds = tuple((-furthest, furthest) for furthest in most)
    return Variant(name, block, entries, ((0.0, 0.0),), steps, bounds, 0.0, entries=entries)


_EQUATIONS = (
    _terms("damping_curve", "moment_equation", ("M_q_abs", "M_q_q"), (0.05, 0.1), (50.0, 200.0)),
    _terms("crossed_moment", "moment_equation", ("M_alpha_q", "M_alpha_delta_e"), (0.5, 1.0), (300.0, 2e3)),
    _terms("lift_of_turning", "force_equation", ("Z_q_abs", "Z_q_q"), (0.005, 0.01), (5.0, 20.0)),
)


def _rings(p: FloatArray, values: Values, _: PreparedManeuvers) -> None:
    """Replace the file's servo lag by a second-order servo, whose delay is 2ζ/ω."""
    omega, damping = values
    p[:, INDEX["lag_s"]], p[:, INDEX["lag_damping"]] = 2.0 * damping / omega, damping


RINGING = Variant(
    _RINGS, "input", ("omega_rad_s", "damping"),
    tuple((2.0 * np.pi * hz, 0.2) for hz in (1.5, 2.1, 3.0, 4.2, 6.0)),
    (0.05, 0.01), ((4.0, 80.0), (0.02, 0.45)), 0.0, apply_with=_rings,
)  # fmt: skip
_SENTENCES = {
    "accelerometer_curve": "The accelerometer is not linear: it clips, rectifies or bends.",
    "alpha_curve": "The measured angle of attack is not linear: its vane bends, rubs or meets a stop.",
    "attitude_scale": "The measured attitude differs from the integrated pitch rate by {percent:+.1f} %.",
    _RUBS: "The vane's bearing rubs: the air turns by {degrees} deg before it follows.",
    VANE_STOP: "The vane turns {degrees} deg from its trim and no further: it meets a stop.",
    SURFACE_STOP: "The surface stops before the command does: it moves {degrees} deg from its trim and no "
    "further.",
    _STICKS: "The surface sticks till the command is {degrees_first} deg away, then breaks loose: friction.",
    _RINGS: "The surface overshoots its command: a servo of second order that is hardly damped.",
    FLOW_LETS_GO: "The flow separates at one angle and reattaches at a lower one: a stall with hysteresis.",
    LIFT_MEMORY: "The lift differs between rising and falling angle of attack: a stall with hysteresis.",
    _WEAKER: "In flight the elevator's power changed by {percent:+.0f} %: a horn slipped, or a part is gone.",
    _PULLED: "The acceleration disturbs the measured pitch rate.",
    **{
        f"{channel}{_FILTERED}": f"{what} passes a filter: it is {{ms:.0f}} ms late, and rounded."
        for channel, what in (("q", "The pitch rate"), ("a_z", "The acceleration"), ("theta", "The attitude"))
    },
    "damping_curve": "The damping in pitch is not the same up and down, or fast and slow.",
    "lift_of_turning": "The lift is not linear in the pitch rate.",
    "crossed_moment": "The damping in pitch or the power of the elevator changes with the angle of attack.",
}


def sticking(most: float) -> Variant:
    """Return a surface that dry friction holds until the command has moved far enough away.

    ``most`` is the largest change of the command, rad.
    """
    return Variant(
        _STICKS, "input", ("breakaway_rad", "sliding_share", "loop_s"),
        tuple((share * most, 0.3, 0.03) for share in (0.15, 0.3, 0.45, 0.6)), (0.01 * most, 0.02, 2e-3),
        ((0.02 * most, 1.2 * most), (0.0, 0.8), (0.001, 0.3)), 0.00175,
        entries=("breakaway_rad", "sliding_share", "loop_s"),
        sides=("play_side", tuple(np.linspace(-1.0, 1.0, 8))), places=("sliding_share", "loop_s"),
    )  # fmt: skip


def _weaker(flights: PreparedManeuvers) -> list[Variant]:
    """Return an elevator that loses power after one manoeuvre, with all other terms unchanged."""
    if len(flights) < 3:
        return []
    columns = [INDEX["Z_delta_e"], INDEX["M_delta_e"]]

    def lose(p: FloatArray, values: Values, share: FloatArray) -> None:
        p[:, columns] *= (1.0 + values[0] * share)[:, None]

    variant = Variant(_WEAKER, "input", ("step",), ((0.0,),), (0.005,), ((-0.9, 2.0),), 0.02)
    return steps_in(flights, variant, lose)


def laws_for(flights: PreparedManeuvers) -> list[Variant]:
    """Return all laws for the readings, the moment, the surface and the lift."""
    readings = [flights.channels[c] for c in flights.telling]
    of_readings = [variant for channel in readings for variant in _READINGS.get(channel, ())]
    of_readings += vane_stops(flights) if "alpha" in readings else []
    of_lift = [lift_memory(flights), flow_lets_go(flights)] if "alpha" in flights.channels else []
    most = float(np.median([np.max(np.abs(flight.u - flight.u_trim)) for flight in flights.flights]))
    of_input = [*surface_stops(flights), RINGING, sticking(most), *_weaker(flights)]
    return [*of_readings, *_EQUATIONS, *of_input, *of_lift]


def sentence_of(law: str, values: FloatArray) -> str:
    """Return a sentence about a law with its parameter values, shape (numbers,)."""
    degrees = " and ".join(f"{np.degrees(value):.1f}" for value in values)
    first = float(values[0])
    return _SENTENCES[law].format(
        percent=100.0 * first, ms=1e3 * first, degrees=degrees, degrees_first=f"{np.degrees(first):.1f}"
    )
