"""Whether a log's air speed is an indicated or a true one, where the motion contradicts the convention.

MAVLink's VFR_HUD shows an indicated or calibrated air speed, so every log's speed is made true with the
density. Simulators often log the true one there, and some loggers say true and log the indicated one. At the
wrong one of the two, a user's simulator has other forces: by 13 % at 1,200 m. Curvature of the flight path
and accelerometer show the true air speed: V·(q − α̇) is the specific force across the path.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import log, sqrt

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.instruments.atmosphere import air_flown
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.true_airspeed import SEA_LEVEL_DENSITY_KG_M3
from advisor.gap.candidates.nuisances import TRUE_AIR_SPEED
from advisor.gap.records.airspeed import measures_speed
from advisor.gap.records.prepare import prepare
from advisor.gap.records.unmeasured_alpha import alpha_by_motion
from advisor.gap.search.baseline import fit_unfiltered
from advisor.gap.uncatalogued.airspeed_scale import airspeed_scale_of
from advisor.words.quantiles import NORMAL_95

_ODDS = 10.0
"""Prior odds that a log follows MAVLink's convention: one log in ten is thought to break it."""
_MATTERS = 0.02
"""Least relative difference between true and indicated air speed that is examined: that at 400 m. A static
port is as wrong (the prior of ``TRUE_AIR_SPEED``)."""


@dataclass(frozen=True)
class SpeedKind:
    """Manoeuvres with the air speed that the motion shows, and a sentence where that is another kind."""

    maneuvers: list[Maneuver]
    note: str = ""


def by_the_motion(maneuvers: Sequence[Maneuver], aircraft: Aircraft) -> SpeedKind:
    """Return the manoeuvres with the kind of air speed, indicated or true, that fits the motion better."""
    unchanged = SpeedKind(list(maneuvers))
    if not maneuvers or not all(map(measures_speed, maneuvers)):
        return unchanged
    factor = _other_kind(maneuvers, aircraft)
    if abs(factor - 1.0) < _MATTERS:
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
        f"The motion shows an air speed {100.0 * shown.scale:+.1f} ± {half:.1f} % off the one in use. So the"
        f" log's air speed is {kind} one, and the simulator flies at {100.0 * factor:.1f} % of the speed in"
        " use."
    )
    return SpeedKind([_at(m, factor) for m in maneuvers], note)


def _other_kind(maneuvers: Sequence[Maneuver], aircraft: Aircraft) -> float:
    """Return the factor from the air speed in use to that of the other kind; 1 in air of unknown density."""
    air = air_flown(maneuvers, aircraft.reference.air_temperature_c)
    if air.source == "sea level":
        return 1.0
    thin = sqrt(SEA_LEVEL_DENSITY_KG_M3 / air.density_kg_m3)
    is_made_true = any(m.channels["airspeed"].gain != 1.0 for m in maneuvers)
    return 1.0 / thin if is_made_true else thin


def _is_likelier(scale: float, std: float, other: float) -> bool:
    """Return whether a measured relative excess is likelier under the other kind, despite its prior."""
    spread = TRUE_AIR_SPEED.prior_std[0] ** 2 + std**2
    return scale**2 - (scale - other) ** 2 > 2.0 * spread * log(_ODDS)


def _at(maneuver: Maneuver, factor: float) -> Maneuver:
    speed = maneuver.channels["airspeed"]
    changed = replace(speed, y=factor * speed.y, gain=factor * speed.gain)
    return replace(maneuver, channels={**maneuver.channels, "airspeed": changed})
