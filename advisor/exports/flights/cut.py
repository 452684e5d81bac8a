"""The log of one manoeuvre: the packets of a tlog around the manoeuvre, byte by byte, with the necessary
earlier ones."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from advisor.flight.signals.messages import Columns, IntArray
from advisor.mavlink.logs.formats.telemetry import FORMAT as TLOG
from advisor.mavlink.logs.kinds import recognised
from advisor.mavlink.logs.tlog import read_tlog
from advisor.mavlink.logs.unpack import beginning_of, unpacked
from advisor.mavlink.wire.framing import CRC_EXTRA, LONGEST_FRAME, FrameCutter
from advisor.mavlink.wire.scan import STAMP_BYTES
from advisor.words.problems import ConfigurationError

BEFORE = {"HEARTBEAT": (), "AUTOPILOT_VERSION": (), "PARAM_VALUE": ("param_id",)}
"""Key fields of each message whose last value before the stretch is needed, by the message's name. These
messages give identity, mode and parameters of the vehicle."""


def cut_tlog(log: Path, first: int, last: int) -> bytes:
    """Return the packets of a tlog between two positions, after the newest earlier heartbeats and parameters.

    Parameters
    ----------
    log
        A tlog, packed or not.
    first, last
        Positions of the first and the last packet's frame in the unpacked log, bytes.

    Returns
    -------
    bytes
        Whole records of the log, unchanged: time stamp and frame.

    Raises
    ------
    ConfigurationError
        The log is no tlog.
    """
    beginning = beginning_of(log)
    with unpacked(log, beginning) as plain:
        found = recognised(beginning_of(plain) if plain is not log else beginning)
        if found is None or found.format is not TLOG:
            raise ConfigurationError(
                f"--cut: {log} is no tlog, and only tlogs are cut; "
                "export the manoeuvre's channels with --format."
            )
        data = plain.read_bytes()
        needed = sorted({int(at) for columns in _messages(plain) for at in _newest(columns, first)})
    records = [data[at - STAMP_BYTES : at + _length(data, at)] for at in needed]
    return b"".join([*records, data[first - STAMP_BYTES : last + _length(data, last)]])


def _messages(log: Path) -> Iterator[Columns]:
    """Yield the messages of a tlog that a stretch may need, with all batches of one sender joined."""
    heard: dict[tuple[str, int, int], list[Columns]] = {}
    for batch in read_tlog(log, BEFORE):
        for columns in batch:
            heard.setdefault((columns.name, columns.system, columns.component), []).append(columns)
    for parts in heard.values():
        fields = {key: np.concatenate([c.fields[key] for c in parts]) for key in BEFORE[parts[0].name]}
        order = np.concatenate([c.order for c in parts])
        arrival = np.concatenate([c.arrival_s for c in parts])
        yield Columns(parts[0].name, parts[0].system, parts[0].component, order, arrival, fields)


def _newest(columns: Columns, first: int) -> IntArray:
    """Return the positions of the newest messages before ``first``, one for each value of the key fields."""
    before = columns.order < first
    order = columns.order[before]
    newest: dict[object, int] = {}
    keys = [columns.fields[key][before].tolist() for key in BEFORE[columns.name]]
    for i, at in enumerate(order.tolist()):
        newest[tuple(key[i] for key in keys)] = at
    return np.array(list(newest.values()), dtype=np.int64)


def _length(data: bytes, at: int) -> int:
    """Return the length of the frame at ``at``, bytes."""
    return len(FrameCutter(CRC_EXTRA).feed(data[at : at + LONGEST_FRAME])[0].raw)
