"""Parameters that a ground station fetched as a file by MAVLink FTP: ``@PARAM/param.pck``.

QGroundControl, MAVProxy and Mission Planner read ArduPilot's parameters in this way. The vehicle sends pieces
of the file in FILE_TRANSFER_PROTOCOL, some twice and out of order. The file contains the kind, name and value
of each parameter. A name omits the first letters that it shares with the previous name (ArduPilot,
``AP_Filesystem_Param.cpp``).
"""

import struct
from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from itertools import groupby

import numpy as np

from advisor.flight.signals.messages import Columns

MESSAGE = "FILE_TRANSFER_PROTOCOL"
_ACK, _OPEN, _READ, _BURST = 128, 4, 5, 15
"""Operations of MAVLink FTP: the answer, opening of a file, and reading of one or many pieces."""
_HEAD = struct.Struct("<HBBBBBxI")
"""Fields of the head: sequence number, session, operation, size, answered operation, end of a burst, padding,
offset.
"""
_PLAIN, _WITH_DEFAULTS = 0x671B, 0x671C
"""First number of a parameter file, without and with the parameters' default values."""
_KINDS = {1: "<b", 2: "<h", 3: "<i", 4: "<f"}
"""Binary form of a parameter's value, by its kind."""
_HAS_DEFAULT = 1
MOST_BATCHES = 500
"""Largest number of batches with file pieces that are kept. A download of parameters takes some seconds, but
a download of a log may take an hour.
"""
_REAL32 = 9
"""Value of MAV_PARAM_TYPE_REAL32. A value from the file is a number already."""


def stated_by_file(batches: Iterable[Sequence[Columns]]) -> list[Columns]:
    """Return the parameters of each vehicle's files as PARAM_VALUE, at the arrival of their last piece."""
    sent = (c for batch in batches for c in batch if c.name == MESSAGE)
    by_sender = sorted(sent, key=lambda c: (c.system, c.component))
    return [
        _as_messages(list(of_one), values)
        for _, group in groupby(by_sender, key=lambda c: (c.system, c.component))
        for of_one in [list(group)]
        if (values := dict(_parameters_of(of_one)))
    ]


class ParameterFiles:
    """Parameter files in a stream, whose values are added as PARAM_VALUE messages."""

    def __init__(self) -> None:
        self._sent: deque[Columns] = deque(maxlen=MOST_BATCHES)
        self._told = 0

    def followed(self, batch: Sequence[Columns]) -> list[Columns]:
        """Return a batch, followed by all known parameters if its pieces added some."""
        sent = [columns for columns in batch if columns.name == MESSAGE]
        self._sent += sent
        stated = stated_by_file([self._sent]) if sent else []
        count = sum(map(len, stated))
        if count == self._told or not sent:
            return list(batch)
        self._told = count
        return [*batch, *stated]


def _as_messages(sent: Sequence[Columns], values: dict[str, float]) -> Columns:
    """Return values as the sender's PARAM_VALUE messages, all at the sender's last message."""
    last, n = sent[-1], len(values)
    fields = {
        "param_id": np.array([name.encode("ascii", "replace") for name in values], "S16"),
        "param_value": np.array([*values.values()], dtype=np.float64),
        "param_type": np.full(n, _REAL32, dtype=np.uint8),
        "param_count": np.full(n, n, dtype=np.uint16),
        "param_index": np.arange(n, dtype=np.uint16),
    }
    order, at_s = np.full(n, last.order[-1]), np.full(n, last.arrival_s[-1])
    return Columns("PARAM_VALUE", last.system, last.component, order, at_s, fields, last.carrier)


def _parameters_of(sent: Sequence[Columns]) -> Iterator[tuple[str, float]]:
    """Yield name and value of the parameters in every file that one vehicle sent, in the order of arrival."""
    files: dict[int, dict[int, bytes]] = {}
    whole: list[dict[int, bytes]] = []
    for payload in (bytes(row) for columns in sent for row in columns.fields["payload"].astype(np.uint8)):
        _, session, operation, size, answered, _, offset = _HEAD.unpack_from(payload)
        if operation != _ACK:
            continue
        if answered == _OPEN or session not in files:
            files[session] = {}
            whole.append(files[session])
        if answered in (_READ, _BURST):
            files[session].setdefault(offset, payload[_HEAD.size : _HEAD.size + size])
    for pieces in whole:
        yield from unpacked(_contiguous(pieces))


def _contiguous(pieces: dict[int, bytes]) -> bytes:
    """Return the beginning of a file up to the first piece that is missing."""
    data = b""
    for offset in sorted(pieces):
        if offset > len(data):
            break
        data = data[:offset] + pieces[offset] if offset + len(pieces[offset]) > len(data) else data
    return data


def unpacked(data: bytes) -> Iterator[tuple[str, float]]:
    """Yield name and value of each parameter in a packed file, up to a gap. Any other file yields nothing."""
    if len(data) < 6 or struct.unpack_from("<H", data)[0] not in (_PLAIN, _WITH_DEFAULTS):
        return
    at, before = 6, b""
    while at + 2 <= len(data):
        if data[at] == 0:  # fills the piece, so that no parameter lies in two
            at += 1
            continue
        form = _KINDS.get(data[at] & 0x0F)
        if form is None:
            return
        own, shared = (data[at + 1] >> 4) + 1, data[at + 1] & 0x0F
        name = before[:shared] + data[at + 2 : at + 2 + own]
        size = struct.calcsize(form)
        value_at = at + 2 + own
        if value_at + size > len(data):
            return
        yield name.decode("ascii", "replace"), float(struct.unpack_from(form, data, value_at)[0])
        before, at = name, value_at + size * (2 if data[at] >> 4 & _HAS_DEFAULT else 1)
