from pathlib import Path

import pytest

from advisor.mavlink.link.transports import parse_connection
from advisor.words.problems import ConfigurationError


@pytest.mark.parametrize(
    ("text", "kind", "host", "port"),
    [
        ("udpin:0.0.0.0:14550", "udpin", "0.0.0.0", 14550),
        ("udp:127.0.0.1:14550", "udpin", "127.0.0.1", 14550),
        ("127.0.0.1:14550", "udpin", "127.0.0.1", 14550),
        (":14550", "udpin", "", 14550),
        ("udpout:plane.local:14550", "udpout", "plane.local", 14550),
        ("tcp:localhost:5760", "tcp", "localhost", 5760),
        ("tcpin:0.0.0.0:5760", "tcpin", "0.0.0.0", 5760),
        ("/dev/ttyUSB0,115200", "serial", "/dev/ttyUSB0", 115200),
        ("/dev/ttyACM0", "serial", "/dev/ttyACM0", 57600),
        ("COM7,57600", "serial", "COM7", 57600),
        ("udpin://0.0.0.0:14540", "udpin", "0.0.0.0", 14540),
        ("udp://:14540", "udpin", "", 14540),
        ("udpout://10.0.0.2:14550", "udpout", "10.0.0.2", 14550),
        ("tcpout://10.0.0.2:5760", "tcp", "10.0.0.2", 5760),
        ("tcp://10.0.0.2:5760", "tcp", "10.0.0.2", 5760),
        ("tcpin://0.0.0.0:5760", "tcpin", "0.0.0.0", 5760),
        ("serial:///dev/ttyUSB0:57600", "serial", "/dev/ttyUSB0", 57600),
        ("serial://COM3:9600", "serial", "COM3", 9600),
        ("mcast:", "pymavlink", "", 0),
        ("uds:/run/mavlink.sock", "unix", "/run/mavlink.sock", 0),
    ],
)
def test_every_spelling_of_pymavlink_and_mavsdk_is_understood(text, kind, host, port):
    address = parse_connection(text)
    assert (address.kind, address.host, address.port) == (kind, host, port)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "udpin",
        "udpin:",
        "udpin:0.0.0.0",
        "udpin:0.0.0.0:port",
        "udpin:0.0.0.0:70000",
        "udpout::14550",
        "udpout:host:0",
        "tcp::5760",
        "tcp:a:b:5760",
        "pigeon://coop:1",
        "serial://",
        "/dev/ttyUSB0,fast",
        "flight.tlog",
    ],
)
def test_what_is_no_connection_is_refused_by_one_sentence_that_shows_how_one_is_written(text: str) -> None:
    with pytest.raises(ConfigurationError, match="Connection") as refusal:
        parse_connection(text)
    message = str(refusal.value)
    assert repr(text) in message
    assert "\n" not in message
    assert "udpin:0.0.0.0:14550" in message or "/dev/ttyUSB0,57600" in message


def test_a_log_given_as_a_connection_is_pointed_to_replay(tmp_path: Path) -> None:
    log = tmp_path / "flight.tlog"
    log.write_bytes(b"x")
    with pytest.raises(ConfigurationError, match=f"advisor replay {log}"):
        parse_connection(str(log))


def test_only_a_connection_that_calls_out_over_udp_must_speak_first() -> None:
    assert parse_connection("udpout:host:1").speaks_first
    assert not any(
        parse_connection(text).speaks_first for text in ("udpin:host:1", "tcp:host:1", "/dev/ttyS0")
    )
