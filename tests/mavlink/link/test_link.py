import os
import pty
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from pymavlink.dialects.v20 import ardupilotmega as dialect

from advisor.flight.signals.messages import Columns
from advisor.mavlink.link.link import Link
from advisor.mavlink.link.link_watch import RateWatch
from advisor.mavlink.wire.frames import FrameScanner
from advisor.mavlink.wire.framing import Frame
from advisor.words.problems import UnusableInputError
from tests.mavlink.link.builders import (
    Sender,
    UdpVehicle,
    attitude,
    attitude_at,
    free_port,
    heartbeat,
    read_all,
    values,
    wait_until,
)


@pytest.fixture
def port() -> int:
    return free_port()


@pytest.fixture
def vehicle(port: int) -> Iterator[UdpVehicle]:
    vehicle = UdpVehicle(port)
    yield vehicle
    vehicle.close()


def notices(link: Link) -> str:
    return "; ".join(link.take_notices())


def stamps(columns: list[Columns]) -> list[float]:
    return values(columns, "ATTITUDE", "time_boot_ms")


def same(a: list[Columns], b: list[Columns]) -> bool:
    def table(columns: list[Columns]) -> dict[tuple[str, int, int], dict[str, np.ndarray]]:
        merged: dict[tuple[str, int, int], dict[str, list[np.ndarray]]] = {}
        for part in columns:
            into = merged.setdefault((part.name, part.system, part.component), {})
            for name, column in {**part.fields, "order": part.order, "arrival_s": part.arrival_s}.items():
                into.setdefault(name, []).append(column)
        return {k: {n: np.concatenate(c) for n, c in fields.items()} for k, fields in merged.items()}

    ta, tb = table(a), table(b)
    return ta.keys() == tb.keys() and all(
        np.array_equal(ta[key][name], tb[key][name]) for key in ta for name in ta[key]
    )


def test_what_is_heard_live_is_what_the_recording_replays(port, vehicle, tmp_path):
    with Link(f"udpin:127.0.0.1:{port}", record_to=tmp_path / "own.tlog") as link:
        for i in range(200):
            vehicle.send(attitude(20 * i), *([heartbeat()] if i % 50 == 0 else []))
        live = read_all(link)
    replayed = FrameScanner().feed((tmp_path / "own.tlog").read_bytes())
    assert stamps(live) == [20.0 * i for i in range(200)]
    assert same(live, replayed)


def test_the_system_may_choose_the_port() -> None:
    with Link("udpin:127.0.0.1:0") as link:
        assert link.port
        chosen = UdpVehicle(link.port)
        chosen.send(heartbeat(), attitude(20))
        wait_until(lambda: 20.0 in stamps(link.read()))
        chosen.close()


def test_a_passive_link_sends_nothing(port: int, vehicle: UdpVehicle) -> None:
    vehicle.socket.settimeout(1.2)
    with Link(f"udpin:127.0.0.1:{port}") as link:
        vehicle.send(heartbeat(), attitude(1))
        read_all(link)
        with pytest.raises(TimeoutError):
            vehicle.hear()


def test_a_link_that_must_speak_first_greets_and_is_answered() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as listener:
        listener.bind(("127.0.0.1", 0))
        listener.settimeout(5.0)
        with Link(f"udpout:127.0.0.1:{listener.getsockname()[1]}") as link:
            data, peer = listener.recvfrom(2048)
            greeting = dialect.MAVLink(None).decode(bytearray(data))
            assert greeting.get_type() == "HEARTBEAT"
            assert greeting.type == dialect.MAV_TYPE_GCS
            assert greeting.get_srcSystem() == 254
            assert "heartbeat once a second" in notices(link)
            listener.sendto(Sender().pack(attitude(40)), peer)
            wait_until(lambda: stamps(link.read()) == [40.0])


def test_frames_are_cut_out_of_a_tcp_stream_and_a_lost_connection_comes_back() -> None:
    with (
        socket.create_server(("127.0.0.1", 0)) as server,
        Link(f"tcp:127.0.0.1:{server.getsockname()[1]}") as link,
    ):
        sender = Sender()
        first, _ = server.accept()
        stream = b"".join(sender.pack(m) for m in (heartbeat(), *(attitude(20 * i) for i in range(30))))
        for i in range(0, len(stream), 17):
            first.sendall(stream[i : i + 17])
        assert stamps(read_all(link)) == [20.0 * i for i in range(30)]
        first.close()
        second, _ = server.accept()
        second.sendall(sender.pack(attitude(1000)))
        wait_until(lambda: stamps(link.read()) == [1000.0])
        told = notices(link)
        assert "connection lost (closed by the other side)" in told
        assert "reconnected after" in told
        assert link.statistics.reconnects == 1
        second.close()


def test_a_waiting_tcp_link_takes_one_caller_after_the_other() -> None:
    with Link("tcpin:127.0.0.1:0") as link:
        assert link.port
        for stamp in (100, 200):
            with socket.create_connection(("127.0.0.1", link.port), timeout=5.0) as caller:
                caller.sendall(Sender().pack(heartbeat()) + Sender().pack(attitude(stamp)))
                wait_until(lambda stamp=stamp: float(stamp) in stamps(link.read()))  # type: ignore[misc]
        assert link.statistics.reconnects == 1


