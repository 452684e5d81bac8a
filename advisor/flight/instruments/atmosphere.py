"""Air of a manoeuvre: density, and the true air speed from the logged one.

An autopilot reports the air speed that its pressure sensor would have at sea level (MAVLink, VFR_HUD:
calibrated or indicated). With the density ρ of the air flown in and ρ_0 = 1.225 kg/m³, the true air speed is
V·√(ρ_0/ρ). The dynamic pressure is ½·ρ_0·V² at any height.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt
from typing import Literal

import numpy as np

from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.channels import GIVEN_AIRSPEED

SEA_LEVEL_DENSITY_KG_M3 = 1.225
"""Air density at sea level, kg/m³ (International Standard Atmosphere, ISO 2533)."""
_SEA_LEVEL_K = 288.15
_SEA_LEVEL_PA = 101_325.0
_CELSIUS_K = 273.15
_LAPSE_K_M = 0.0065
_EXPONENT = 4.255876
"""Exponent g/(R·lapse) - 1 of the standard atmosphere below 11 km."""
_GAS_CONSTANT = 287.05287
"""Gas constant of dry air, J/(kg·K)."""

DensitySource = Literal[
    "pressure and temperature", "height and temperature", "pressure", "height", "sea level"
]


@dataclass(frozen=True, slots=True)
class AirFlown:
    """Mean density and air speed of the air of several manoeuvres."""

    density_kg_m3: float
    source: DensitySource
    """Source of the density. Without a temperature the standard atmosphere's is used."""
    speed_kind: Literal["indicated", "true"]
    """Kind of the log's air speed. An air speed from the aircraft file counts as true."""

    def true_speed(self, airspeed_m_s: float) -> float:
        """Return the true air speed in m/s for an air speed from the log."""
        if self.speed_kind == "true":
            return airspeed_m_s
        return airspeed_m_s * sqrt(SEA_LEVEL_DENSITY_KG_M3 / self.density_kg_m3)

    @property
    def sentence(self) -> str:
        """Sentence on the sources of density and air speed."""
        told = {
            "pressure and temperature": "from static pressure and the aircraft file's temperature",
            "height and temperature": "from the height flown and the aircraft file's temperature",
            "pressure": "of the standard atmosphere at the static pressure flown in",
            "height": "of the standard atmosphere at the height flown",
            "sea level": "of the standard atmosphere at sea level, for neither pressure nor height is logged",
        }[self.source]
        kind = {
            "indicated": "the logged air speed counts as indicated",
            "true": "the aircraft file's air speed counts as true",
        }[self.speed_kind]
        return f"air density {self.density_kg_m3:.3f} kg/m³ {told}; {kind}"


def standard_pressure(height_m: float) -> float:
    """Return the pressure of the standard atmosphere in Pa at a height above mean sea level, below 11 km."""
    return float(_SEA_LEVEL_PA * (1.0 - _LAPSE_K_M * height_m / _SEA_LEVEL_K) ** (_EXPONENT + 1.0))


def standard_density(pressure_pa: float) -> float:
    """Return the density of the standard atmosphere in kg/m³ at a pressure, below 11 km."""
    return float(SEA_LEVEL_DENSITY_KG_M3 * (pressure_pa / _SEA_LEVEL_PA) ** (_EXPONENT / (_EXPONENT + 1.0)))


def air_flown(maneuvers: Sequence[Maneuver], temperature_c: float | None = None) -> AirFlown:
    """Return the mean air of manoeuvres: from static pressure, else from height, else at sea level.

    Parameters
    ----------
    maneuvers
        Manoeuvres whose channels ``static_pressure`` (Pa), ``altitude`` (m above mean sea level) and
        ``airspeed`` are used, where the log has them.
    temperature_c
        Temperature of the air. A barometer's temperature is not used, because the board warms the sensor.
    """
    measured, altitude = _mean(maneuvers, "static_pressure"), _mean(maneuvers, "altitude")
    given = any(
        m.channels["airspeed"].source == GIVEN_AIRSPEED for m in maneuvers if "airspeed" in m.channels
    )
    kind: Literal["indicated", "true"] = "true" if given else "indicated"
    if measured is not None:
        pressure, source = measured, "pressure"
    elif altitude is not None:
        pressure, source = standard_pressure(altitude), "height"
    else:
        return AirFlown(SEA_LEVEL_DENSITY_KG_M3, "sea level", kind)
    if temperature_c is None:
        return AirFlown(standard_density(pressure), source, kind)  # type: ignore[arg-type]
    density = pressure / (_GAS_CONSTANT * (temperature_c + _CELSIUS_K))
    return AirFlown(density, f"{source} and temperature", kind)  # type: ignore[arg-type]


def _mean(maneuvers: Sequence[Maneuver], name: str) -> float | None:
    """Return the mean of a channel over the manoeuvres with plausible values; None without such a
    manoeuvre."""
    low, high = _REAL[name]
    means = [float(np.mean(m.channels[name].y)) for m in maneuvers if name in m.channels]
    real = [mean for mean in means if low <= mean <= high]
    return float(np.mean(real)) if real else None


_REAL = {"static_pressure": (2.2e4, 1.1e5), "altitude": (-500.0, 11_000.0)}
"""Plausible range of a channel below the tropopause. Zero stands for a missing sensor."""
