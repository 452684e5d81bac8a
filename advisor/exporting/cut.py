"""The log of one manoeuvre: the packets of a tlog around it, byte by byte, and what must come before."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from advisor.flight.messages import Columns, IntArray
from advisor.mavlink.framing import CRC_EXTRA, LONGEST_FRAME, FrameCutter
from advisor.mavlink.kinds import recognised
from advisor.mavlink.scan import STAMP_BYTES
from advisor.mavlink.tlog import read_tlog
from advisor.mavlink.unpack import beginning_of, unpacked
from advisor.problems import ConfigurationError

BEFORE = {"HEARTBEAT": (), "AUTOPILOT_VERSION": (), "PARAM_VALUE": ("param_id",)}
"""Messages of which the last before the stretch is needed: who the vehicle is, its mode, each parameter by
name."""


def cut_tlog(log: Path, first: int, last: int) -> bytes:
    """Return the packets of a tlog from one to another, after the newest heartbeats and parameters before
    them.

    Parameters
    ----------
    log
        A tlog, packed or not.
    first, last
        Where the frames of the first and of the last packet begin in the unpacked log, bytes.

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
        if found is None or found.kind != "tlog":
            raise ConfigurationError(
                f"--cut: {log} is no tlog, and only tlogs are cut; "
                "export the manoeuvre's channels with --format."
            )
        data = plain.read_bytes()
        needed = sorted({int(at) for columns in _messages(plain) for at in _newest(columns, first)})
    records = [_record(data, at) for at in needed]
    return b"".join([*records, data[first - STAMP_BYTES : last + _length(data, last)]])


def _messages(log: Path) -> Iterator[Columns]:
    """Yield the messages of a tlog that may be needed before a stretch, all batches of one sender joined."""
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
    """Return where the newest of these messages before ``first`` begin, one for each value of the key
    fields."""
    before = columns.order < first
    order = columns.order[before]
    newest: dict[object, int] = {}
    keys = [columns.fields[key][before].tolist() for key in BEFORE[columns.name]]
    for i, at in enumerate(order.tolist()):
        newest[tuple(key[i] for key in keys)] = at
    return np.array(list(newest.values()), dtype=np.int64)


def _record(data: bytes, at: int) -> bytes:
    return data[at - STAMP_BYTES : at + _length(data, at)]


def _length(data: bytes, at: int) -> int:
    """Return bytes of the frame that begins at ``at``."""
    return len(FrameCutter(CRC_EXTRA).feed(data[at : at + LONGEST_FRAME])[0].raw)
