"""The pilot's stick positions of a flight, as the radio receiver reported them."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from advisor.mavlink.logs.whole import read_whole_log
from advisor.process.arrays import FloatArray, IntArray
from advisor.words.problems import UnusableInputError

_CHANNELS = ("chan1_raw", "chan2_raw", "chan3_raw", "chan4_raw")
_NO_PULSE_US = 800
"""Pulse width below which a channel carries no pulse, µs: receivers send 900 to 2100."""


@dataclass(frozen=True)
class RecordedSticks:
    """Pulses of the receiver's first four channels."""

    t: FloatArray
    """Shape (n,): time of each sample in seconds since the first pulse."""
    pulses: IntArray
    """Shape (n, 4), pulse width of each channel, µs."""


def sticks_of(log: Path) -> RecordedSticks:
    """Return the stick positions from a log.

    Raises
    ------
    UnusableInputError
        The log has no RC_CHANNELS, or cannot be read.
    """
    times, rows = [], []
    for batch in read_whole_log(log):
        for columns in batch:
            if columns.name == "RC_CHANNELS" and len(columns):
                times.append(1e-3 * np.asarray(columns.fields["time_boot_ms"], dtype=np.float64))
                rows.append(np.column_stack([columns.fields[name] for name in _CHANNELS]).astype(np.int64))
    t = np.concatenate(times) if times else np.empty(0)
    pulses = np.concatenate(rows) if rows else np.empty((0, len(_CHANNELS)), dtype=np.int64)
    good = np.all(pulses > _NO_PULSE_US, axis=1)
    if np.count_nonzero(good) < 2:
        raise UnusableInputError(
            "no_sticks",
            f"{log.name} has no RC_CHANNELS with four channels: there are no sticks to replay.",
            "Log RC_CHANNELS (stream RC_CHANNELS of ArduPilot) at 50 Hz.",
        )
    t, pulses = t[good], pulses[good]
    rising = np.concatenate([[True], np.diff(t) > 0.0])
    return RecordedSticks(t[rising] - t[0], pulses[rising])
