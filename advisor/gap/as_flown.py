"""A flight in pitch as the gap reads it: with an angle of attack, and without that angle's offset."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.instruments.kinematics import KinematicCheck, check_alpha, combine
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.gap.inference.offset import is_removed
from advisor.gap.records.airspeed import measures_speed
from advisor.gap.records.prepare import as_stamped
from advisor.gap.records.unmeasured_alpha import alpha_by_motion, is_known
from advisor.gap.records.unmeasured_speed import speed_of_the_motion
from advisor.gap.records.usable import outputs_of, usable_of
from advisor.words.problems import UnusableInputError


@dataclass(frozen=True)
class AsFlown:
    """Manoeuvres that are compared with a simulator."""

    maneuvers: tuple[Maneuver, ...]
    """All manoeuvres, without the offset of the angle of attack."""
    usable: tuple[Maneuver, ...]
    """Those that can be compared."""
    measured: tuple[Maneuver, ...]
    """The usable ones as logged, without the air speed of a dead pitot; empty where an angle of attack was
    not measured."""
    aircraft: Aircraft
    """Aircraft file, with the air speed of the motion where file and log state none."""
    kinematics: KinematicCheck
    """Angle of attack against the motion."""


def as_flown(maneuvers: Sequence[Maneuver], aircraft: Aircraft) -> AsFlown:
    """Return the manoeuvres of a flight as the gap reads them.

    Raises
    ------
    UnusableInputError
        No usable manoeuvre, or no angle of attack.
    """
    stamped = [as_stamped(m) for m in maneuvers]
    aircraft = _with_speed(usable_of(stamped), aircraft)
    stated = aircraft.effects.get("alpha_bias", {}).get("bias_rad", 0.0)
    flown = alpha_by_motion([_without_offset(m, stated) for m in stamped], aircraft)
    usable = usable_of(flown)
    _refuse(usable, flown)
    measured = (
        tuple(map(_without_dead_pitot, usable)) if all("alpha" in outputs_of(m) for m in usable) else ()
    )
    arms = aircraft.accelerometer.arm_m, aircraft.alpha.vane_arm_m
    kinematics = combine([check_alpha(m, aircraft.stated_airspeed_m_s, *arms) for m in measured])
    offset = kinematics.offset.rad if is_removed(kinematics.offset) else 0.0
    flown, usable = ([_without_offset(m, offset) for m in some] for some in (flown, usable))
    return AsFlown(tuple(flown), tuple(usable), measured, aircraft, kinematics)


def _with_speed(maneuvers: Sequence[Maneuver], aircraft: Aircraft) -> Aircraft:
    """Return the aircraft with the air speed that the motion implies, if file and log state none."""
    if aircraft.stated_airspeed_m_s or all(measures_speed(m) for m in maneuvers):
        return aircraft
    return replace(aircraft, airspeed_m_s=speed_of_the_motion(maneuvers))


def _without_offset(maneuver: Maneuver, offset_rad: float) -> Maneuver:
    """Return the manoeuvre with an offset subtracted from its angle of attack."""
    alpha = maneuver.channels.get("alpha")
    if alpha is None or offset_rad == 0.0:
        return maneuver
    return replace(maneuver, channels={**maneuver.channels, "alpha": replace(alpha, y=alpha.y - offset_rad)})


def _without_dead_pitot(maneuver: Maneuver) -> Maneuver:
    """Return the manoeuvre without its air speed channel, if that channel is constant in flight."""
    if measures_speed(maneuver):
        return maneuver
    return replace(maneuver, channels={k: c for k, c in maneuver.channels.items() if k != "airspeed"})


def _refuse(usable: Sequence[Maneuver], flown: Sequence[Maneuver]) -> None:
    if not usable:
        raise UnusableInputError(
            "no_maneuver",
            "No usable manoeuvre in the log: there is nothing to compare a simulator with.",
            "Fly at least three elevator manoeuvres (3-2-1-1 or doublets), better nine.",
        )
    if not is_known(flown):
        raise UnusableInputError(
            "no_alpha",
            "The log has no angle of attack, and the motion cannot replace one without a_z, theta and air "
            "speed.",
            "Log AOA_SSA or RAW_IMU, or set alpha.source in the aircraft file.",
        )
