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
_LAPSE_K_M = 0.0065
_EXPONENT = 4.255876
"""g/(R·lapse) - 1 of the standard atmosphere below 11 km."""
_GAS_CONSTANT = 287.05287
"""Of dry air, J/(kg·K)."""

DensitySource = Literal["pressure", "height", "sea level"]


@dataclass(frozen=True, slots=True)
class AirFlown:
    """Density and air speed of the air in which manoeuvres were flown."""

    density_kg_m3: float
    source: DensitySource
    """What tells the density: static pressure and temperature, height in the standard atmosphere, nothing."""
    speed_kind: Literal["indicated", "true"]
    """What the log's air speed is; one from the aircraft file counts as true."""

    def true_speed(self, airspeed_m_s: float) -> float:
        """True air speed in m/s for an air speed as the log gives it."""
        if self.speed_kind == "true":
            return airspeed_m_s
        return airspeed_m_s * sqrt(SEA_LEVEL_DENSITY_KG_M3 / self.density_kg_m3)

    @property
    def sentence(self) -> str:
        """Where density and air speed come from, for people."""
        told = {
            "pressure": "from static pressure and the temperature at its sensor",
            "height": "of the standard atmosphere at the height flown",
            "sea level": "of the standard atmosphere at sea level, for neither pressure nor height is logged",
        }[self.source]
        kind = {
            "indicated": "the logged air speed counts as indicated",
            "true": "the aircraft file's air speed counts as true",
        }[self.speed_kind]
        return f"air density {self.density_kg_m3:.3f} kg/m³ {told}; {kind}"


def standard_density(height_m: float) -> float:
    """Density of the standard atmosphere in kg/m³ at a height above mean sea level, below 11 km."""
    return float(SEA_LEVEL_DENSITY_KG_M3 * (1.0 - _LAPSE_K_M * height_m / _SEA_LEVEL_K) ** _EXPONENT)


def air_flown(maneuvers: Sequence[Maneuver]) -> AirFlown:
    """Mean air of manoeuvres: from pressure and temperature, else from height, else at sea level.

    Parameters
    ----------
    maneuvers
        Their channels ``static_pressure`` (Pa), ``air_temperature`` (K), ``altitude`` (m above mean sea
        level) and ``airspeed`` are used, as far as the log has them.
    """
    pressure, temperature, altitude = (
        _mean(maneuvers, name) for name in ("static_pressure", "air_temperature", "altitude")
    )
    given = any(
        m.channels["airspeed"].source == GIVEN_AIRSPEED for m in maneuvers if "airspeed" in m.channels
    )
    kind: Literal["indicated", "true"] = "true" if given else "indicated"
    if pressure is not None and temperature is not None:
        return AirFlown(pressure / (_GAS_CONSTANT * temperature), "pressure", kind)
    if altitude is not None:
        return AirFlown(standard_density(altitude), "height", kind)
    return AirFlown(SEA_LEVEL_DENSITY_KG_M3, "sea level", kind)


def _mean(maneuvers: Sequence[Maneuver], name: str) -> float | None:
    """Mean of a channel over the manoeuvres that have the channel with values of real air; None without."""
    low, high = _REAL[name]
    means = [float(np.mean(m.channels[name].y)) for m in maneuvers if name in m.channels]
    real = [mean for mean in means if low <= mean <= high]
    return float(np.mean(real)) if real else None


_REAL = {
    "static_pressure": (2e4, 1.1e5),
    "air_temperature": (190.0, 340.0),
    "altitude": (-500.0, 11_000.0),
}
"""What can be: below the tropopause, from the coldest air to a sensor in the sun. Zero is a sensor that is
not there."""
