"""Stamps that are equal, run backwards or mean nothing: a log is read all the same, and without a warning."""

import struct
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from advisor.flight.maneuvers.maneuver import Span
from advisor.flight.stream.stream import FlightStream
from tests.heard import hear_log
from tests.mavlink.ardupilot.test_autopilot_logs import FIRST_STEP_S, dataflash_flight
from tests.mavlink.dataflash_writer import records_of
from tests.test_damaged_logs import sound as sound_case

Stamps = NDArray[np.uint64]
SECOND_US = np.uint64(1_000_000)


def in_pairs(t: Stamps) -> Stamps:
    return np.repeat(t[::2], 2)[: len(t)]


def one_for_all(t: Stamps) -> Stamps:
    return np.full_like(t, t[len(t) // 2])


def whole_seconds(t: Stamps) -> Stamps:
    return t // SECOND_US * SECOND_US


def once_back(t: Stamps) -> Stamps:
    return np.where(np.arange(len(t)) < len(t) // 2, t, t - (t[len(t) // 2] - t[0]))


def some_back(t: Stamps) -> Stamps:
    return np.where(np.arange(len(t)) % 97 == 50, t - SECOND_US // np.uint64(2), t)


def backwards(t: Stamps) -> Stamps:
    return t[::-1]


def any_number(t: Stamps) -> Stamps:
    return np.random.default_rng(1).integers(0, 2**64, size=len(t), dtype=np.uint64)


CHANGES = [in_pairs, one_for_all, whole_seconds, once_back, some_back, backwards, any_number]


@cache
def sound(kind: str) -> bytes:
    """A log of this kind; of a DataFlash log every record's form is known to the tests."""
    return dataflash_flight(FIRST_STEP_S + 6.0) if kind == "bin" else sound_case(kind)


def pieces(kind: str) -> tuple[list[bytes], int, str]:
    """Pieces of a sound log, and where in those with a stamp it lies, with its form."""
    log, found, at = sound(kind), [], 0
    if kind == "bin":
        return [record for _, record in records_of(log)], 3, "<Q"
    if kind == "ulg":
        found, at = [log[:16]], 16
    while at < len(log):
        size = 3 + struct.unpack_from("<H", log, at)[0] if kind == "ulg" else 8 + 12 + log[at + 9]
        found.append(log[at : at + size])
        at += size
    return found, *((5, "<Q") if kind == "ulg" else (0, ">Q"))


def is_stamped(kind: str, piece: bytes) -> bool:
    return {"bin": piece[2:3] != b"\x80", "ulg": piece[2:3] == b"D", "tlog": True}[kind]


def restamped(kind: str, change: Callable[[Stamps], Stamps]) -> bytes:
    """The log with other stamps."""
    found, at, form = pieces(kind)
    assert b"".join(found) == sound(kind)
    stamped = [k for k, piece in enumerate(found) if is_stamped(kind, piece)]
    stamps = np.array([struct.unpack_from(form, found[k], at)[0] for k in stamped], dtype=np.uint64)
    for k, stamp in zip(stamped, change(stamps).tolist(), strict=True):
        found[k] = found[k][:at] + struct.pack(form, stamp) + found[k][at + 8 :]
    return b"".join(found)


def flown(path: Path) -> tuple[FlightStream, list[Span]]:
    """The stream that has heard a log, and its manoeuvres. The tests turn a warning into an error."""
    heard = hear_log(path)
    return heard.stream, [maneuver.span for maneuver in heard.maneuvers]


@pytest.mark.parametrize("change", CHANGES)
@pytest.mark.parametrize("kind", ["bin", "ulg", "tlog"])
def test_a_log_with_such_stamps_is_read_to_its_end(kind, change, tmp_path):
    path = tmp_path / f"flight.{kind}"
    path.write_bytes(restamped(kind, change))
    stream, _ = flown(path)
    assert stream.vehicle is not None


def test_a_log_that_holds_every_record_twice_gives_the_manoeuvres_of_one_that_holds_it_once(tmp_path):
    once, twice = tmp_path / "once.bin", tmp_path / "twice.bin"
    once.write_bytes(sound("bin"))
    twice.write_bytes(b"".join(2 * piece for piece in pieces("bin")[0]))
    (right,), mine = flown(once)[1], flown(twice)[1]
    assert mine == [right]
