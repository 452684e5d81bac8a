"""Faults of instruments and telemetry, as named in a scenario's section ``faults``."""

from dataclasses import dataclass, field
from typing import Literal

RAD_PER_DEG = 0.017453292519943295

FIELDS: dict[str, tuple[str, tuple[str, ...]]] = {
    "alpha": ("AOA_SSA", ("AOA",)),
    "q": ("ATTITUDE", ("pitchspeed",)),
    "theta": ("ATTITUDE", ("pitch",)),
    "a_z": ("RAW_IMU", ("zacc",)),
    "accelerometer": ("RAW_IMU", ("xacc", "yacc", "zacc")),
    "airspeed": ("VFR_HUD", ("airspeed",)),
}
"""Message and fields that carry each channel, by the channel's name."""

UNITS: dict[str, dict[str, float]] = {
    "alpha": {"rad": RAD_PER_DEG},
    "q": {"deg/s": 1.0 / RAD_PER_DEG},
    "theta": {"deg": 1.0 / RAD_PER_DEG},
    "accelerometer": {"counts": 2.048, "g": 1.0},
    "airspeed": {"knots": 3600.0 / 1852.0},
}
"""Factor from the right unit to each wrong unit, by channel. A count is 1/2048 g. ``g`` needs a message with
decimals, so that HIGHRES_IMU replaces RAW_IMU."""

STAMPED = (
    "ATTITUDE",
    "AOA_SSA",
    "SERVO_OUTPUT_RAW",
    "RAW_IMU",
    "GLOBAL_POSITION_INT",
    "SYSTEM_TIME",
    "RC_CHANNELS",
)
"""Messages with a stamp of the vehicle's clock."""

TROPOSPHERE_M = 11_000.0
"""Greatest height of the standard atmosphere's lowest layer, m."""


@dataclass(frozen=True)
class Filters:
    """Second-order Butterworth low-pass filters of the autopilot. Noise is added after them."""

    gyro_hz: float = 0.0
    """Cut-off of the gyro's filter, Hz, as in INS_GYRO_FILTER; 0 for no filter."""
    accelerometer_hz: float = 0.0
    """Cut-off of the accelerometer's filter, Hz, as in INS_ACCEL_FILTER; 0 for no filter."""
    parameters: Literal["stated", "withheld"] = "stated"
    """Whether the vehicle's parameters state both cut-offs: ``stated`` or ``withheld``."""


@dataclass(frozen=True)
class Faults:
    """Faults of instruments and telemetry in one flight. Without faults, the log does not change by a
    byte."""

    units: dict[str, str] = field(default_factory=dict)
    """Wrong unit of each channel: alpha rad, q deg/s, theta deg, accelerometer counts or g, airspeed
    knots."""
    scale: dict[str, float] = field(default_factory=dict)
    """Factor on each channel's values, by the channel's name; −1 reverses them. ``a_z: -1`` is an
    accelerometer with z up."""
    filters: Filters = field(default_factory=Filters)
    command_late_s: float = 0.0
    """Delay of the command's effect after its SERVO_OUTPUT_RAW stamp, s; −0.010 to 0.010 on real
    autopilots."""
    thin_air_m: float = 0.0
    """Height of the ground above sea level, m. VFR_HUD then shows the indicated air speed, and
    SCALED_PRESSURE follows every GLOBAL_POSITION_INT (standard atmosphere). With 0 VFR_HUD shows the true air
    speed.
    """
    repeated_after_s: float = 0.0
    """Time after which every message is repeated with a new stamp, s; 0 for no repetition."""
    parameters_at_s: float = 0.0
    """Time at which the parameters are sent, s since the log began. ``.inf``: never."""
    clock_lag_s: dict[str, float] = field(default_factory=dict)
    """Delay of each message's stamps behind the vehicle's clock, s, by the message's name."""

    def problems(self, period_s: float) -> list[str]:
        """Return every mistake in the faults, with its path. ``period_s`` is the period of the autopilot's
        loop, s.
        """
        found = [
            f"faults.units.{channel}: '{unit}' is not among the wrong units of this channel: "
            f"{', '.join(UNITS.get(channel, ())) or 'none'}"
            for channel, unit in self.units.items()
            if unit not in UNITS.get(channel, ())
        ]
        found += [
            f"faults.scale.{channel}: unknown channel, choose from {', '.join(FIELDS)}"
            for channel in self.scale
            if channel not in FIELDS
        ]
        found += [
            f"faults.clock_lag_s.{name}: carries no stamp, choose from {', '.join(STAMPED)}"
            for name in self.clock_lag_s
            if name not in STAMPED
        ]
        if not 0.0 <= self.repeated_after_s < period_s:
            found.append("faults.repeated_after_s: must be at least 0 and below one period of loop_hz")
        if not 0.0 <= self.thin_air_m < TROPOSPHERE_M:
            found.append(f"faults.thin_air_m: must be at least 0 and below {TROPOSPHERE_M:.0f}")
        if min(self.filters.gyro_hz, self.filters.accelerometer_hz) < 0.0:
            found.append("faults.filters: a cut-off must be at least 0 Hz")
        return found
