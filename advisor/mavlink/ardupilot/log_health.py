"""Faults of an ArduPilot log: dropped records and a wrong clock; and its SystemID sweeps.

SIDS contains the settings of a sweep, at its begin. SIDD contains the samples of the sweep. The vehicle also
sends a text at begin and end of a sweep, which MSG may have lost.
"""

from collections.abc import Iterator, Mapping

import numpy as np

from advisor.flight.maneuvers.markers import SYSTEM_ID_BEGINS, SYSTEM_ID_ENDS
from advisor.mavlink.ardupilot.sensors import Said
from advisor.mavlink.records.stretches import RecordTable

HEALTH_RECORDS: dict[str, set[str]] = {"DSF": {"Dp"}}
"""Necessary fields of the records about the log's own health (ArduPilot log message DSF)."""
WRONG_CLOCK = 0.01
"""Least relative error of the autopilot's clock that is reported. A second-order derivative is then wrong by
2 %; the oscillators of autopilots are right to 1e-4."""
_SURELY = 3.0
"""Least error of the clock that is reported, in standard errors."""
_FEWEST = 10
"""Least number of GPS records for an estimate of the clock's error."""


def health(tables: Mapping[str, RecordTable]) -> Iterator[Said]:
    """Yield sentences about dropped records and a wrong clock."""
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
    """Return the relative error of the autopilot's clock; None if GPS time shows no error."""
    dated = gps.fields["GWk"] > 0
    if np.count_nonzero(dated) < _FEWEST:
        return None
    true_s = 604_800.0 * gps.fields["GWk"][dated] + 1e-3 * gps.fields["GMS"][dated]
    boot_s = 1e-6 * gps.time_us[dated]
    true_s, boot_s = true_s - true_s.mean(), boot_s - boot_s.mean()
    power = float(true_s @ true_s)
    if power == 0.0:
        return None
    speed = float(true_s @ boot_s) / power
    std = float(np.sqrt(np.mean((boot_s - speed * true_s) ** 2) / power))
    error = speed - 1.0
    return error if abs(error) > max(WRONG_CLOCK, _SURELY * std) and abs(error) < 1.0 else None


SYSTEM_ID_RECORDS: dict[str, set[str]] = {"SIDS": {"Ax", "Mag", "FSt", "FSp", "TR"}, "SIDD": {"Targ"}}
"""Necessary fields of the SystemID records (ArduPilot log messages SIDS and SIDD)."""
_AXES = {20: "the roll angle", 21: "the pitch angle", 22: "the ailerons", 23: "the elevator"}
"""Moved quantity of each value of SID_AXIS in fixed-wing flight. Values 1 to 13 belong to hovering flight."""


def sweeps(tables: Mapping[str, RecordTable]) -> Iterator[Said]:
    """Yield a sentence about the settings of each sweep."""
    if "SIDS" not in tables:
        return
    sids = tables["SIDS"]
    columns = (sids.order, sids.time_us, *(sids.fields[name] for name in ("Ax", "FSt", "FSp", "TR", "Mag")))
    for order, time_us, axis, lowest_hz, highest_hz, length_s, size in zip(*columns, strict=True):
        yield Said(
            int(order),
            int(time_us),
            f"SystemID sweeps {_AXES.get(int(axis), 'a control in hover')} (SID_AXIS {int(axis)}) "
            f"from {lowest_hz:.2g} to {highest_hz:.2g} Hz in {length_s:.0f} s, magnitude {size:.2g}",
        )


def lost_texts(tables: Mapping[str, RecordTable]) -> Iterator[tuple[int, int, bytes]]:
    """Yield the begin and end texts of sweeps that MSG lacks, according to SIDS.

    Yields
    ------
    tuple of int, int and bytes
        Each entry is the record's position in the file, its time in us since boot, and the text. A sweep
        without a sample in SIDD has no known end, and yields no text.
    """
    if not {"SIDS", "SIDD"} <= tables.keys() or _told(tables) >= len(tables["SIDS"]):
        return
    sids, sidd = tables["SIDS"], tables["SIDD"]
    after = [*sids.order[1:], np.inf]
    for order, time_us, axis, next_order in zip(
        sids.order, sids.time_us, sids.fields["Ax"], after, strict=True
    ):
        rows = np.flatnonzero((sidd.order > order) & (sidd.order < next_order))
        if len(rows):
            yield int(order), int(time_us), SYSTEM_ID_BEGINS + f": axis={int(axis)}".encode()
            yield int(sidd.order[rows[-1]]), int(sidd.time_us[rows[-1]]), SYSTEM_ID_ENDS


def _told(tables: Mapping[str, RecordTable]) -> int:
    """Return the number of sweeps whose begin and end texts are in MSG."""
    if "MSG" not in tables:
        return 0
    texts = tables["MSG"].fields["Message"].tolist()
    edges = (SYSTEM_ID_BEGINS, SYSTEM_ID_ENDS)
    return min(len([text for text in texts if text.startswith(edge)]) for edge in edges)
