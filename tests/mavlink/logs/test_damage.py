"""Damaged logs: what is intact survives, nothing is invented, nothing crashes."""

import struct
import tempfile
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from pymavlink.dialects.v20 import ardupilotmega as dialect

from advisor.mavlink.wire.definitions import DEFINITIONS
from advisor.mavlink.wire.frames import FrameScanner
from tests.mavlink.builders import (
    START_US,
    Message,
    Sender,
    as_message,
    by_pymavlink,
    one_by_one,
    random_message,
)

STAMP_BYTES = 8
KNOWN = list(DEFINITIONS)


@dataclass
class Record:
    """A record on its way into the log, and whether its frame got there whole."""

    raw: bytes
    message: Message | None
    """None for a message the advisor does not read."""
    intact: bool = True


def flight(seed: int, count: int) -> list[Record]:
    """Both directions, two vehicles, MAVLink 1 and 2, known and unknown messages, a reboot."""
    rng = np.random.default_rng(seed)
    systems = [Sender(1, 1), Sender(2, 1), Sender(255, 190)]
    decoder = dialect.MAVLink(None)
    records = []
    for i in range(count):
        if i == count // 2:
            systems[0] = Sender(1, 1)  # power-on again: sequence numbers restart
        sender = systems[rng.integers(3)]
        known = rng.random() < 0.8
        message = (
            random_message(KNOWN[rng.integers(len(KNOWN))], rng)
            if known
            else dialect.MAVLink_hwstatus_message(i, 5)
        )
        version = 1 if message.get_msgId() < 256 and rng.random() < 0.3 else 2
        frame = sender.frame(message, version)
        stamp = struct.pack(">Q", START_US + 20_000 * i)
        records.append(Record(stamp + frame, as_message(decoder.decode(bytearray(frame))) if known else None))
    return records


# What happens to logs. Each takes the records and a random generator and damages a few of them.


def some_intact(records: list[Record], rng: np.random.Generator, count: int) -> list[int]:
    intact = [i for i, record in enumerate(records) if record.intact]
    return list(dict.fromkeys(rng.choice(intact, count).tolist()))


def flip_bits(records: list[Record], rng: np.random.Generator) -> None:
    for i in some_intact(records, rng, 3):
        raw = bytearray(records[i].raw)
        raw[rng.integers(STAMP_BYTES, len(raw))] ^= 1 << rng.integers(8)
        records[i] = Record(bytes(raw), records[i].message, intact=False)


def cut_short(records: list[Record], rng: np.random.Generator) -> None:
    for i in some_intact(records, rng, 2):
        raw = records[i].raw
        records[i] = Record(raw[: rng.integers(len(raw) - 1)], records[i].message, intact=False)


def lose_the_beginning(records: list[Record], rng: np.random.Generator) -> None:
    (i,) = some_intact(records, rng, 1)
    cut = rng.integers(STAMP_BYTES + 1, len(records[i].raw))
    records[i] = Record(records[i].raw[cut:], records[i].message, intact=False)


def insert_garbage(records: list[Record], rng: np.random.Generator) -> None:
    records.insert(
        rng.integers(len(records) + 1), Record(rng.bytes(rng.integers(1, 400)), None, intact=False)
    )


def insert_something_like_a_frame(records: list[Record], rng: np.random.Generator) -> None:
    """The worst garbage: it announces a long payload, so that intact records seem to be inside."""
    magic = bytes([rng.choice([0xFD, 0xFE]), 255, 0])
    records.insert(rng.integers(len(records) + 1), Record(magic + rng.bytes(6), None, intact=False))


def hole_of_zeros(records: list[Record], rng: np.random.Generator) -> None:
    """A block of 200 bytes that never reached the disk, wherever it falls."""
    edges = np.cumsum([0, *(len(record.raw) for record in records)])
    first = rng.integers(edges[-1])
    last = first + 200
    for i, (start, end) in enumerate(pairwise(edges)):
        if start < last and end > first:
            raw = bytearray(records[i].raw)
            a, b = max(first - start, 0), min(last - start, len(raw))
            raw[a:b] = bytes(b - a)
            frame_untouched = raw[STAMP_BYTES:] == records[i].raw[STAMP_BYTES:]
            records[i] = Record(bytes(raw), records[i].message, records[i].intact and frame_untouched)


