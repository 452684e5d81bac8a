"""Packets that come by two paths: the union is kept, and each packet counts once."""

import struct
from pathlib import Path

import numpy as np
import pytest
from pymavlink.dialects.v20 import ardupilotmega as dialect

from advisor.aircraft.aircraft import Aircraft
from advisor.campaign.campaign import Campaign
from advisor.campaign.state import CampaignState
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.mavlink.logs.logs import open_log
from advisor.mavlink.wire.frames import FrameScanner
from tests.flights import TWO, recorded
from tests.heard import hear_log
from tests.mavlink.builders import START_US, Sender, one_by_one, record
from tests.mavlink.paths import Way, heard_over, records

KEY = bytes(range(32))


@pytest.fixture(scope="module")
def log() -> Path:
    return recorded("uav", 1.0, maneuvers=TWO)


@pytest.fixture(scope="module")
def once(log: Path) -> CampaignState:
    """The campaign of the log as it came by one path."""
    return analyzed(log)


def scanned(log: bytes, **options: bytes) -> tuple[list[object], FrameScanner]:
    scanner = FrameScanner(**options)
    return one_by_one(scanner.feed(log) + scanner.close()), scanner


def analyzed(path: Path) -> CampaignState:
    campaign = Campaign(Aircraft())
    for columns in open_log(path):
        campaign.feed(columns)
    campaign.finish()
    return campaign.state


def flown(log: Path) -> list[Maneuver]:
    """The manoeuvres of a log; what is estimated and judged follows from their samples alone."""
    return hear_log(log).maneuvers


def samples(maneuvers: list[Maneuver]) -> list[np.ndarray]:
    """Stamps and values of every channel of every manoeuvre, one channel after the other."""
    return [
        np.r_[channel.t, channel.y]
        for maneuver in maneuvers
        for _, channel in sorted(maneuver.channels.items())
    ]


@pytest.mark.parametrize("late_s", [0.05, 6.0, 15.0])
def test_a_path_that_only_repeats_changes_no_number(log, once, tmp_path, late_s):
    path = tmp_path / "two.tlog"
    path.write_bytes(heard_over(log, Way(), Way(late_s)))
    alone = [judged.maneuver for judged in once.maneuvers]
    twice = flown(path)
    assert [m.span for m in twice] == [m.span for m in alone]
    assert [m.channels.keys() for m in twice] == [m.channels.keys() for m in alone]
    for ours, theirs in zip(samples(twice), samples(alone), strict=True):
        np.testing.assert_array_equal(ours, theirs)


@pytest.mark.parametrize("late_s", [2.5, 15.0])
def test_a_late_path_that_loses_differently_neither_reboots_the_vehicle_nor_smears(
    log: Path, once: CampaignState, tmp_path: Path, late_s: float
) -> None:
    path = tmp_path / "two.tlog"
    path.write_bytes(heard_over(log, Way(loss=0.05), Way(late_s, loss=0.1)))
    state = analyzed(path)
    assert [j.verdict.accepted for j in state.maneuvers] == [j.verdict.accepted for j in once.maneuvers]
    assert not any("reboot" in notice for notice in state.notices)


def test_of_two_paths_side_by_side_the_union_is_kept(log: Path) -> None:
    sent, _ = scanned(log.read_bytes())
    heard, scanner = scanned(heard_over(log, Way(loss=0.2), Way(0.05, loss=0.2)))
    assert len(heard) == pytest.approx(0.96 * len(sent), rel=0.01)
    received = scanner.statistics.senders[1, 1]
    assert received.repeated == pytest.approx(0.64 * len(sent), rel=0.02)
    assert received.repeated_after_s == pytest.approx(0.05, abs=0.01)
    assert received.late > 0


def test_when_the_first_path_falls_silent_the_late_one_goes_on_without_a_gap(log: Path) -> None:
    silent_from_s = 20.0
    sent = list(records(log.read_bytes()))
    heard, _ = scanned(heard_over(log, Way(silent_s=(silent_from_s, 1e4)), Way(6.0)))
    known, _ = scanned(log.read_bytes())
    assert sent[-1][0] - sent[0][0] > 1e6 * (silent_from_s + 10.0)
    assert len(known) <= len(heard) <= len(known) + 8


def test_one_path_with_losses_keeps_every_packet_though_numbers_and_heartbeats_return() -> None:
    rng = np.random.default_rng(3)
    sender, sent = Sender(), []
    for i in range(10_000):
        message = (
            dialect.MAVLink_heartbeat_message(1, 3, 81, 0, 4, 3)
            if i % 51 == 0
            else dialect.MAVLink_attitude_message(i, 0.0, 0.1, 0.0, 0.0, 0.0, 0.0)
        )
        sent.append(record(sender.frame(message), START_US + 20_000 * i))
    kept = [frame for frame, lost in zip(sent, rng.random(len(sent)) < 0.1, strict=True) if not lost]
    assert len(scanned(b"".join(kept))[0]) == len(kept)


@pytest.mark.parametrize(("version", "key"), [(1, None), (2, None), (2, KEY)])
def test_repeats_are_known_in_every_version_and_signed(version: int, key: bytes | None) -> None:
    sender = Sender(key=key)
    if key:
        sender.set_signing_time(1_000_000)
    frames = [
        sender.frame(dialect.MAVLink_attitude_message(20 * i, 0.0, 0.1, 0.0, 0.0, 0.0, 0.0), version)
        for i in range(1000)
    ]
    stamped = [(START_US + 20_000 * i, frame) for i, frame in enumerate(frames)]
    stamped += [(stamp_us + 4_000_000, frame) for stamp_us, frame in stamped]
    log = b"".join(struct.pack(">Q", stamp_us) + frame for stamp_us, frame in sorted(stamped))
    heard, scanner = scanned(log)
    assert 1000 <= len(heard) <= 1007
    assert scanner.statistics.senders[1, 1].repeated == 1000
    if key:
        signed, judged = scanned(log, key=key)
        assert len(signed) == 1000
        assert judged.statistics.refused == {"replayed": 7}


def test_how_a_log_of_two_paths_is_cut_into_pieces_does_not_matter(log: Path) -> None:
    heard = heard_over(log, Way(loss=0.1), Way(6.0, loss=0.1))
    whole, pieces = FrameScanner(), FrameScanner()
    at_once = one_by_one(whole.feed(heard) + whole.close())
    found = [c for i in range(0, len(heard), 999) for c in pieces.feed(heard[i : i + 999])] + pieces.close()
    assert one_by_one(found) == at_once
    assert pieces.statistics == whole.statistics


def test_two_batteries_in_one_log_are_two_power_ons_though_the_stations_clock_was_set_back(log, tmp_path):
    both = tmp_path / "both.tlog"
    both.write_bytes(log.read_bytes() + recorded("uav", 1.0, seed=12, maneuvers=TWO).read_bytes())
    maneuvers = flown(both)
    assert [m.boot for m in maneuvers] == [0, 0, 1, 1]
    assert [m.number for m in maneuvers] == [1, 2, 3, 4]


def test_a_log_that_two_overlapping_logs_were_joined_to_counts_each_manoeuvre_once(log, once, tmp_path):
    joined = tmp_path / "joined.tlog"
    joined.write_bytes(log.read_bytes() + log.read_bytes())
    twice = analyzed(joined)
    assert once.model is not None
    assert twice.model is not None
    assert len(twice.maneuvers) == len(once.maneuvers)
    assert np.array_equal(twice.model.covariance, once.model.covariance)
