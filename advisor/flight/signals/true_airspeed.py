"""True air speed: logged, or computed from the logged air speed and the air density.

The equations of motion need the true air speed V. An autopilot's pressure sensor gives the speed that its
pressure would have at sea level: V·√(ρ/ρ_0) with ρ_0 = 1.225 kg/m³. The density ρ comes from the static
pressure, else from the height above mean sea level. A barometer's temperature is not used, because the board
warms the sensor. One simulated autopilot reports 30 °C, with which V would be 3.5 % too large.

The standard atmosphere holds below 11 km (ISO 2533).
"""

from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from advisor.flight.signals.channels import GIVEN_AIRSPEED, TRUE_AIRSPEED
from advisor.flight.signals.record import Channel
from advisor.process.arrays import FloatArray

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
"""Plausible range of a channel below the tropopause, Pa or m. A value of zero indicates a missing sensor."""


def standard_pressure(height_m: float | FloatArray) -> FloatArray:
    """Return the pressure in Pa at heights above mean sea level, below 11 km."""
    return np.asarray(_SEA_LEVEL_PA * (1.0 - _LAPSE_K_M * height_m / _SEA_LEVEL_K) ** (_EXPONENT + 1.0))


def standard_density(pressure_pa: float | FloatArray) -> FloatArray:
    """Return the density in kg/m³ at pressures in Pa, below 11 km."""
    return np.asarray(
        SEA_LEVEL_DENSITY_KG_M3 * (pressure_pa / _SEA_LEVEL_PA) ** (_EXPONENT / (_EXPONENT + 1.0))
    )


def standard_height(density_kg_m3: float | FloatArray) -> FloatArray:
    """Return the height in m, below 11 km, with this density in the standard atmosphere."""
    ratio = np.asarray(density_kg_m3) / SEA_LEVEL_DENSITY_KG_M3
    return np.asarray(_SEA_LEVEL_K / _LAPSE_K_M * (1.0 - ratio ** (1.0 / _EXPONENT)))


def density(pressure_pa: float | FloatArray, temperature_c: float | None) -> FloatArray:
    """Return the density of dry air in kg/m³, at the standard temperature if none is known."""
    if temperature_c is None:
        return standard_density(pressure_pa)
    return np.asarray(pressure_pa / (_GAS_CONSTANT * (temperature_c + _CELSIUS_K)))


BY_PRESSURE = ", true by the static pressure"
"""End of the source name of an air speed corrected to true by the static pressure."""
AS_REPORTED = ", true as reported"
"""End of the source name of an air speed that a simulator reports as true."""
AS_GROUND_SPEED = ", equal to the ground speed"
"""End of the source name of an air speed that equals the ground speed in every sample. A ground speed is not
based on pressure, so it needs no density correction."""
BY_HEIGHT = ", true by the height"
"""End of the source name of an air speed corrected to true by the height."""


def is_true(airspeed: Channel) -> bool:
    """Return whether an air speed is true. An air speed that stays as logged may be indicated."""
    source = airspeed.source
    return source in (GIVEN_AIRSPEED, TRUE_AIRSPEED) or source.endswith(
        (BY_PRESSURE, BY_HEIGHT, AS_REPORTED, AS_GROUND_SPEED)
    )


def true_airspeed(
    logged: Channel, pressure: Channel | None, altitude: Channel | None, temperature_c: float | None
) -> Channel:
    """Return the true air speed for a logged air speed; unchanged without a density.

    Parameters
    ----------
    logged
        Logged air speed, m/s.
    pressure, altitude
        Static pressure in Pa, and height above mean sea level in m, around that time; None if missing.
    temperature_c
        Air temperature from the aircraft file, deg C; None for the standard atmosphere.
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
    """Return the mean factor from the read to the true air speed; 1 without an air speed.

    A crew states a reference speed as its instrument reads it.
    """
    gains = [channels["airspeed"].gain for channels in records if "airspeed" in channels]
    return float(np.mean(gains)) if gains else 1.0


def _plausible(channel: Channel | None) -> Channel | None:
    """Return the samples within the plausible range of an atmosphere; None without any."""
    if channel is None:
        return None
    low, high = PLAUSIBLE[channel.name]
    good = (channel.y >= low) & (channel.y <= high)
    # A log without the height above sea level has zeros in its place.
    good &= channel.y != 0.0
    return replace(channel, t=channel.t[good], y=channel.y[good]) if good.any() else None
