"""Air in which a simulator flies a manoeuvre: its density and its wind.

A simulator computes forces with the true air speed V and the density ρ of its own standard atmosphere. Two
numbers therefore give the flight's dynamic pressure ½·ρ·V² in the simulator. The first number is the true air
speed. The second number is the height at which the standard atmosphere has the flight's density.

MAVLink's VFR_HUD carries an indicated or calibrated air speed, so a log's speed is corrected with the
density. Simulators often log the true air speed there, and some loggers label an indicated one as true. With
the wrong kind, a user's simulator has forces wrong by 13 % at 1,200 m. The flight path's curvature and the
accelerometer show the true air speed, because V·(q − α̇) is the specific force.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import log, sqrt

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.instruments.atmosphere import air_flown
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.track import SEA_LEVEL_DENSITY_KG_M3
from advisor.gap.candidates.known import STATIC_PORT
from advisor.gap.records.airspeed import measures_speed
from advisor.gap.records.prepare import prepare
from advisor.gap.records.unmeasured_alpha import alpha_by_motion
from advisor.gap.search.baseline import fit_unfiltered
from advisor.gap.uncatalogued.weight_check import airspeed_scale_of
from advisor.simulators.protocol import Simulator
from advisor.words.problems import UnusableInputError
from advisor.words.quantities import NORMAL_95

_ODDS = 10.0
"""Prior odds that a log follows MAVLink's convention."""


@dataclass(frozen=True)
class SpeedKind:
    """Manoeuvres with the kind of air speed that fits the motion, and a sentence about a changed kind."""

    maneuvers: list[Maneuver]
    note: str = ""


def by_the_motion(maneuvers: Sequence[Maneuver], aircraft: Aircraft) -> SpeedKind:
    """Return the manoeuvres with the kind of air speed, indicated or true, that fits the motion better."""
    unchanged = SpeedKind(list(maneuvers))
    if not maneuvers or not all(map(measures_speed, maneuvers)):
        return unchanged
    factor = _other_kind(maneuvers, aircraft)
    if abs(factor - 1.0) < STATIC_PORT:
        return unchanged
    unmodelled = replace(aircraft, model={}, effects={}, simulator=None)
    flights = prepare(alpha_by_motion(maneuvers, unmodelled), unmodelled)
    if not {"alpha", "a_z"} <= set(flights.channels):
        return unchanged
    # The curvature of the path depends neither on the reading of the command nor on a filter of the noise.
    shown = airspeed_scale_of(*fit_unfiltered(flights, unmodelled))
    if shown is None or not _is_likelier(shown.scale, shown.std, factor - 1.0):
        return unchanged
    kind = "a true" if factor < 1.0 else "an indicated"
    half = 100.0 * NORMAL_95 * shown.std
    note = (
        f"The motion shows an air speed {100.0 * shown.scale:+.1f} ± {half:.1f} % off the used one. So the"
        f" log's air speed is {kind} one, and the simulator flies at {100.0 * factor:.1f} % of the speed in"
        " use."
    )
    return SpeedKind([_at(m, factor) for m in maneuvers], note)


def _other_kind(maneuvers: Sequence[Maneuver], aircraft: Aircraft) -> float:
    """Return the factor from the used air speed to the other kind's; 1 for an unknown density."""
    air = air_flown(maneuvers, aircraft.reference.air_temperature_c)
    if air.source == "sea level":
        return 1.0
    thin = sqrt(SEA_LEVEL_DENSITY_KG_M3 / air.density_kg_m3)
    is_made_true = any(m.channels["airspeed"].gain != 1.0 for m in maneuvers)
    return 1.0 / thin if is_made_true else thin


def _is_likelier(scale: float, std: float, other: float) -> bool:
    """Return whether a measured relative excess is likelier under the other kind, despite its prior."""
    spread = STATIC_PORT**2 + std**2
    return scale**2 - (scale - other) ** 2 > 2.0 * spread * log(_ODDS)


def _at(maneuver: Maneuver, factor: float) -> Maneuver:
    speed = maneuver.channels["airspeed"]
    changed = replace(speed, y=factor * speed.y, gain=factor * speed.gain)
    return replace(maneuver, channels={**maneuver.channels, "airspeed": changed})


def standard_heights(maneuvers: Sequence[Maneuver], aircraft: Aircraft) -> Mapping[int, float | None]:
    """Return the height in the standard atmosphere with each manoeuvre's density, m, by manoeuvre number.

    None for a manoeuvre with neither static pressure nor height above mean sea level.
    """
    temperature_c = aircraft.reference.air_temperature_c
    return {m.number: air_flown([m], temperature_c).height_m for m in maneuvers}


def winds(maneuvers: Sequence[Maneuver]) -> Mapping[int, tuple[float, float]]:
    """Return the mean wind along and right of the heading before the first step, m/s, by manoeuvre number.

    An autopilot's wind estimate also responds to sideslip and air speed, so its change within a manoeuvre is
    not used. Manoeuvres without a wind estimate are missing.
    """
    winds_by_number = {}
    for maneuver in maneuvers:
        along, right = (maneuver.channels.get(name) for name in ("wind_along", "wind_right"))
        if along is None or right is None:
            continue
        n = max(int(np.searchsorted(along.t, maneuver.span.start_s)), 1)
        winds_by_number[maneuver.number] = (float(np.mean(along.y[:n])), float(np.mean(right.y[:n])))
    return winds_by_number


def still_air_said(simulator: Simulator, winds: Mapping[int, tuple[float, float]]) -> tuple[str, ...]:
    """Return a sentence if a simulator could use a wind but the log has no wind."""
    if winds or "wind" not in simulator.takes:
        return ()
    return (f"The log has no estimate of the wind: {simulator.description} flies in still air.",)


def refuse_unknown_air(description: str, heights_m: Mapping[int, float | None]) -> None:
    """Refuse manoeuvres in air of unknown density, in which a simulator would fly with other forces.

    Raises
    ------
    UnusableInputError
        The height of a manoeuvre is unknown.
    """
    unknown = [number for number, height in heights_m.items() if height is None]
    if unknown:
        raise UnusableInputError(
            "no_air_density",
            f"{description} needs the density of the air, and the log has neither static pressure nor height "
            f"above sea level in manoeuvre {unknown[0]}.",
            "Give the pressure altitude as reference: {height_m: ...} in the aircraft file, or log "
            "GLOBAL_POSITION_INT or SCALED_PRESSURE.",
        )
