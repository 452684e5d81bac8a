"""Nuisances of every real flight, in a third of the flights: late command, filters, indicated air speed.

An angle of attack that the autopilot makes itself is part of the equipment (``instruments``).
"""

from dataclasses import asdict, dataclass, replace

import numpy as np
from numpy.random import Generator
from scipy.signal import butter, lfilter, lfilter_zi

from benchmarks.sealed.tlog import Stream

from .fleet import Floats
from .flight import STEP_S, Channels

SHARE = 1.0 / 3.0
USUAL_FILTER_HZ = 20.0
"""Cut-off of an autopilot's filters of gyro and accelerometers, Hz."""
_SCALE_HEIGHT_M = 9042.0
"""Height over which the density of the lower troposphere falls by a factor of e, m."""


@dataclass(frozen=True)
class Nature:
    """Nuisances of one flight; the default has none."""

    command_late_s: float = 0.0
    filter_hz: float = 0.0
    """Cut-off of the filters of gyro and accelerometers; 0 without filters."""
    told: bool = False
    """Whether the autopilot's parameters tell the cut-off."""
    pitot: float = 1.0
    """Indicated over true air speed."""

    def parameters(self) -> dict[str, float]:
        """Return the parameters that tell the filters."""
        if not self.told or self.filter_hz == 0.0:
            return {}
        return {"INS_GYRO_FILTER": self.filter_hz, "INS_ACCEL_FILTER": self.filter_hz}

    def measured(self, shown: Channels) -> Channels:
        """Return the channels behind the filters, with the air speed that the pitot tube reads."""
        true = shown["airspeed"]
        out = {**shown, "airspeed": self.pitot * true, "groundspeed": np.sqrt(true**2 - shown["climb"] ** 2)}
        if self.filter_hz > 0.0:
            out |= {name: self._low_passed(shown[name]) for name in ("q", "imu_q", "a_x", "a_z")}
        return out

    def _low_passed(self, series: Floats) -> Floats:
        b, a = butter(2, self.filter_hz, fs=1.0 / STEP_S)
        return np.asarray(lfilter(b, a, series, zi=series[0] * lfilter_zi(b, a))[0])

    def stamped(self, streams: dict[str, Stream]) -> dict[str, Stream]:
        """Return the streams with the command under stamps ahead of its effect."""
        servo = streams["servo"]
        late = replace(servo, stamps=np.maximum(servo.stamps - self.command_late_s, 0.0))
        return {**streams, "servo": late}

    def facts(self) -> dict[str, float]:
        """Return the nuisances for the key."""
        return {name: float(value) for name, value in asdict(self).items()}


def drawn(rng: Generator, height_m: float, share: float = SHARE) -> Nature:
    """Draw the nuisances of a flight at a height above sea level, where every air speed is indicated."""
    pitot = float(np.exp(-0.5 * height_m / _SCALE_HEIGHT_M))
    if rng.random() >= share:
        return Nature(pitot=pitot)
    return Nature(
        command_late_s=float(rng.uniform(-0.006, 0.010)),
        filter_hz=float(rng.choice([0.0, 15.0, 20.0, 30.0])),
        told=bool(rng.random() < 0.5),
        pitot=pitot,
    )
