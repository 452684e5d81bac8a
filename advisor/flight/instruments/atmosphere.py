"""Air of the manoeuvres: density, true air speed and dynamic pressure.

An autopilot reports the air speed that its pressure sensor would have at sea level (MAVLink, VFR_HUD:
calibrated or indicated). With air density ρ and ρ_0 = 1.225 kg/m³, the true air speed is V·√(ρ_0/ρ). The
dynamic pressure is ½·ρ_0·V² for an indicated air speed, and ½·ρ·V² for a true air speed.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt
from typing import Literal

import numpy as np

from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.channels import GIVEN_AIRSPEED, TRUE_AIRSPEED
from advisor.flight.signals.record import Channel
from advisor.flight.signals.track import (
    AS_GROUND_SPEED,
    AS_REPORTED,
    BY_HEIGHT,
    BY_PRESSURE,
    PLAUSIBLE,
    SEA_LEVEL_DENSITY_KG_M3,
    density,
    is_true,
    standard_height,
    standard_pressure,
    true_over_read,
)

DensitySource = Literal[
    "pressure and temperature", "height and temperature", "pressure", "height", "sea level"
]


@dataclass(frozen=True, slots=True)
class AirData:
    """Mean density of the air of several manoeuvres, and the kind of their air speed."""

    density_kg_m3: float
    source: DensitySource
    """Source of the air density. Without a temperature the density is that of the standard atmosphere."""
    speed_kind: Literal["indicated", "true"]
    """Kind of the manoeuvres' air speed, indicated or true. An indicated air speed is converted to the true
    one as far as the log allows."""
    speed_said: str = "the air speed is as logged"
    """Origin of the air speed in words."""
    true_over_read: float = 1.0
    """Ratio of the manoeuvres' air speed to the air speed that the aircraft reads."""
    excess: float = 0.0
    """Relative excess of the true air speed over the manoeuvres' air speed, from a fit of the motion."""

    def true_speed(self, airspeed_m_s: float) -> float:
        """Return the true air speed in m/s for an air speed of the manoeuvres."""
        speed = airspeed_m_s * (1.0 + self.excess)
        if self.speed_kind == "true":
            return speed
        return speed * sqrt(SEA_LEVEL_DENSITY_KG_M3 / self.density_kg_m3)

    def dynamic_pressure(self, airspeed_m_s: float) -> float:
        """Return the dynamic pressure in Pa for an air speed of the manoeuvres."""
        return 0.5 * self.density_kg_m3 * self.true_speed(airspeed_m_s) ** 2

    def read_speed(self, airspeed_m_s: float) -> float:
        """Return the air speed that the aircraft reads, m/s, for an air speed of the manoeuvres."""
        return airspeed_m_s / self.true_over_read

    @property
    def height_m(self) -> float | None:
        """Height at which the standard atmosphere has the density, m; None for an unknown density."""
        return None if self.source == "sea level" else float(standard_height(self.density_kg_m3))

    @property
    def speed_note(self) -> str:
        """Sentence about the ratio of the true air speed to the air speed that the aircraft reads."""
        ratio = self.true_over_read * self.true_speed(1.0)
        shown = f", {100.0 * self.excess:+.1f} % of it by the motion" if self.excess else ""
        return f"True air speed is {ratio:.4f} times the one that the aircraft reads{shown}."

    @property
    def sentence(self) -> str:
        """Sentence about the sources of density and air speed."""
        origin = {
            "pressure and temperature": "from static pressure and the aircraft file's temperature",
            "height and temperature": "from the height flown and the aircraft file's temperature",
            "pressure": "of the standard atmosphere at the measured static pressure",
            "height": "of the standard atmosphere at the height flown",
            "sea level": "of the standard atmosphere at sea level, because no pressure or height is logged",
        }[self.source]
        return f"air density {self.density_kg_m3:.3f} kg/m³ {origin}; {self.speed_said}"


def air_flown(maneuvers: Sequence[Maneuver], temperature_c: float | None = None) -> AirData:
    """Return the mean air of the manoeuvres, from static pressure, else from height, else at sea level.

    Parameters
    ----------
    maneuvers
        Manoeuvres with channels ``static_pressure`` (Pa), ``altitude`` (m above mean sea level) and
        ``airspeed``, if logged.
    temperature_c
        Air temperature, deg C; None for the standard atmosphere. A barometer's temperature is not used,
        because the board warms the sensor.
    """
    measured, altitude = _mean(maneuvers, "static_pressure"), _mean(maneuvers, "altitude")
    speeds = [m.channels["airspeed"] for m in maneuvers if "airspeed" in m.channels]
    kind: Literal["indicated", "true"] = "true" if speeds and all(map(is_true, speeds)) else "indicated"
    said, gain = _speed_said(speeds), true_over_read(m.channels for m in maneuvers)
    if measured is not None:
        pressure, source = measured, "pressure"
    elif altitude is not None and altitude != 0.0:
        pressure, source = float(standard_pressure(altitude)), "height"
    else:
        return AirData(SEA_LEVEL_DENSITY_KG_M3, "sea level", kind, said, gain)
    if temperature_c is not None:
        source = f"{source} and temperature"
    return AirData(float(density(pressure, temperature_c)), source, kind, said, gain)  # type: ignore[arg-type]


def _speed_said(speeds: Sequence[Channel]) -> str:
    """Return the origin of the air speed in words, from its first channel."""
    if not speeds:
        return "no air speed is known"
    source = speeds[0].source
    if source == GIVEN_AIRSPEED:
        return "the aircraft file's air speed counts as true"
    if source.endswith(AS_REPORTED):
        return "the simulated aircraft reports its true air speed"
    if source == TRUE_AIRSPEED:
        return "the log itself holds the true air speed"
    if source.endswith(AS_GROUND_SPEED):
        return "the logged air speed equals the ground speed and counts as true"
    if source.endswith(BY_PRESSURE):
        return "the static pressure makes the logged air speed true"
    if source.endswith(BY_HEIGHT):
        return "the height flown makes the logged air speed true"
    return "the air speed is used as logged"


def _mean(maneuvers: Sequence[Maneuver], name: str) -> float | None:
    """Return the mean of a channel over manoeuvres with plausible values; None without such a manoeuvre."""
    low, high = PLAUSIBLE[name]
    means = [float(np.mean(m.channels[name].y)) for m in maneuvers if name in m.channels]
    real = [mean for mean in means if low <= mean <= high]
    return float(np.mean(real)) if real else None
