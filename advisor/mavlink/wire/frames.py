"""Reader of logs and live links, which turns bytes into columns."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from advisor.flight.signals.messages import Columns
from advisor.mavlink.wire import arrivals
from advisor.mavlink.wire import scan as kernel
from advisor.mavlink.wire.definitions import DEFINITIONS, Definition
from advisor.mavlink.wire.framing import RADIO_STATUS, SignatureCheck, SignatureVerdict

_SOURCES = 1 << 16


@dataclass(frozen=True, slots=True)
class Received:
    """Counts of one sender's frames, from their sequence numbers and bytes."""

    frames: int = 0
    """Number of good frames, each counted once."""
    lost: int = 0
    """Number of frames missing in the sequence numbers."""
    late: int = 0
    """Number of frames that arrived after a later one."""
    repeated: int = 0
    """Number of frames that a second path repeated. Repeated frames are not counted in ``frames``."""
    repeated_after_s: float = math.nan
    """Mean delay of a repeat after the first copy, s."""

    @property
    def repeated_percent(self) -> float:
        """Share of the frames that arrived twice, per cent."""
        return 100.0 * self.repeated / self.frames if self.frames else 0.0


@dataclass(frozen=True, slots=True)
class ScanStatistics:
    """Counts of a stream up to its last processed byte."""

    frames: int
    """Number of good frames of any message."""
    known_frames: int
    """Number of good frames of defined messages, whose checksum is therefore verified."""
    damaged: int
    """Number of places where a good frame was expected and not found."""
    skipped_bytes: int
    """Number of bytes outside all good frames and time stamps."""
    senders: Mapping[tuple[int, int], Received]
    """Counts of each sender's frames, by (system, component)."""
    refused: Mapping[SignatureVerdict, int]
    """Number of wanted messages' frames refused for their signature, by verdict; empty without a key."""