def test_a_serial_line_is_read_and_its_cable_may_be_pulled_and_plugged_in_again(tmp_path: Path) -> None:
    device = tmp_path / "ttyUSB0"

    def plug_in() -> tuple[int, int]:
        far, near = pty.openpty()
        device.unlink(missing_ok=True)
        device.symlink_to(os.ttyname(near))
        return far, near

    far, near = plug_in()
    sender = Sender()
    with Link(f"serial://{device}:57600") as link:
        os.write(far, b"\x00\x01boot noise" + sender.pack(heartbeat()) + sender.pack(attitude(60)))
        wait_until(lambda: stamps(link.read()) == [60.0])
        os.close(near)
        os.close(far)
        wait_until(lambda: not link.statistics.connected)
        assert "connection lost" in notices(link)
        far, near = plug_in()
        wait_until(lambda: link.statistics.connected)
        os.write(far, sender.pack(attitude(9000)))
        wait_until(lambda: stamps(link.read()) == [9000.0])
        assert "reconnected after" in notices(link)
    os.close(near)
    os.close(far)


def test_a_local_socket_is_a_link_too(tmp_path: Path) -> None:
    with socket.socket(socket.AF_UNIX) as server:
        server.bind(str(tmp_path / "mavlink.sock"))
        server.listen(1)
        with Link(f"uds:{tmp_path / 'mavlink.sock'}") as link:
            caller, _ = server.accept()
            with caller:
                caller.sendall(Sender().pack(heartbeat()) + Sender().pack(attitude(40)))
                wait_until(lambda: stamps(link.read()) == [40.0])


def test_silence_is_told_once_and_so_is_its_end(port, vehicle, monkeypatch):
    monkeypatch.setattr("advisor.mavlink.link.link_watch.SILENCE_S", 0.3)
    with Link(f"udpin:127.0.0.1:{port}") as link:
        vehicle.send(heartbeat(), attitude(0))
        read_all(link)
        time.sleep(0.6)
        assert notices(link).count("silent for") == 1
        assert link.statistics.silent_s > 0.3
        vehicle.send(attitude(900))
        read_all(link)
        assert "heard again after" in notices(link)
        assert link.statistics.silent_s < 0.5


def test_another_station_talking_on_does_not_hide_that_the_vehicle_is_silent(port, vehicle, monkeypatch):
    monkeypatch.setattr("advisor.mavlink.link.link_watch.SILENCE_S", 0.3)
    station = UdpVehicle(port, system=255)
    with Link(f"udpin:127.0.0.1:{port}") as link:
        vehicle.send(heartbeat(), attitude(0))
        for _ in range(12):
            station.send(heartbeat(dialect.MAV_TYPE_GCS, dialect.MAV_AUTOPILOT_INVALID))
            time.sleep(0.05)
        assert "vehicle 1 is silent" in notices(link)
    station.close()


def test_a_stream_cut_by_another_station_is_noticed_and_so_is_its_return() -> None:
    watch = RateWatch()
    said = []
    for tick in range(60 * 50):
        now_s = tick / 50
        if now_s < 20.0 or now_s > 40.0 or tick % 12 == 0:
            said += [(now_s, text) for text in watch.look(attitude_at(now_s), now_s)]
        if tick % 50 == 0:
            said += [(now_s, text) for text in watch.look([Frame(b"", 0, 0, 1, 1, False)], now_s)]
    (fell_s, fell), (back_s, back) = said
    assert "ATTITUDE fell from 50 Hz to" in fell
    assert 20.0 < fell_s < 27.0
    assert back == "ATTITUDE is back at 50 Hz"
    assert 40.0 < back_s < 47.0


def test_a_silence_is_not_mistaken_for_a_slower_stream() -> None:
    watch = RateWatch()
    for tick in range(60 * 50):
        now_s = tick / 50
        if not 20.0 < now_s < 31.0:
            assert watch.look(attitude_at(now_s), now_s) == []


def test_a_process_killed_without_warning_leaves_whole_records_up_to_its_last_second(port, vehicle, tmp_path):
    own = tmp_path / "own.tlog"
    program = (
        "import sys, pathlib; from advisor.mavlink.link.link import Link\n"
        f"with Link('udpin:127.0.0.1:{port}', record_to=pathlib.Path(sys.argv[1])) as link:\n"
        "    print('listening', flush=True)\n"
        "    while True: link.read()\n"
    )
    process = subprocess.Popen([sys.executable, "-c", program, str(own)], stdout=subprocess.PIPE)
    try:
        assert process.stdout is not None
        assert process.stdout.readline() == b"listening\n"
        began = time.monotonic()
        for i in range(125):
            vehicle.send(attitude(20 * i))
            time.sleep(max(0.0, began + 0.02 * (i + 1) - time.monotonic()))
    finally:
        process.kill()
        process.communicate()
    kept = stamps(FrameScanner().feed(own.read_bytes()))
    assert kept == [20.0 * i for i in range(len(kept))]
    assert len(kept) >= 125 - 50


