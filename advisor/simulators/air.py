"""The air in which a simulator flies a manoeuvre.

A simulator computes forces with the true air speed V and the density ρ of its own standard atmosphere. The
dynamic pressure ½·ρ·V² of the flight therefore needs two numbers. One is the true air speed. The other is the
height at which the standard atmosphere has the density flown in.
"""

from collections.abc import Mapping, Sequence

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.instruments.atmosphere import air_flown
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.standard_atmosphere import standard_height
from advisor.words.problems import UnusableInputError


def standard_heights(maneuvers: Sequence[Maneuver], aircraft: Aircraft) -> Mapping[int, float | None]:
    """Return the height in the standard atmosphere with each manoeuvre's density, m, by manoeuvre number.

    None stands for a manoeuvre with neither static pressure nor height above mean sea level.
    """
    found: dict[int, float | None] = {}
    for maneuver in maneuvers:
        air = air_flown([maneuver], aircraft.reference.air_temperature_c)
        known = air.source != "sea level"
        found[maneuver.number] = float(standard_height(air.density_kg_m3)) if known else None
    return found


def refuse_unknown_air(description: str, heights_m: Mapping[int, float | None]) -> None:
    """Refuse manoeuvres in air of unknown density, in which a simulator would fly with other forces.

    Raises
    ------
    UnusableInputError
        A manoeuvre's height is None.
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
