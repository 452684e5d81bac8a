"""An estimator that falls behind the link says so on every face, and the state of the link stays new."""

import re
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from threading import Thread

import pytest
from pymavlink.dialects.v20 import ardupilotmega as dialect

from advisor.aircraft.aircraft import Aircraft
from advisor.campaign.state import ByHand
from advisor.cli import narrator
from advisor.mavlink.link.health import LinkStatistics
from advisor.mavlink.link.kept_link import Keeping, new_door
from advisor.mavlink.link.link import MotionNow
from advisor.mavlink.link.link_process import LinkProcess
from advisor.mavlink.link.observer import LinkObserver
from advisor.mavlink.wire.framing import CRC_EXTRA, FrameCutter
from advisor.session import live
from advisor.session.behind import BehindTeller
from advisor.session.conducting import LinkHealth, SessionReport, report_before_first
from advisor.session.live import LinkSource, recording_line, renewed
from advisor.session.remote import ConductorTask, RemoteConductor
from advisor.tui.advice import advise
from advisor.tui.panes.pilot import flying_in_words
from advisor.tui.screens.pilot import limits_now
from tests.mavlink.link.builders import Sender, UdpVehicle, free_port, heartbeat
from tests.tui import elsewhere, flights
from tests.tui.stage import stage
from tests.tui.stand_ins import HandFedSource
from tests.tui.test_pilot_screen import view

SAID = re.compile(r"this computer is \d+ s behind")
FAST = dialect.MAVLink_vfr_hud_message(22.0, 0.0, 0, 0, 0.0, 0.0)
HEARD = LinkStatistics(connected=True, vehicle=(1, 1), messages_per_s=400.0, newest_s=1000.0)


