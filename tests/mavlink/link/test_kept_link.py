"""A link in a process of its own: every reader hears everything, once and in order."""

import os
import signal
import time
from collections.abc import Iterator
from contextlib import nullcontext
from pathlib import Path

import pytest
from pymavlink.dialects.v20 import ardupilotmega as dialect

from advisor.flight.signals.messages import Columns
from advisor.mavlink.link import health, kept_link, link_process
from advisor.mavlink.link.kept_link import Keeping, KeptLink, new_door
from advisor.mavlink.link.link_process import LinkProcess
from advisor.mavlink.wire.frames import FrameScanner
from advisor.session.live import LinkSource
from advisor.words.problems import UnusableInputError
from tests.mavlink.link.builders import UdpVehicle, attitude, free_port, heartbeat, values, wait_until
from tests.mavlink.link.live import kill


@pytest.fixture(autouse=True)
def data(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))


@pytest.fixture
def process(tmp_path: Path) -> Iterator[LinkProcess]:
    with LinkProcess(keeping(free_port(), tmp_path / "a.tlog")) as process:
        yield process


@pytest.fixture
def vehicle(process: LinkProcess) -> Iterator[UdpVehicle]:
    vehicle = UdpVehicle(int(process.master.rpartition(":")[2]))
    vehicle.send(heartbeat())
    yield vehicle
    vehicle.close()


def keeping(port: int, recording: Path | None) -> Keeping:
    return Keeping(f"udpin:127.0.0.1:{port}", new_door(), record_to=recording)


def heard(link: KeptLink, count: int) -> list[float]:
    stamps: list[float] = []

    def read() -> bool:
        stamps.extend(values(link.read(0.05), "ATTITUDE", "time_boot_ms"))
        return len(stamps) >= count

    wait_until(read)
    return stamps


def test_a_reader_that_comes_late_hears_everything_once_and_in_order(process, vehicle):
    with process.link() as early, process.link() as late:
        vehicle.send(*(attitude(i) for i in range(300)))
        assert heard(early, 300) == list(range(300))
        vehicle.send(*(attitude(i) for i in range(300, 400)))
        assert heard(late, 400) == list(range(400))
        vehicle.send(*(attitude(i) for i in range(400, 500)))
        assert heard(early, 200) == list(range(300, 500))
        assert heard(late, 100) == list(range(400, 500))


def test_without_a_recording_a_late_reader_hears_the_parameters_that_arrived_before_it() -> None:
    with LinkProcess(keeping(free_port(), None)) as process, process.link() as early:
        vehicle = UdpVehicle(int(process.master.rpartition(":")[2]))
        function = dialect.MAVLink_param_value_message(b"SERVO2_FUNCTION", 19.0, 9, 1, 0)
        vehicle.send(heartbeat(), function, attitude(0))
        heard(early, 1)
        with process.link() as late:
            vehicle.send(attitude(1))
            columns: list[Columns] = []

            def both() -> bool:
                columns.extend(late.read(0.05))
                return values(columns, "ATTITUDE", "time_boot_ms") == [0, 1]

            wait_until(both)
        vehicle.close()
    assert values(columns, "PARAM_VALUE", "param_value") == [19.0]


def test_what_arrives_while_the_process_is_dead_is_heard_by_the_next_one(process, vehicle):
    with process.link() as link:
        vehicle.send(*(attitude(i) for i in range(100)))
        assert heard(link, 100) == list(range(100))
        time.sleep(0.1)
        kill(process.pid)
        vehicle.send(*(attitude(i) for i in range(100, 200)))
        assert heard(link, 100) == list(range(100, 200))
        said = " ".join(link.take_notices())
    assert "has ended and was started again; the recording goes on" in said


def test_after_a_restart_a_silent_vehicle_is_lost_and_not_unheard_of(process, vehicle):
    with process.link() as link:
        vehicle.send(*(attitude(i) for i in range(100)))
        heard(link, 100)
        wait_until(lambda: not link.read(0.05) and link.statistics.vehicle is not None)
        silent_from_s = time.monotonic()
        time.sleep(1.5)
        kill(process.pid)
        wait_until(lambda: not link.read(0.05) and "was started again" in str(link.take_notices()))
        wait_until(lambda: not link.read(0.05) and link.statistics.silent_s > 2.0)
        assert link.statistics.vehicle == (1, 1)
        assert time.monotonic() - silent_from_s == pytest.approx(link.statistics.silent_s, abs=0.6)
        source = LinkSource(nullcontext(link))
        source.read(0.0)
        assert source.health().condition == "lost"
        assert source.health().sentence.startswith("Nothing heard for ")


def test_a_process_that_hangs_is_told_of_and_replaced(process, vehicle, monkeypatch):
    monkeypatch.setattr(link_process, "HUNG_AFTER_S", 1.5)
    for module in (kept_link, health):
        monkeypatch.setattr(module, "OLD_AFTER_S", 0.5)
    with process.link() as link:
        vehicle.send(*(attitude(i) for i in range(100)))
        assert heard(link, 100) == list(range(100))
        hung = process.pid
        assert hung is not None
        os.kill(hung, signal.SIGSTOP)
        wait_until(lambda: not link.read(0.05) and link.statistics.unanswered_s >= 0.5)
        vehicle.send(*(attitude(i) for i in range(100, 200)))
        assert heard(link, 100) == list(range(100, 200))
        assert process.pid != hung
        wait_until(lambda: not link.read(0.05) and link.statistics.unanswered_s < 0.5)
        said = link.take_notices()
    assert "the process of the link has not answered for 0 s" in said
    assert "the process of the link answers again" in said


def test_a_connection_that_cannot_be_opened_is_refused_with_what_to_do(tmp_path: Path) -> None:
    port = free_port()
    with (
        LinkProcess(keeping(port, None)),
        pytest.raises(UnusableInputError, match="no other program uses it"),
        LinkProcess(keeping(port, None)),
    ):
        pass


def test_the_recording_is_whole_after_an_orderly_end(tmp_path: Path) -> None:
    process = LinkProcess(keeping(free_port(), tmp_path / "b.tlog"))
    with process, process.link() as link:
        vehicle = UdpVehicle(int(process.master.rpartition(":")[2]))
        vehicle.send(heartbeat(), *(attitude(i) for i in range(50)))
        heard(link, 50)
    vehicle.close()
    replayed = FrameScanner().feed((tmp_path / "b.tlog").read_bytes())
    assert values(replayed, "ATTITUDE", "time_boot_ms") == list(range(50))
