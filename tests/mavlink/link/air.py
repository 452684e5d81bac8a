"""What the air does to a recorded flight: loss, delay, duplicates, strangers."""

import struct
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.campaign.campaign import Campaign, ManeuverJudged
from advisor.flight.signals.messages import Columns
from advisor.mavlink.wire.frames import FrameScanner
from tests.heard import hear


@dataclass(frozen=True)
class Record:
    """One record of a tlog."""

    stamp_us: int
    frame: bytes


def records_of(log: Path) -> list[Record]:
    """The records of an undamaged tlog."""
    data, at, records = log.read_bytes(), 0, []
    while at < len(data):
        (stamp,) = struct.unpack_from(">Q", data, at)
        magic, payload = data[at + 8], data[at + 9]
        length = 8 + payload if magic == 0xFE else 12 + payload + 13 * (data[at + 10] & 1)
        records.append(Record(stamp, data[at + 8 : at + 8 + length]))
        at += 8 + length
    return records


def through_a_poor_radio(
    records: list[Record], seed: int, loss: float = 0.2, jitter_s: float = 0.2, twice: float = 0.02
) -> list[Record]:
    """Each packet lost, delayed, or delivered twice on its own, so that packets overtake each other."""
    dice = np.random.default_rng(seed)
    delivered: list[Record] = []
    for record in records:
        if dice.random() < loss:
            continue
        for _ in range(1 + int(dice.random() < twice)):
            delay_us = int(dice.uniform(0.0, jitter_s) * 1e6)
            delivered.append(Record(record.stamp_us + delay_us, record.frame))
    return sorted(delivered, key=lambda record: record.stamp_us)


def batches(records: list[Record], size: int, key: bytes | None = None) -> Iterator[list[Columns]]:
    """The records decoded as a live link or, in large batches, as a log is."""
    scanner = FrameScanner(key=key)
    for i in range(0, len(records), size):
        data = b"".join(struct.pack(">Q", r.stamp_us) + r.frame for r in records[i : i + size])
        yield scanner.feed(data)


def flown(records: list[Record], batch: int = 500, key: bytes | None = None) -> list[tuple[float, ...]]:
    """Start and every sample of every channel of every manoeuvre."""
    return hear(batches(records, batch, key)).samples


def judged(records: list[Record], batch: int = 500) -> list[ManeuverJudged]:
    """Every verdict on these records."""
    campaign = Campaign(Aircraft())
    events = [event for columns in batches(records, batch) for event in campaign.feed(columns)]
    return [event for event in [*events, *campaign.finish()] if isinstance(event, ManeuverJudged)]
