"""Air in which a simulator flies a manoeuvre: its density and its wind.

A simulator computes forces with the true air speed V and the density ρ of its own standard atmosphere. Two
numbers therefore give the flight's dynamic pressure ½·ρ·V² in the simulator. The first number is the true air
speed. The second number is the height at which the standard atmosphere has the flight's density.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.instruments.atmosphere import air_flown
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.simulators.protocol import Simulator
from advisor.words.problems import UnusableInputError


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
