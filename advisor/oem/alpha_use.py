"""Use of a measured angle of attack, or its replacement by an angle from the motion.

Most small aircraft have no vane. With pitch rate, specific force, attitude and air speed, the angle of attack
is a state without a measurement. An autopilot's derived angle of attack is used only if the kinematics
support it (``advisor.flight.instruments.kinematics``).
"""

from collections.abc import Mapping, Sequence

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.instruments.kinematics import check_alpha, combine
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.derived_alpha import DERIVED_ALPHA, NEEDED, inferred_alpha
from advisor.flight.signals.record import Channel

FEWEST_SAMPLES = 20
"""Least number of samples with which a channel of a manoeuvre is used."""


def has(channels: Mapping[str, Channel], name: str) -> bool:
    """Return whether a channel has enough samples for an estimate."""
    return name in channels and int(np.count_nonzero(np.isfinite(channels[name].y))) >= FEWEST_SAMPLES


def lacking(maneuver: Maneuver, aircraft: Aircraft) -> tuple[str, ...]:
    """Return the missing channels without which the motion cannot replace an angle of attack."""
    absent = [name for name in NEEDED if not has(maneuver.channels, name)]
    airspeed = maneuver.channels.get("airspeed")
    measured = airspeed is not None and len(airspeed) > 1 and float(np.min(airspeed.y)) > 0.0
    if not measured and aircraft.airspeed_m_s is None:
        absent.append("airspeed")
    return tuple(absent)


def can_do_without(maneuver: Maneuver, aircraft: Aircraft) -> bool:
    """Return whether the motion can replace an angle of attack."""
    return not lacking(maneuver, aircraft)


def why_not_measured(maneuvers: Sequence[Maneuver], aircraft: Aircraft) -> str:
    """Return the clause that says why these manoeuvres have no measured angle of attack; else empty."""
    if aircraft.alpha.source == "none":
        return "alpha is left out, as the aircraft file asks"
    if not all(has(m.channels, "alpha") for m in maneuvers):
        return "no alpha was measured"
    if all(m.channels["alpha"].source == DERIVED_ALPHA for m in maneuvers):
        return "alpha derived from the climb rate is left out: a_z and the pitch rate hold more information"
    return ""


def why_left_out(maneuvers: Sequence[Maneuver], aircraft: Aircraft) -> str:
    """Return the clause that says why no measured angle of attack is used; else empty."""
    if why := why_not_measured(maneuvers, aircraft):
        return why
    check = combine(
        [
            check_alpha(m, aircraft.airspeed_m_s, aircraft.accelerometer.arm_m, aircraft.alpha.vane_arm_m)
            for m in maneuvers
        ]
    )
    if check.finding != "inconsistent":
        return ""
    return f"alpha is left out: the motion explains {100.0 * max(check.explained, 0.0):.0f} % of it"


def infer(maneuver: Maneuver, aircraft: Aircraft) -> Channel:
    """Return the angle of attack that the motion implies, for a manoeuvre without a usable measurement.

    Raises
    ------
    ValueError
        The manoeuvre lacks a required channel (``lacking``).
    """
    airspeed, t = maneuver.channels.get("airspeed"), maneuver.channels["q"].t
    if airspeed is not None and len(airspeed) > 1:
        speed = np.interp(t, airspeed.t, airspeed.y)
    else:
        speed = np.full(len(t), aircraft.airspeed_m_s or np.nan)
    alpha = inferred_alpha(maneuver.channels, speed)
    if alpha is None:
        raise ValueError("the motion cannot replace the angle of attack")
    return alpha
