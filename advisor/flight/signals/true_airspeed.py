"""True air speed: logged, or computed from the logged one and the density of the air.

The equations of motion hold with the true air speed V. An autopilot's pressure sensor gives the speed that
its pressure would have at sea level: V·√(ρ/ρ_0) with ρ_0 = 1.225 kg/m³. The density ρ comes from the static
pressure, else from the height above mean sea level. A barometer's temperature is not used, because the board
warms the sensor. One simulated autopilot reports 30 °C, by which V would be 3.5 % too large.

The standard atmosphere holds below 11 km (ISO 2533).
"""

from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from advisor.flight.signals.channels import GIVEN_AIRSPEED, TRUE_AIRSPEED
from advisor.flight.signals.messages import FloatArray
from advisor.flight.signals.record import Channel

SEA_LEVEL_DENSITY_KG_M3 = 1.225
"""Air density at sea level, kg/m³."""
_SEA_LEVEL_K = 288.15
_SEA_LEVEL_PA = 101_325.0
_CELSIUS_K = 273.15
_LAPSE_K_M = 0.0065
_EXPONENT = 4.255876
"""Exponent g/(R·lapse) - 1 of the standard atmosphere below 11 km."""
_GAS_CONSTANT = 287.05287
"""Gas constant of dry air, J/(kg·K)."""
PLAUSIBLE = {"static_pressure": (2.2e4, 1.1e5), "altitude": (-500.0, 11_000.0)}
"""Plausible range of a channel below the tropopause, Pa or m. Zero stands for a missing sensor."""


def standard_pressure(height_m: float | FloatArray) -> FloatArray:
    """Return the pressure in Pa at heights above mean sea level, below 11 km."""
    return np.asarray(_SEA_LEVEL_PA * (1.0 - _LAPSE_K_M * height_m / _SEA_LEVEL_K) ** (_EXPONENT + 1.0))


def standard_density(pressure_pa: float | FloatArray) -> FloatArray:
    """Return the density in kg/m³ at pressures in Pa, below 11 km."""
    return np.asarray(
        SEA_LEVEL_DENSITY_KG_M3 * (pressure_pa / _SEA_LEVEL_PA) ** (_EXPONENT / (_EXPONENT + 1.0))
    )


def standard_height(density_kg_m3: float | FloatArray) -> FloatArray:
    """Return the height in m, below 11 km, at which the standard atmosphere has a density in kg/m³."""
    ratio = np.asarray(density_kg_m3) / SEA_LEVEL_DENSITY_KG_M3
    return np.asarray(_SEA_LEVEL_K / _LAPSE_K_M * (1.0 - ratio ** (1.0 / _EXPONENT)))


def density(pressure_pa: float | FloatArray, temperature_c: float | None) -> FloatArray:
    """Return the density in kg/m³ of dry air; at the standard temperature where none is known."""
    if temperature_c is None:
        return standard_density(pressure_pa)
    return np.asarray(pressure_pa / (_GAS_CONSTANT * (temperature_c + _CELSIUS_K)))


BY_PRESSURE = ", true by the static pressure"
"""End of the source of an air speed that the static pressure has made true."""
AS_REPORTED = ", true as reported"
"""End of the source of an air speed that a simulator reports as the true one."""
AS_GROUND_SPEED = ", equal to the ground speed"
"""End of the source of an air speed that equals the ground speed in every sample. A speed over the ground
comes from no pressure, so that no density corrects this speed."""
BY_HEIGHT = ", true by the height"
"""End of the source of an air speed that the height has made true."""


def is_true(airspeed: Channel) -> bool:
    """Return whether an air speed is true. One that stays as logged may be indicated."""
    source = airspeed.source
    return source in (GIVEN_AIRSPEED, TRUE_AIRSPEED) or source.endswith(
        (BY_PRESSURE, BY_HEIGHT, AS_REPORTED, AS_GROUND_SPEED)
    )


def true_airspeed(
    logged: Channel, pressure: Channel | None, altitude: Channel | None, temperature_c: float | None
) -> Channel:
    """Return the true air speed of a logged one; the logged one where nothing gives the density.

    Parameters
    ----------
    logged
        Air speed, m/s.
    pressure, altitude
        Static pressure in Pa, and height above mean sea level in m, around the same time; None without any.
    temperature_c
        Temperature of the air by the aircraft file, deg C; None: the standard atmosphere's.
    """
    if is_true(logged):
        return logged
    measured, high = _plausible(pressure), _plausible(altitude)
    if measured is not None:
        at, pressure_pa, by = measured.t, measured.y, BY_PRESSURE
    elif high is not None:
        at, pressure_pa, by = high.t, standard_pressure(high.y), BY_HEIGHT
    else:
        return logged
    ratio: FloatArray = np.sqrt(SEA_LEVEL_DENSITY_KG_M3 / density(pressure_pa, temperature_c))
    true = logged.y * np.interp(logged.t, at, ratio)
    return replace(logged, y=true, source=f"{logged.source}{by}", gain=float(np.mean(ratio)))


def true_over_read(records: Iterable[Mapping[str, Channel]]) -> float:
    """Return the mean factor from the air speed as the aircraft reads it to the true one; 1 without any.

    A crew states a reference speed as its instrument reads it.
    """
    gains = [channels["airspeed"].gain for channels in records if "airspeed" in channels]
    return float(np.mean(gains)) if gains else 1.0


def _plausible(channel: Channel | None) -> Channel | None:
    """Return the samples within the range of an atmosphere; None without any."""
    if channel is None:
        return None
    low, high = PLAUSIBLE[channel.name]
    good = (channel.y >= low) & (channel.y <= high)
    # A log without the height above sea level has zeros in its place.
    good &= channel.y != 0.0
    return replace(channel, t=channel.t[good], y=channel.y[good]) if good.any() else None
