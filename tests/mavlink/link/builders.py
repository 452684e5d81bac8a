"""Frames and peers for the link's tests: a small vehicle on a real socket."""

import socket
import time
from collections.abc import Callable, Iterable
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as dialect

from advisor.flight.signals.messages import Columns
from advisor.mavlink.link.link import Link
from advisor.mavlink.wire.framing import CRC_EXTRA, Frame, FrameCutter


def wait_until(condition: Callable[[], bool], timeout_s: float = 10.0) -> None:
    """Return as soon as the condition holds; fail the test when it never does."""
    give_up_s, pause_s = time.monotonic() + timeout_s, 0.005
    while not condition():
        assert time.monotonic() < give_up_s, "waited in vain"
        time.sleep(pause_s)
        pause_s = min(1.5 * pause_s, 0.1)  # what is waited for needs the processor as well


def attitude(milliseconds: int, pitch: float = 0.1) -> Any:
    return dialect.MAVLink_attitude_message(
        milliseconds, 0.0, pitch, 0.0, 0.0, 0.01 * (milliseconds % 7), 0.0
    )


def attitude_at(boot_s: float) -> list[Frame]:
    """An ATTITUDE with this time since boot, as received."""
    return FrameCutter(CRC_EXTRA).feed(Sender().pack(attitude(round(1000.0 * boot_s))))


def heartbeat(
    kind: int = dialect.MAV_TYPE_FIXED_WING, autopilot: int = dialect.MAV_AUTOPILOT_ARDUPILOTMEGA
) -> Any:
    return dialect.MAVLink_heartbeat_message(kind, autopilot, 0, 0, dialect.MAV_STATE_ACTIVE, 3)


class Sender:
    """Packs messages as one system does."""

    def __init__(self, system: int = 1, component: int = 1, key: bytes | None = None) -> None:
        self.mavlink = dialect.MAVLink(None, srcSystem=system, srcComponent=component)
        if key is not None:
            self.mavlink.signing.secret_key = key
            self.mavlink.signing.sign_outgoing = True
            self.mavlink.signing.timestamp = int((time.time() - 1_420_070_400) * 1e5)

    def pack(self, message: Any, mavlink1: bool = False) -> bytes:
        raw = bytes(message.pack(self.mavlink, force_mavlink1=mavlink1))
        self.mavlink.seq = (self.mavlink.seq + 1) % 256
        return raw


class UdpVehicle(Sender):
    """A vehicle that sends to one UDP port and hears what is answered."""

    def __init__(self, port: int, system: int = 1, key: bytes | None = None) -> None:
        super().__init__(system, key=key)
        self.port = port
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.settimeout(5.0)

    def send(self, *messages: Any) -> None:
        for message in messages:
            self.send_raw(self.pack(message))

    def send_raw(self, data: bytes) -> None:
        self.socket.sendto(data, ("127.0.0.1", self.port))

    def hear(self) -> Any:
        data = self.socket.recv(2048)
        return dialect.MAVLink(None).parse_buffer(bytearray(data))[0]

    def close(self) -> None:
        self.socket.close()


def free_port(kind: int = socket.SOCK_DGRAM) -> int:
    """A port the system says is free."""
    with socket.socket(socket.AF_INET, kind) as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def read_all(link: Link, quiet_s: float = 0.3) -> list[Columns]:
    """Everything the link delivers until it is quiet for so long."""
    columns: list[Columns] = []
    while batch := link.read(quiet_s):
        columns += batch
    return columns


def values(columns: Iterable[Columns], name: str, field: str, system: int = 1) -> list[float]:
    """One field of one system's messages, in order of arrival."""
    return [
        float(value)
        for part in columns
        if part.name == name and part.system == system
        for value in part.fields[field]
    ]
