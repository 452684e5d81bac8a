"""An estimator that falls behind the link says so on every face, and the state of the link stays new."""

import re
import time
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from functools import partial
from pathlib import Path
from threading import Thread

import pytest
from pymavlink.dialects.v20 import ardupilotmega as dialect

from advisor.campaign.hand_decisions import ByHand
from advisor.cli import narrator
from advisor.mavlink.link.health import LinkStatistics
from advisor.mavlink.link.keeping import Keeping, new_door
from advisor.mavlink.link.link_process import LinkProcess
from advisor.mavlink.link.motion_now import MotionNow
from advisor.mavlink.link.observer import LinkObserver
from advisor.mavlink.wire.framing import CRC_EXTRA, FrameCutter
from advisor.session.behind import BehindTeller
from advisor.session.conducting import SessionReport
from advisor.session.live import LinkSource, recording_line, renewed
from advisor.session.remote import ConductorTask, RemoteConductor
from advisor.session.source import LinkHealth
from advisor.tui.advice import advise
from advisor.tui.panes.crew_notes import flying_in_words
from advisor.tui.panes.limits_now import limits_now
from tests.mavlink.link.builders import Sender, UdpVehicle, attitude, free_port, heartbeat
from tests.tui import elsewhere, flights
from tests.tui.stage import stage
from tests.tui.stand_ins import HandFedSource
from tests.tui.test_pilot_screen import view

SAID = re.compile(r"this computer is \d+ s behind")
HEARD = LinkStatistics(connected=True, vehicle=(1, 1), messages_per_s=400.0, newest_s=1000.0)


@pytest.fixture
def process(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[LinkProcess]:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    keeping = Keeping(
        f"udpin:127.0.0.1:{free_port()}", new_door(), 254, record_to=tmp_path / "a.tlog", announce=True
    )
    with LinkProcess(keeping) as process:
        yield process


@pytest.fixture
def vehicle(process: LinkProcess) -> Iterator[UdpVehicle]:
    """A vehicle that sends its attitude ten times a second until the test is over."""
    vehicle = UdpVehicle(int(process.master.rpartition(":")[2]))
    flying = [True]

    def fly() -> None:
        while flying:
            vehicle.send(heartbeat(), attitude(int(1000.0 * time.monotonic()) % 2**31))
            time.sleep(0.1)

    thread = Thread(target=fly)
    thread.start()
    yield vehicle
    flying.clear()
    thread.join()
    vehicle.close()


def task(process: LinkProcess) -> ConductorTask:
    return ConductorTask(partial(LinkSource, process.link()), elsewhere.slow, kept=ByHand, door=process.door)


def test_the_screens_are_told_of_a_slow_estimator_while_the_link_stays_new(
    process: LinkProcess, vehicle: UdpVehicle
) -> None:
    conductor = RemoteConductor(task(process))
    reports: list[SessionReport] = []

    def tell(report: SessionReport) -> None:
        reports.append(report)
        if report.health.behind_s > 4.0:
            conductor.stop()

    conductor.run(tell)
    behind = [report.health for report in reports if report.health.behind]
    assert SAID.fullmatch(behind[0].behind)
    within_one_estimate = {health.behind_s for health in behind if health.read_to_s == behind[0].read_to_s}
    assert len(within_one_estimate) > 2
    assert {health.condition for health in behind} == {"good"}
    assert all(health.alarm == health.behind for health in behind)
    links = [health.link for health in behind]
    assert all(link is not None for link in links)
    assert links[-1].messages > links[0].messages  # type: ignore[union-attr]
    assert behind[-1].recording == recording_line(links[-1])  # type: ignore[arg-type]


def test_text_and_ground_station_are_told_of_a_slow_estimator(
    process: LinkProcess, vehicle: UdpVehicle
) -> None:
    warned: list[str] = []
    backlog = narrator.Backlog(warned.append)
    backlog.read_to_s = time.time() - 10.0
    announced = ""
    give_up_s = time.monotonic() + 60.0
    with LinkObserver(process.door, backlog.hear_link) as backlog.observer:
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


def test_the_word_gives_way_to_the_backlog_and_no_old_value_stands_as_new() -> None:
    state = flights.state(5, in_the_air=True)
    assert advise(view(state, UP_TO_DATE)).word != "BEHIND"
    late = view(state, behind(UP_TO_DATE))
    assert advise(late).word == "BEHIND"
    assert advise(late).sentence.startswith("This computer is 130 s behind: ")
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


def test_a_link_whose_recording_is_still_read_is_not_called_behind() -> None:
    reading = LinkHealth("waiting", "The recording so far is being read.", link=HEARD)
    assert not behind(reading).behind
    assert behind(reading).sentence == reading.sentence


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