@contextmanager
def flown(folder: Path) -> Iterator[tuple[LinkProcess, UdpVehicle]]:
    """The process of a link, and a vehicle that sends ten times a second until the context ends."""
    keeping = Keeping(
        f"udpin:127.0.0.1:{free_port()}", new_door(), record_to=folder / "a.tlog", announce=True
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_DATA_HOME", str(folder / "data"))
        with LinkProcess(keeping) as process:
            vehicle = UdpVehicle(int(process.master.rpartition(":")[2]))
            flying = [True]

            def fly() -> None:
                while flying:
                    now_ms = int(1000.0 * time.monotonic()) % 2**31
                    banked = dialect.MAVLink_attitude_message(now_ms, 0.6, 0.1, 0.0, 0.0, 0.0, 0.0)
                    vehicle.send(heartbeat(), banked, FAST)
                    time.sleep(0.1)

            thread = Thread(target=fly)
            thread.start()
            yield process, vehicle
            flying.clear()
            thread.join()
            vehicle.close()


@dataclass(frozen=True)
class Halted:
    """What the screens were told while an estimator halted twice. Times are host times, s."""

    told: tuple[tuple[float, SessionReport], ...]
    linked_s: float
    judged_s: float
    halted_s: float

    def between(self, begin_s: float, end_s: float) -> list[LinkHealth]:
        return [report.health for at_s, report in self.told if begin_s < at_s < end_s]


@pytest.fixture(scope="module")
def halted(tmp_path_factory: pytest.TempPathFactory) -> Halted:
    """A link whose estimator takes 3 s before its first batch, and stands still for 4 s after 2 s."""
    folder = tmp_path_factory.mktemp("halted")
    note = folder / "halted"
    told: list[tuple[float, SessionReport]] = []

    def tell(report: SessionReport) -> None:
        told.append((time.time(), report))
        if note.exists() and time.time() > float(note.read_text().split()[1]) + 6.5:
            conductor.stop()

    with flown(folder) as (process, _):
        linked_s = time.time()
        source, campaign = partial(LinkSource, process.link()), partial(elsewhere.halting, note)
        first = report_before_first(Aircraft(), "a link")
        task = ConductorTask(source, campaign, kept=ByHand, door=process.door, first=first)
        conductor = RemoteConductor(task)
        conductor.run(tell)
    return Halted(tuple(told), linked_s, *map(float, note.read_text().split()))


def test_before_its_estimator_has_begun_a_link_shows_counts_recording_bank_and_speed(halted: Halted) -> None:
    opening = halted.between(halted.linked_s + 1.0, halted.linked_s + 1.8)[-1]
    assert (opening.condition, opening.behind) == ("good", "")
    assert opening.recording.startswith("REC ")
    assert dict(opening.figures)["messages"].endswith("/s)")
    shown = limits_now(replace(view(flights.state(0), opening), state=halted.told[0][1].state))
    assert "✗ bank 34 deg" in shown
    assert "V 22 m/s" in shown


def test_an_estimator_that_has_not_begun_is_behind_by_the_age_of_the_link(halted: Halted) -> None:
    opening = halted.between(halted.linked_s, halted.linked_s + 3.0)
    assert SAID.fullmatch(opening[-1].behind)
    assert opening[-1].behind_s == pytest.approx(3.0, abs=0.8)


def test_a_word_comes_once_the_estimator_is_more_than_two_seconds_behind(halted: Halted) -> None:
    said_s = [at_s - halted.halted_s for at_s, report in halted.told if report.health.behind]
    assert 1.5 < min(after_s for after_s in said_s if after_s > 0.0) < 3.5


def test_no_word_comes_while_the_estimator_is_not_behind(halted: Halted) -> None:
    before = halted.between(halted.judged_s + 1.0, halted.halted_s + 1.5)
    after = halted.between(halted.halted_s + 5.5, halted.halted_s + 6.5)
    assert len(before) > 5
    assert len(after) > 2
    assert {health.behind for health in (*before, *after)} == {""}


def test_the_link_stays_new_while_its_estimator_stands_still(halted: Halted) -> None:
    behind = halted.between(halted.halted_s + 2.3, halted.halted_s + 3.8)
    assert {health.condition for health in behind} == {"good"}
    assert all(health.alarm == health.behind for health in behind)
    links = [health.link for health in behind]
    assert all(link is not None for link in links)
    assert links[-1].messages > links[0].messages + 15  # type: ignore[union-attr]
    assert behind[-1].recording == recording_line(links[-1])  # type: ignore[arg-type]


def test_text_and_ground_station_are_told_of_a_slow_estimator(tmp_path: Path) -> None:
    warned: list[str] = []
    backlog = narrator.Backlog(warned.append)
    backlog.read_to_s = time.time() - 10.0
    announced = ""
    give_up_s = time.monotonic() + 60.0
    with (
        flown(tmp_path) as (process, vehicle),
        LinkObserver(process.door, backlog.hear_link) as backlog.observer,
    ):
        while "behind" not in announced and time.monotonic() < give_up_s:
            with suppress(TimeoutError):
                message = vehicle.hear()
                announced = message.text if message.get_type() == "STATUSTEXT" else ""
    assert SAID.search(announced)
    assert re.fullmatch(f"{SAID.pattern}: the newest line above is that old", warned[0])


def behind(health: LinkHealth) -> LinkHealth:
    """The health after 130 s in which the campaign was given nothing."""
    link = health.link or HEARD
    return renewed(health, replace(link, newest_s=link.newest_s + 130.0, bank_rad=0.6, airspeed_m_s=31.0))


UP_TO_DATE = LinkHealth("good", "400 messages/s.", link=HEARD, read_to_s=1000.0)


def test_nothing_is_in_the_air_once_the_log_has_ended() -> None:
    state = flights.state(5, in_the_air=True)
    assert flying_in_words(view(state, UP_TO_DATE)).startswith("flown ")
    ended = view(state, replace(UP_TO_DATE, condition="ended"))
    assert flying_in_words(ended) == "nothing: the log has ended"


def test_the_word_stays_with_its_age_and_no_old_value_stands_as_new() -> None:
    state = flights.state(5, in_the_air=True)
    now = advise(view(state, UP_TO_DATE))
    late = view(state, behind(UP_TO_DATE))
    assert advise(late) == replace(now, age="130 s old")
    none = advise(view(flights.state(0), behind(UP_TO_DATE)))
    assert none.word == "BEHIND"
    assert none.sentence.startswith("This computer is 130 s behind: ")
    assert flying_in_words(late) == "not known: this computer is 130 s behind"
    assert "✗ bank 34 deg" in limits_now(late)
    assert "V 31 m/s" in limits_now(late)
    assert "α" not in limits_now(late)


async def test_both_screens_say_it() -> None:
    async with stage(flights.state(3), size=(120, 40)) as on:
        assert isinstance(on.source, HandFedSource)
        on.source.condition = behind(UP_TO_DATE)
        on.source.deliver()
        await on.until(lambda: on.app.view.health.behind != "")
        for key in ("p", "e"):
            await on.press(key)
            page = on.page()
            assert "✓ link good  ·  ✗ 130 s BEHIND" in page
            assert "✗ this computer is 130 s behind" in page


def test_a_link_from_which_nothing_was_read_is_new_and_its_backlog_is_as_old_as_the_link() -> None:
    opening = LinkHealth("waiting", "Opening the connection.")
    assert renewed(opening, HEARD).behind == ""
    late = renewed(opening, replace(HEARD, first_s=990.0))
    assert (late.condition, late.behind) == ("good", "this computer is 10 s behind")


def test_the_counts_of_the_decoder_outlast_newer_counts_of_the_link() -> None:
    known = replace(UP_TO_DATE, link=replace(HEARD, vehicle_messages=90, lost=10))
    assert renewed(known, HEARD).sentence == "10 % of the packets are lost."


def test_lines_of_text_tell_of_a_backlog_once_then_at_each_doubling_and_at_its_end() -> None:
    teller = BehindTeller()
    said = [teller.hear(behind_s) for behind_s in (0.1, 2.5, 3.0, 4.9, 5.1, 1.5, 0.9, 0.1)]
    assert said == [
        "",
        "this computer is 2 s behind",
        "",
        "",
        "this computer is 5 s behind",
        "",
        "this computer is up to date again",
        "",
    ]


def test_bank_and_air_speed_are_read_from_the_frames_of_the_vehicle_alone() -> None:
    banked = dialect.MAVLink_attitude_message(1, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0)
    fast = dialect.MAVLink_vfr_hud_message(22.0, 0.0, 0, 0, 0.0, 0.0)
    mine, other = Sender(), Sender(system=2)
    motion = MotionNow()
    motion.look(FrameCutter(CRC_EXTRA).feed(mine.pack(banked) + mine.pack(fast)), 1)
    slow = dialect.MAVLink_vfr_hud_message(5.0, 0.0, 0, 0, 0.0, 0.0)
    motion.look(FrameCutter(CRC_EXTRA).feed(other.pack(slow)), 1)
    assert (motion.bank_rad, motion.airspeed_m_s) == (0.5, 22.0)


def test_the_recording_is_told_with_its_size_and_the_free_disk(tmp_path: Path, monkeypatch) -> None:
    usage = type("Usage", (), {"free": 41_400_000_000})
    monkeypatch.setattr(live, "disk_usage", lambda folder: usage)
    link = LinkStatistics(recording=tmp_path / "x.tlog", recorded_bytes=3_240_000)
    assert live.recording_line(link) == "REC 3.2 MB, 41 GB free"
    usage.free = 900_000_000
    assert live.recording_line(link) == "REC 3.2 MB, 0.9 GB free"


def test_a_link_without_a_recording_says_so() -> None:
    assert live.recording_line(LinkStatistics()) == "NOT RECORDED"


def test_a_recording_that_the_disk_refuses_is_no_recording(tmp_path: Path) -> None:
    link = LinkStatistics(recording=tmp_path / "x.tlog", recording_problem="the disk is full")
    assert live.recording_line(link) == "REC STOPPED at 0.0 MB"
