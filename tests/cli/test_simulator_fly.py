"""``advisor simulator fly`` over a socket, against a peer that answers as ArduPilot's simulation does."""

import socket
import struct
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Thread
from typing import Any

import pytest
from click.testing import CliRunner, Result
from pymavlink.dialects.v20 import ardupilotmega as dialect

from advisor.cli.simulator import command
from advisor.words.problems import UnusableInputError
from tests.mavlink.link.builders import Sender, heartbeat

PULSES = [1500, 1500, 1700, 1700, 1300, 1300, 1500, 1500]
ASKED = dialect.MAVLINK_MSG_ID_PARAM_REQUEST_READ
OVERRIDE = dialect.MAVLINK_MSG_ID_RC_CHANNELS_OVERRIDE


def recorded(log: Path) -> Path:
    """Write the sticks of a flight, eight samples a tenth of a second apart."""
    sender, data = Sender(), b""
    for k, pitch in enumerate(PULSES):
        channels = [1500, pitch, 1400, 1500, *[1500] * 14]
        sticks = dialect.MAVLink_rc_channels_message(100 * k, 18, *channels, 255)
        for message in (heartbeat(), sticks):
            data += struct.pack(">Q", 1_700_000_000_000_000 + 100_000 * k) + sender.pack(message)
    log.write_bytes(data)
    return log


@contextmanager
def simulation(parameters: dict[str, float]) -> Iterator[tuple[int, list[Any]]]:
    """Serve a vehicle with some parameters on a TCP port, as ArduPilot's simulation does."""
    heard: list[Any] = []

    def serve() -> None:
        connection, _ = server.accept()
        connection.settimeout(0.05)
        sender, parser = Sender(), dialect.MAVLink(None)
        parser.robust_parsing = True
        with connection:
            while True:
                try:
                    connection.sendall(sender.pack(heartbeat()))
                    data = connection.recv(4096)
                except TimeoutError:
                    continue
                except OSError:
                    return
                if not data:
                    return
                for message in parser.parse_buffer(data) or []:
                    heard.append(message)
                    if message.get_msgId() != ASKED or message.param_id not in parameters:
                        continue
                    name, value = message.param_id, parameters[message.param_id]
                    told = dialect.MAVLink_param_value_message(name.encode(), value, 9, 900, 1)
                    connection.sendall(sender.pack(told))

    with socket.create_server(("127.0.0.1", 0)) as server:
        thread = Thread(target=serve, daemon=True)
        thread.start()
        yield server.getsockname()[1], heard
        thread.join(5.0)


def fly(log: Path, port: int) -> Result:
    words = ["fly", str(log), "--master", f"tcp:127.0.0.1:{port}"]
    return CliRunner().invoke(command, words, standalone_mode=False, catch_exceptions=False)


def test_a_flights_sticks_arrive_at_the_simulation_and_are_released(tmp_path: Path) -> None:
    with simulation({"SIM_SPEEDUP": 1.0, "SYSID_MYGCS": 252.0}) as (port, heard):
        done = fly(recorded(tmp_path / "flight.tlog"), port)
    assert done.exit_code == 0
    sent = [m for m in heard if m.get_msgId() == OVERRIDE]
    pitch = [m.chan2_raw for m in sent]
    assert {0} < set(pitch) <= {0, *PULSES}
    assert {1700, 1300} & set(pitch)
    assert pitch[-10:] == [0] * 10
    assert {m.get_srcSystem() for m in sent} == {252}
    assert {m.chan3_raw for m in sent[:-10]} == {1400}


@pytest.mark.study
def test_a_vehicle_that_is_no_simulation_gets_no_stick(tmp_path: Path) -> None:
    refused = pytest.raises(UnusableInputError, match="nothing was sent")
    with simulation({"SERVO2_MIN": 1100.0}) as (port, heard), refused:
        fly(recorded(tmp_path / "flight.tlog"), port)
    assert OVERRIDE not in {m.get_msgId() for m in heard}
