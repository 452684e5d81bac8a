"""One flight in all the company and disorder a log may hold it in: the same manoeuvres."""

import struct
from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
from pymavlink.dialects.v20 import ardupilotmega as dialect

from advisor.mavlink.wire.frames import FrameScanner
from tests.heard import hear
from tests.mavlink.builders import REPOSITORY, Sender, record

STEPS_S = (82.28, 113.34)
"""First elevator steps of the two manoeuvres in the part of the flight used here, s since boot."""
END_S = 125.0
NEEDLESS = ("GLOBAL_POSITION_INT", "RC_CHANNELS", "SYSTEM_TIME", "GPS_RAW_INT", "WIND")
YEAR_US = 31_557_600_000_000

Stamped = list[tuple[int, dialect.MAVLink_message]]


@cache
def flight() -> tuple[tuple[int, bytes], ...]:
    """Stamp in us and frame of every second record of a kind in the calm flight's first two manoeuvres."""
    log = (REPOSITORY / "logs" / "arduplane-calm.tlog").read_bytes()
    columns = FrameScanner().feed(log)
    attitude = next(c for c in columns if c.name == "ATTITUDE")
    end = int(attitude.order[np.searchsorted(attitude.fields["time_boot_ms"], END_S * 1000)])
    kept = [c.order[:: 2 if len(c) > 5000 else 1] for c in columns if c.name not in NEEDLESS]
    starts = np.sort(np.concatenate(kept)).tolist()
    return tuple(
        (struct.unpack(">Q", log[start - 8 : start])[0], log[start : start + 12 + log[start + 1]])
        for start in starts
        if start < end
    )


def messages() -> Stamped:
    """The flight's messages, to be changed as one likes."""
    decoder = dialect.MAVLink(None)
    return [(stamp, decoder.decode(bytearray(frame))) for stamp, frame in flight()]


@cache
def unchanged_messages() -> Stamped:
    return messages()


def untouched() -> bytes:
    return b"".join(record(frame, stamp) for stamp, frame in flight())


def with_a_ground_station() -> bytes:
    """Its heartbeats come first and all along, in the other direction."""
    station = Sender(255, 190)
    heartbeat = dialect.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3)
    log = b""
    for i, (stamp, frame) in enumerate(flight()):
        if i % 200 == 0:
            log += record(station.frame(heartbeat), stamp | 3)
        log += record(frame, stamp)
    return log


def with_another_vehicle() -> bytes:
    """The same flight flown again a minute later by system 2, on the same link."""
    other, later = Sender(2, 1), 4_000
    log = b""
    second = unchanged_messages()
    for i, (stamp, frame) in enumerate(flight()):
        log += record(frame, stamp)
        if i >= later:
            log += record(other.frame(second[i - later][1]), stamp)
    return log


def with_stamps_jumping_by_years() -> bytes:
    shifts = {0: 0, 1: -40 * YEAR_US, 2: 20 * YEAR_US}
    third = len(flight()) // 3 + 1
    return b"".join(record(frame, stamp + shifts[i // third]) for i, (stamp, frame) in enumerate(flight()))


def with_counters_wrapping() -> bytes:
    """The autopilot has been on for so long that its 32-bit counters of us wrap between the manoeuvres."""
    ahead_us = (1 << 32) - 100_000_000
    sender = Sender()
    log = b""
    for stamp, message in messages():
        if hasattr(message, "time_boot_ms"):
            message.time_boot_ms += ahead_us // 1000
        if message.get_type() in ("SERVO_OUTPUT_RAW", "AOA_SSA"):
            message.time_usec = (message.time_usec + ahead_us) % (1 << 32)
        if message.get_type() == "RAW_IMU":
            message.time_usec += ahead_us
        log += record(sender.frame(message), stamp)
    return log


def with_mavlink_1_mixed_in() -> bytes:
    sender = Sender()
    log = b""
    for i, (stamp, message) in enumerate(unchanged_messages()):
        log += record(sender.frame(message, 1 if i % 2 and message.get_msgId() < 256 else 2), stamp)
    return log


def with_garbage_and_holes() -> bytes:
    """Thirty times a hole of zeros or some garbage, but not during the manoeuvres."""
    rng = np.random.default_rng(1)
    records = [record(frame, stamp) for stamp, frame in flight()]
    quiet = np.concatenate([np.arange(800), np.arange(3600, 5600)])
    for i in rng.choice(quiet, 30, replace=False):
        records[i] = bytes(len(records[i])) if rng.random() < 0.5 else records[i] + rng.bytes(100)
    return b"".join(records)


@cache
def onsets(log: Callable[[], bytes]) -> tuple[float, ...]:
    scanner = FrameScanner()
    heard = hear([scanner.feed(log()) + scanner.close()], target_system=1)
    return tuple(maneuver.span.start_s for maneuver in heard.maneuvers)


def test_the_flight_itself_has_its_two_manoeuvres() -> None:
    assert onsets(untouched) == pytest.approx(STEPS_S, abs=0.1)


@pytest.mark.parametrize(
    "log",
    [
        with_a_ground_station,
        with_another_vehicle,
        with_stamps_jumping_by_years,
        with_mavlink_1_mixed_in,
        with_garbage_and_holes,
    ],
)
def test_company_and_disorder_change_no_manoeuvre(log: Callable[[], bytes]) -> None:
    assert onsets(log) == onsets(untouched)


def test_wrapping_counters_change_no_manoeuvre() -> None:
    ahead_s = ((1 << 32) - 100_000_000) // 1000 / 1000
    assert np.array(onsets(with_counters_wrapping)) - ahead_s == pytest.approx(onsets(untouched), abs=1e-3)


def test_a_reboot_begins_a_flight_of_its_own() -> None:
    assert onsets(lambda: untouched() + untouched()) == onsets(untouched) * 2