def jump_in_time(records: list[Record], rng: np.random.Generator) -> None:
    """The ground station's clock is set, by years, back or forth."""
    first, last = sorted(rng.integers(len(records), size=2))
    years = int(rng.integers(-40, 40))
    for record in records[first:last]:
        if len(record.raw) >= STAMP_BYTES:
            stamp = struct.unpack_from(">Q", record.raw)[0] + years * 31_557_600_000_000
            if 0 <= stamp < 1 << 64:
                record.raw = struct.pack(">Q", stamp) + record.raw[STAMP_BYTES:]


def spoil_stamps(records: list[Record], rng: np.random.Generator) -> None:
    for i in some_intact(records, rng, 3):
        records[i].raw = rng.bytes(STAMP_BYTES) + records[i].raw[STAMP_BYTES:]


def repeat(records: list[Record], rng: np.random.Generator) -> None:
    i = rng.integers(len(records))
    records.insert(rng.integers(len(records) + 1), Record(**vars(records[i])))


def cut_the_tail(records: list[Record], rng: np.random.Generator) -> None:
    keep = rng.integers(len(records) // 2, len(records))
    last = records[keep]
    del records[keep:]
    records.append(Record(last.raw[: len(last.raw) * rng.integers(100) // 100], last.message, intact=False))


DAMAGES = [
    flip_bits,
    cut_short,
    lose_the_beginning,
    insert_garbage,
    insert_something_like_a_frame,
    hole_of_zeros,
    jump_in_time,
    spoil_stamps,
    repeat,
    cut_the_tail,
]


def damaged_flight(seed: int, damages: list[int]) -> list[Record]:
    records = flight(seed, count=60)
    rng = np.random.default_rng([seed, *damages])
    for damage in damages:
        DAMAGES[damage](records, rng)
    return records


def read(stream: bytes, cuts: int = 1) -> list[Message]:
    scanner = FrameScanner()
    size = len(stream) // cuts + 1
    columns = [c for i in range(0, len(stream), size) for c in scanner.feed(stream[i : i + size])]
    return one_by_one(columns + scanner.close())


any_damage = st.lists(st.integers(0, len(DAMAGES) - 1), min_size=1, max_size=8)
seeds = st.integers(0, 2**32 - 1)


@settings(max_examples=100, deadline=None, derandomize=True)
@given(seed=seeds, damages=any_damage, cuts=st.integers(1, 50))
def test_intact_messages_survive_and_none_is_invented(seed: int, damages: list[int], cuts: int) -> None:
    records = damaged_flight(seed, damages)
    stream = b"".join(record.raw for record in records)
    intact = [record.message for record in records if record.intact and record.message is not None]
    assert read(stream, cuts) == intact


@settings(max_examples=30, deadline=None, derandomize=True)
@given(seed=seeds, damages=any_damage)
def test_pymavlink_never_reads_more_of_a_damaged_log(seed: int, damages: list[int]) -> None:
    records = damaged_flight(seed, damages)
    stream = b"".join(record.raw for record in records)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "damaged.tlog"
        path.write_bytes(stream)
        theirs = [message for _, message in by_pymavlink(path)]
    ours = read(stream)
    remaining = iter(ours)
    sent = [record.message for record in records if record.message is not None]
    assert all(message in remaining for message in theirs if message in sent)


@settings(max_examples=100, deadline=None, derandomize=True)
@given(noise=st.binary(max_size=3000), cuts=st.integers(1, 20))
def test_pure_noise_gives_no_message(noise: bytes, cuts: int) -> None:
    assert read(noise, cuts) == []


def test_a_hole_of_zeros_leaves_no_absurd_time_of_arrival() -> None:
    records = flight(seed=1, count=200)
    stream = bytearray(b"".join(record.raw for record in records))
    stream[5000:5200] = bytes(200)
    scanner = FrameScanner()
    columns = scanner.feed(bytes(stream)) + scanner.close()
    for column in columns:
        assert np.all(np.abs(column.arrival_s - START_US * 1e-6) < 10.0)
    assert scanner.statistics.damaged >= 1
