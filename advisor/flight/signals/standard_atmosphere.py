"""Pressure and density of the standard atmosphere below 11 km (ISO 2533), and the density of a gas."""

import numpy as np

from advisor.flight.signals.messages import FloatArray

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
    """Return the density in kg/m³ of dry air; at the standard atmosphere's temperature where none is
    known."""
    if temperature_c is None:
        return standard_density(pressure_pa)
    return np.asarray(pressure_pa / (_GAS_CONSTANT * (temperature_c + _CELSIUS_K)))