class FrameScanner:
    """Scanner that finds MAVLink 1 and 2 frames in tlog records, and decodes the wanted ones.

    Each record has 8 bytes of big-endian microseconds since 1970 and one frame. The stream may be cut
    anywhere: the columns of all feeds together do not depend on the cuts. A frame with a right checksum is
    accepted. Other bytes are skipped, and so are repeats by a second path (`advisor.mavlink.wire.arrivals`).

    Parameters
    ----------
    wanted : iterable of str, optional
        Names of the messages to decode; all of ``DEFINITIONS`` by default.
    key : bytes, optional
        Signing key of 32 bytes: frames without a good, fresh signature are refused. RADIO_STATUS is
        accepted, because radios inject it unsigned.

    Raises
    ------
    KeyError
        A wanted message has no definition.
    """

    def __init__(self, wanted: Iterable[str] | None = None, key: bytes | None = None) -> None:
        self._definitions = [DEFINITIONS[name] for name in (DEFINITIONS if wanted is None else wanted)]
        ids = 1 + max(definition.id for definition in DEFINITIONS.values())
        self._kinds = np.full(ids, -1)
        for kind, definition in enumerate(self._definitions):
            self._kinds[definition.id] = kind
        self._seeds = np.full(ids, -1)
        for definition in DEFINITIONS.values():
            self._seeds[definition.id] = definition.crc_extra
        self._state = np.zeros(kernel.STATE_ENTRIES, dtype=np.int64)
        self._state[[kernel.AT, kernel.IN_STEP]] = kernel.STAMP_BYTES, True
        self._senders = np.zeros((_SOURCES, arrivals.SENDER_COLUMNS), dtype=np.int64)
        self._packets = np.zeros((arrivals.PACKETS, arrivals.PACKET_COLUMNS), dtype=np.int64)
        self._newest = np.zeros(arrivals.COUNT + 1, dtype=np.int64)
        self._signatures = SignatureCheck(key) if key is not None else None
        self._refused: dict[SignatureVerdict, int] = {}
        self._tail = b""
        self._offset = 0

    def feed(self, data: bytes) -> list[Columns]:
        """Process the next bytes of the stream, and return the messages that they complete.

        Returns
        -------
        list of Columns
            Columns of each message and sender; ``order`` is the frame's position in the stream, bytes.
        """
        return self._scan(self._tail + data, final=False)

    def close(self) -> list[Columns]:
        """Process the end of the stream, and return the messages in the last bytes."""
        return self._scan(self._tail, final=True)

    @property
    def statistics(self) -> ScanStatistics:
        """Counts of the stream so far."""
        state = self._state
        return ScanStatistics(
            frames=int(state[kernel.FRAMES]),
            known_frames=int(state[kernel.KNOWN]),
            damaged=int(state[kernel.DAMAGED]),
            skipped_bytes=int(state[kernel.SKIPPED]),
            senders={
                divmod(int(source), 256): _received(self._senders[source])
                for source in np.flatnonzero(self._senders[:, arrivals.HEARD])
            },
            refused=dict(self._refused),
        )

    def _scan(self, data: bytes, final: bool) -> list[Columns]:
        stream = np.frombuffer(data, dtype=np.uint8)
        frames = np.empty((len(stream) // 8 + 1, kernel.FOUND_COLUMNS), dtype=np.int64)
        rows, keep = kernel.scan(
            stream,
            final,
            self._kinds,
            self._seeds,
            self._state,
            self._senders,
            self._packets,
            self._newest,
            frames,
        )
        frames = frames[:rows]
        if self._signatures is not None:
            frames = frames[[self._believed(self._signatures, data, row) for row in frames]]
        columns = self._columns(stream, frames)
        self._tail = data[keep:]
        self._offset += keep
        return columns

    def _believed(self, signatures: SignatureCheck, data: bytes, row: NDArray[np.int64]) -> bool:
        start = row[kernel.START]
        verdict = signatures.verdict(data[start : start + row[kernel.LENGTH]])
        definition = self._definitions[row[kernel.KIND]]
        if verdict == "ok" or (verdict == "unsigned" and definition.id == RADIO_STATUS):
            return True
        self._refused[verdict] = self._refused.get(verdict, 0) + 1
        return False

    def _columns(self, stream: NDArray[np.uint8], frames: NDArray[np.int64]) -> list[Columns]:
        """Sort the found frames by message and sender, keep their order, and decode them."""
        if not len(frames):
            return []
        sender = frames[:, kernel.KIND] * _SOURCES + frames[:, kernel.SOURCE]
        by_sender = np.argsort(sender, kind="stable")
        frames, sender = frames[by_sender], sender[by_sender]
        edges = [0, *(np.flatnonzero(np.diff(sender)) + 1).tolist(), len(frames)]
        columns = []
        for first, last in pairwise(edges):
            group = frames[first:last]
            kind, source = divmod(int(sender[first]), _SOURCES)
            definition = self._definitions[kind]
            payloads = np.zeros((len(group), definition.layout.itemsize), dtype=np.uint8)
            starts = np.ascontiguousarray(group[:, kernel.START])
            kernel.copy_payloads(stream, starts, payloads)
            columns.append(
                Columns(
                    name=definition.name,
                    system=source >> 8,
                    component=source & 0xFF,
                    order=starts + self._offset,
                    arrival_s=group[:, kernel.STAMP].astype(np.float64) * 1e-6,
                    fields=_fields(definition, payloads),
                )
            )
        return columns


def _received(sender: NDArray[np.int64]) -> Received:
    repeated = int(sender[arrivals.REPEATED])
    return Received(
        frames=int(sender[arrivals.HEARD]) - repeated,
        lost=int(sender[arrivals.LOST]),
        late=int(sender[arrivals.LATE]),
        repeated=repeated,
        repeated_after_s=1e-6 * int(sender[arrivals.REPEATED_LATE_US]) / repeated if repeated else math.nan,
    )


def _fields(definition: Definition, payloads: NDArray[np.uint8]) -> dict[str, NDArray[Any]]:
    """Return the fields of payloads by the layout of their message. Texts end at their first zero."""
    records = payloads.view(definition.layout)[:, 0]
    fields: dict[str, NDArray[Any]] = {name: records[name] for name in definition.layout.names or ()}
    for name, column in fields.items():
        if column.dtype.kind == "S":
            texts = [text.partition(b"\0")[0] for text in column.tolist()]
            fields[name] = np.array(texts, dtype=column.dtype)
    return fields
