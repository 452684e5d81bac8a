"""The air that a manoeuvre was flown in: density, and what the air speed becomes by it.

An autopilot reports the air speed that its pressure sensor would have at sea level (MAVLink, VFR_HUD:
calibrated or indicated). With the density ρ of the air flown in and ρ_0 = 1.225 kg/m³ the true air speed is
V·√(ρ_0/ρ), while the dynamic pressure is ½·ρ_0·V² whatever the height.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt
from typing import Literal

import numpy as np

from advisor.flight.channels import GIVEN_AIRSPEED
from advisor.flight.maneuver import Maneuver

SEA_LEVEL_DENSITY_KG_M3 = 1.225
"""International Standard Atmosphere (ISO 2533)."""
_SEA_LEVEL_K = 288.15
_SEA_LEVEL_PA = 101_325.0
_CELSIUS_K = 273.15
_LAPSE_K_M = 0.0065
_EXPONENT = 4.255876
"""g/(R·lapse) - 1 of the standard atmosphere below 11 km."""
_GAS_CONSTANT = 287.05287
"""Of dry air, J/(kg·K)."""

DensitySource = Literal[
    "pressure and temperature", "height and temperature", "pressure", "height", "sea level"
]


@dataclass(frozen=True, slots=True)
class AirFlown:
    """Density and air speed of the air in which manoeuvres were flown."""

    density_kg_m3: float
    source: DensitySource
    """What tells the density; without a temperature the standard atmosphere's is taken."""
    speed_kind: Literal["indicated", "true"]
    """What the log's air speed is; one from the aircraft file counts as true."""

    def true_speed(self, airspeed_m_s: float) -> float:
        """Return the true air speed in m/s for an air speed as the log gives it."""
        if self.speed_kind == "true":
            return airspeed_m_s
        return airspeed_m_s * sqrt(SEA_LEVEL_DENSITY_KG_M3 / self.density_kg_m3)

    @property
    def sentence(self) -> str:
        """Where density and air speed come from, for people."""
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
    """Return the density of the standard atmosphere in kg/m³ where the pressure is this, below 11 km."""
    return float(SEA_LEVEL_DENSITY_KG_M3 * (pressure_pa / _SEA_LEVEL_PA) ** (_EXPONENT / (_EXPONENT + 1.0)))


def air_flown(maneuvers: Sequence[Maneuver], temperature_c: float | None = None) -> AirFlown:
    """Return the mean air of manoeuvres: from static pressure, else from height, else that at sea level.

    Parameters
    ----------
    maneuvers
        Their channels ``static_pressure`` (Pa), ``altitude`` (m above mean sea level) and ``airspeed`` are
        used, as far as the log has them.
    temperature_c
        Temperature of the air. The one that a barometer reports is not used: the board warms the sensor.
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
    """Return the mean of a channel over the manoeuvres that have the channel with values of real air; None
    without."""
    low, high = _REAL[name]
    means = [float(np.mean(m.channels[name].y)) for m in maneuvers if name in m.channels]
    real = [mean for mean in means if low <= mean <= high]
    return float(np.mean(real)) if real else None


_REAL = {"static_pressure": (2.2e4, 1.1e5), "altitude": (-500.0, 11_000.0)}
"""What can be below the tropopause. Zero is a sensor that is not there."""
