"""Faults of an ArduPilot log itself: records that were dropped, and a clock that GPS time contradicts."""

from collections.abc import Iterator, Mapping

import numpy as np

from advisor.mavlink.ardupilot.sensors import Said
from advisor.mavlink.records.dataflash import RecordTable

HEALTH_RECORDS: dict[str, set[str]] = {"DSF": {"Dp"}}
"""Records of the log's own health, with their necessary fields (ArduPilot log message DSF)."""
WRONG_CLOCK = 0.01
"""Least relative error of the autopilot's clock that is said. A derivative per second squared is then
wrong by 2 %; the oscillators of autopilots are right to 1e-4."""
_SURELY = 3.0
"""Least error of the clock in its own standard errors."""
_FEWEST = 10
"""Fewest GPS records from which the clock's speed is taken."""


def health(tables: Mapping[str, RecordTable]) -> Iterator[Said]:
    """Yield sentences on dropped records and on a wrong clock."""
    if "DSF" in tables:
        dsf = tables["DSF"]
        dropped = int(np.max(dsf.fields["Dp"]))
        if dropped:
            row = int(np.argmax(dsf.fields["Dp"] > 0))
            yield Said(
                int(dsf.order[row]),
                int(dsf.time_us[row]),
                f"The autopilot dropped {dropped} records of this log (DSF), so that samples are missing. "
                "Use a faster memory card, or log less (LOG_BITMASK)",
            )
    if "GPS" in tables and (error := _clock_error(tables["GPS"])) is not None:
        gps = tables["GPS"]
        way = "fast" if error > 0.0 else "slow"
        yield Said(
            int(gps.order[0]),
            int(gps.time_us[0]),
            f"The autopilot's clock runs {100.0 * abs(error):.1f} % {way} by GPS time. "
            "Every rate and every derivative per second is wrong by as much",
        )


def _clock_error(gps: RecordTable) -> float | None:
    """Return the relative error of the autopilot's clock; None where GPS time does not show one."""
    known = gps.fields["GWk"] > 0
    if np.count_nonzero(known) < _FEWEST:
        return None
    true_s = 604_800.0 * gps.fields["GWk"][known] + 1e-3 * gps.fields["GMS"][known]
    boot_s = 1e-6 * gps.time_us[known]
    true_s, boot_s = true_s - true_s.mean(), boot_s - boot_s.mean()
    power = float(true_s @ true_s)
    if power == 0.0:
        return None
    speed = float(true_s @ boot_s) / power
    std = float(np.sqrt(np.mean((boot_s - speed * true_s) ** 2) / power))
    error = speed - 1.0
    return error if abs(error) > max(WRONG_CLOCK, _SURELY * std) and abs(error) < 1.0 else None
