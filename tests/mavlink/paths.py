"""A log as a ground station writes it that hears a vehicle over several paths."""

import struct
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

_STAMP_BYTES = 8
_SIGNATURE_BYTES = 13


@dataclass(frozen=True)
class Way:
    """One way from the vehicle to the ground station."""

    late_s: float = 0.0
    loss: float = 0.0
    """Share of the packets lost, each by itself."""
    silent_s: tuple[float, float] = (0.0, 0.0)
    """From when to when, s since the log began, the path brings nothing."""


def records(log: bytes) -> Iterator[tuple[int, bytes]]:
    """Stamp in us and frame of each record of a sound log."""
    at = 0
    while at + _STAMP_BYTES + 3 <= len(log):
        (stamp_us,) = struct.unpack_from(">Q", log, at)
        start = at + _STAMP_BYTES
        length = log[start + 1] + (8 if log[start] == 0xFE else 12)
        if log[start] == 0xFD and log[start + 2] & 1:
            length += _SIGNATURE_BYTES
        yield stamp_us, log[start : start + length]
        at = start + length


def heard_over(log: Path, *paths: Way, seed: int = 0) -> bytes:
    """The records of a log as they arrive over these paths together."""
    rng = np.random.default_rng(seed)
    sent = list(records(log.read_bytes()))
    begin_us = sent[0][0]
    heard: list[tuple[int, int, bytes]] = []
    for path in paths:
        lost = rng.random(len(sent)) < path.loss
        from_us, to_us = (begin_us + 1e6 * second for second in path.silent_s)
        heard += [
            (stamp_us + int(1e6 * path.late_s), number, frame)
            for number, (stamp_us, frame) in enumerate(sent)
            if not lost[number] and not from_us <= stamp_us < to_us
        ]
    heard.sort(key=lambda record: record[:2])
    return b"".join(struct.pack(">Q", stamp_us) + frame for stamp_us, _, frame in heard)
