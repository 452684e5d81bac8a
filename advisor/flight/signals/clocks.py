"""The vehicle's clock: seconds since boot, unwrapped, from counters that wrap and restart; attitudes at their
stamps.

``ATTITUDE.time_boot_ms`` is the master clock. Every other stamp is placed on the master clock. A 32-bit
counter of microseconds is the true time less a multiple of 71.6 minutes, and the master gives the multiple.
SERVO_OUTPUT_RAW has a 32-bit counter, and so has AOA_SSA from ArduPilot. The conversion keeps no state for a
message, so silences, duplicates and late packets do no harm. A clock that goes back by less than `_OLD_MS` is
no reboot.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from advisor.flight.signals.messages import Columns, cut, joined
from advisor.process.arrays import FloatArray, IntArray

_MS = 1e-3
_WRAP_MS = 2**32
_LATE_MS = 2000
"""Age relative to the newest master stamp, ms, below which a stamp belongs to a late packet."""
_OLD_MS = 20_000
"""Age relative to the newest master stamp, ms, below which a stamp came by a second path and is dropped.
Radios delay packets by up to 15 s."""
_SILENCE_MS = 10_000
"""Advance of a master stamp beyond the last one, ms, above which the stamp needs confirmation."""
_CONFIRM = 3
"""Number of consecutive stamps that confirm a jump: backwards a reboot, forwards a silence."""
_TIME_OF_DAY_S = 1e9
"""Least stamp, s, that is relative to 1970. No counter since boot reaches this value."""
_NEAR_S = 5.0
"""Largest distance of a stamp from the master clock at the arrival of its message, s."""


@dataclass(frozen=True, slots=True)
class MasterStamps:
    """Vehicle time from a series of ``time_boot_ms``."""

    t: FloatArray
    """Shape (n,), seconds since boot. An unconfirmed stamp is NaN."""
    boot: IntArray
    """Shape (n,): number of the boot of each stamp, rising."""


class BootClock:
    """Unwrapping of ``time_boot_ms`` and detection of reboots."""

    def __init__(self, boot: int = 0) -> None:
        self.boot = boot
        """Number of the present boot, 0 for the first."""
        self._newest_ms: int | None = None
        self._doubt: list[int] = []

    @property
    def newest_s(self) -> float:
        """Newest confirmed stamp, s since boot. NaN before the first confirmed stamp."""
        return float("nan") if self._newest_ms is None else self._newest_ms * _MS

    def advance(self, time_boot_ms: IntArray) -> MasterStamps:
        """Take stamps in order of arrival, and return the vehicle times.

        Parameters
        ----------
        time_boot_ms
            Shape (n,): stamps as received, ms.
        """
        newest_ms = time_boot_ms[:1] if self._newest_ms is None else self._newest_ms
        ahead_ms = np.diff(time_boot_ms, prepend=newest_ms)
        if len(ahead_ms) and np.all((ahead_ms >= 0) & (ahead_ms <= _SILENCE_MS)):
            # In order and without a silence, as nearly always: all stamps are confirmed.
            self._newest_ms = int(time_boot_ms[-1])
            self._doubt.clear()
            return MasterStamps(time_boot_ms.astype(np.float64) * _MS, np.full(len(time_boot_ms), self.boot))
        t = np.full(len(time_boot_ms), np.nan)
        boot = np.empty(len(time_boot_ms), dtype=np.int64)
        for i, raw in enumerate(time_boot_ms.tolist()):
            believed_ms = self._believe(raw)
            if believed_ms is not None:
                t[i] = believed_ms * _MS
            boot[i] = self.boot
        return MasterStamps(t, boot)

    def _believe(self, raw: int) -> int | None:
        """Return the unwrapped stamp in milliseconds; None while the stamp is unconfirmed."""
        if self._newest_ms is None:
            self._newest_ms = raw
            return raw
        ahead = _signed(raw - self._newest_ms)
        if -_LATE_MS <= ahead <= _SILENCE_MS:
            self._doubt.clear()
            return self._unwrap(ahead)
        if -_OLD_MS <= ahead < 0:
            return None
        if self._doubt and not 0 <= _signed(raw - self._doubt[-1]) <= _SILENCE_MS:
            self._doubt.clear()
        self._doubt.append(raw)
        if len(self._doubt) < _CONFIRM:
            return None
        self._doubt.clear()
        if ahead > 0:
            return self._unwrap(ahead)
        self.boot += 1
        self._newest_ms = raw
        return raw

    def _unwrap(self, ahead_ms: int) -> int:
        assert self._newest_ms is not None
        stamp = self._newest_ms + ahead_ms
        self._newest_ms = max(self._newest_ms, stamp)
        return stamp


def place(ticks: IntArray, tick_s: float, master_s: FloatArray) -> FloatArray:
    """Return stamps of any counter of at least 32 bits on the master clock.

    Parameters
    ----------
    ticks
        Shape (n,): stamps as received, since boot, possibly wrapped at 2**32 ticks.
    tick_s
        Length of a tick, s.
    master_s
        Shape (n,): master clock at the arrival of each message, s since boot.

    Returns
    -------
    FloatArray
        Shape (n,): vehicle times, s since boot. NaN if no number of wraps brings the stamp near the master
        clock, as for another clock. The master clock replaces a stamp that is zero or a time of day.
    """
    wrap_s = 2.0**32 * tick_s
    raw_s = ticks.astype(np.float64) * tick_s
    t = raw_s + wrap_s * np.round((master_s - raw_s) / wrap_s)
    placed = np.where(np.abs(t - master_s) <= _NEAR_S, t, np.nan)
    return np.where((ticks == 0) & (master_s > _NEAR_S) | (raw_s > _TIME_OF_DAY_S), master_s, placed)


def _signed(difference_ms: int) -> int:
    """Return the shorter difference of two 32-bit stamps, with its sign."""
    return (difference_ms + _WRAP_MS // 2) % _WRAP_MS - _WRAP_MS // 2


_QUATERNION = ("q1", "q2", "q3", "q4")


class Attitudes:
    """Conversion of quaternions to ATTITUDE for each component without ATTITUDE messages.

    If a component sends both messages, its quaternions are used until its first ATTITUDE. The order of
    arrival decides, so batches of any size give equal results.
    """

    def __init__(self) -> None:
        self._senders: set[tuple[int, int]] = set()
        """System and component ids that have sent an ATTITUDE."""

    def of(self, columns: Sequence[Columns]) -> Sequence[Columns]:
        """Return the columns with an ATTITUDE in place of every quaternion before the first ATTITUDE."""
        sent = {_sender(c): c for c in columns if c.name == "ATTITUDE" and len(c)}
        stand_ins: dict[tuple[int, int], Columns] = {}
        for c in columns:
            sender = _sender(c)
            if c.name != "ATTITUDE_QUATERNION" or sender in self._senders:
                continue
            rows = int(np.searchsorted(c.order, sent[sender].order[0])) if sender in sent else len(c)
            if rows:
                early = _as_attitude(c, rows)
                stand_ins[sender] = joined([early, sent[sender]]) if sender in sent else early
        self._senders.update(sent)
        if not stand_ins:
            return columns
        others = [c for c in columns if c.name != "ATTITUDE" or _sender(c) not in stand_ins]
        return [*stand_ins.values(), *others]


def euler_angles(q: FloatArray) -> dict[str, FloatArray]:
    """Return roll, pitch and yaw of attitude quaternions, rad, each of shape (n,).

    Parameters
    ----------
    q
        Shape (4, n): components w, x, y, z of the rotation from north-east-down into body axes.
    """
    w, x, y, z = q
    return {
        "roll": np.arctan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y)),
        "pitch": np.arcsin(np.clip(2.0 * (w * y - z * x), -1.0, 1.0)),
        "yaw": np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)),
    }


def _sender(c: Columns) -> tuple[int, int]:
    return c.system, c.component


def _as_attitude(c: Columns, rows: int) -> Columns:
    """Return the given rows as ATTITUDE; ``q1`` to ``q4`` are w, x, y, z of the rotation into body axes."""
    early = cut(c, slice(rows))
    angles = euler_angles(np.array([early.fields[name] for name in _QUATERNION], dtype=np.float64))
    others = (*_QUATERNION, "repr_offset_q")
    kept = {name: values for name, values in early.fields.items() if name not in others}
    return replace(early, name="ATTITUDE", fields=kept | angles)