def test_losses_duplicates_and_late_packets_are_counted_by_sequence_number(port, vehicle):
    packets = [vehicle.pack(heartbeat())] + [vehicle.pack(attitude(20 * i)) for i in range(300)]
    order = [*range(100), 99, *range(103, 200), 201, 200, *range(202, 301)]
    with Link(f"udpin:127.0.0.1:{port}") as link:
        for i in order:
            vehicle.send_raw(packets[i])
        assert len(stamps(read_all(link))) == len(order) - 1
        seen = link.statistics
    assert (seen.lost, seen.repeated, seen.late) == (3, 1, 1)
    assert seen.lost_percent == pytest.approx(100 * 3 / (len(order) - 1 + 3))


def test_the_first_autopilot_is_the_vehicle_and_a_second_one_is_named(port: int, vehicle: UdpVehicle) -> None:
    station, other = UdpVehicle(port, system=255), UdpVehicle(port, system=9)
    with Link(f"udpin:127.0.0.1:{port}") as link:
        station.send(heartbeat(dialect.MAV_TYPE_GCS, dialect.MAV_AUTOPILOT_INVALID))
        vehicle.send(heartbeat())
        wait_until(lambda: link.statistics.vehicle is not None)
        other.send(heartbeat())
        read_all(link)
        assert link.statistics.vehicle == (1, 1)
        assert "vehicle 9 is heard too and ignored; choose with --target-system" in notices(link)
    with Link(f"udpin:127.0.0.1:{port}", target_system=9) as link:
        vehicle.send(heartbeat())
        other.send(heartbeat())
        read_all(link)
        assert link.statistics.vehicle == (9, 1)
    station.close()
    other.close()


def test_with_a_key_only_what_the_vehicle_signed_is_heard_and_recorded(port: int, tmp_path: Path) -> None:
    key = bytes(range(32))
    genuine, intruder = UdpVehicle(port, key=key), UdpVehicle(port)
    with Link(f"udpin:127.0.0.1:{port}", key=key, record_to=tmp_path / "own.tlog") as link:
        first = genuine.pack(attitude(20))
        genuine.send(heartbeat())
        genuine.send_raw(first)  # packed before the heartbeat: its signature is older now
        intruder.send(attitude(40))
        again = genuine.pack(attitude(60))
        genuine.send_raw(again)
        genuine.send_raw(again)
        intruder.send(dialect.MAVLink_radio_status_message(100, 90, 80, 10, 10, 0, 0))
        heard = read_all(link)
        assert stamps(heard) == [60.0]
        assert values(heard, "RADIO_STATUS", "rssi") == [100.0]
        assert link.statistics.refused == {"unsigned": 1, "replayed": 2}
        told = notices(link)
        assert "unsigned packets are refused" in told
        assert "with an old time are refused" in told
    recorded = FrameScanner().feed((tmp_path / "own.tlog").read_bytes())
    assert stamps(recorded) == [60.0]
    genuine.close()
    intruder.close()


def test_a_port_in_use_and_a_host_that_does_not_answer_are_refused_with_what_to_do(port: int) -> None:
    with Link(f"udpin:127.0.0.1:{port}"), pytest.raises(UnusableInputError, match="no other program uses it"):
        Link(f"udpin:127.0.0.1:{port}").start()
    closed = free_port(socket.SOCK_STREAM)
    with pytest.raises(UnusableInputError, match="cannot be opened"):
        Link(f"tcp:127.0.0.1:{closed}", patience_s=0.0).start()
    with pytest.raises(UnusableInputError, match="cannot be opened"):
        Link("/dev/no-such-line,57600", patience_s=0.0).start()


def test_two_thousand_messages_a_second_arrive_without_loss_and_in_time(port, vehicle):
    seconds, per_tick = 4.0, 10
    sent_at: dict[float, float] = {}

    def fly() -> None:
        begin = time.monotonic()
        for tick in range(int(seconds * 200)):
            for k in range(per_tick):
                stamp = tick * per_tick + k
                sent_at[float(stamp)] = time.monotonic()
                vehicle.send_raw(vehicle.pack(attitude(stamp)))
            time.sleep(max(0.0, begin + (tick + 1) / 200 - time.monotonic()))

    heard: dict[float, float] = {}
    with Link(f"udpin:127.0.0.1:{port}") as link:
        flight = threading.Thread(target=fly)
        flight.start()
        while flight.is_alive() or len(heard) < len(sent_at):
            columns = link.read(0.5)
            now_s = time.monotonic()
            heard.update(dict.fromkeys(stamps(columns), now_s))
            if not columns and not flight.is_alive():
                break
        flight.join()
    assert heard.keys() == sent_at.keys()
    latencies = [heard[stamp] - sent_at[stamp] for stamp in heard]
    assert float(np.median(latencies)) < 0.020
