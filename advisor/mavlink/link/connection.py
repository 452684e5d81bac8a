"""Connection strings in the forms of pymavlink, MAVProxy and MAVSDK."""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from advisor.words.problems import ConfigurationError

Kind = Literal["udpin", "udpout", "tcp", "tcpin", "unix", "serial", "pymavlink"]

DEFAULT_BAUD = 57600  # telemetry radios and ArduPilot's TELEM1 come set to it

_NETWORK_KINDS: dict[str, Kind] = {
    "udpin": "udpin",
    "udp": "udpin",
    "udpout": "udpout",
    "tcp": "tcp",
    "tcpout": "tcp",
    "tcpin": "tcpin",
}
_LEFT_TO_PYMAVLINK = ("udpbcast", "mcast", "ws", "wss", "wsserver")
_EXAMPLES = "udpin:0.0.0.0:14550, udpout:host:14550, tcp:host:5760, tcpin:0.0.0.0:5760 or /dev/ttyUSB0,57600"


@dataclass(frozen=True, slots=True)
class Address:
    """One parsed connection string."""

    kind: Kind
    host: str
    """Host to listen on or to connect to; empty for all interfaces. For other connections the serial device,
    or the path of a local socket."""
    port: int
    """Network port, or the baud rate of a serial line."""
    text: str
    """Connection string as the user wrote it."""

    @property
    def speaks_first(self) -> bool:
        """Whether a packet must be sent before any is received, so that the peer learns the advisor's
        address."""
        return self.kind == "udpout"


def parse_connection(text: str) -> Address:
    """Read a connection string.

    Parameters
    ----------
    text
        String in pymavlink's form (``udpin:``, ``udpout:``, ``udp:``, ``tcp:``, ``tcpin:``,
        ``/dev/ttyX,57600``, bare ``host:port`` listens on UDP) or MAVSDK's
        (``udpin://``, ``udpout://``, ``tcpout://``, ``serial://device:baud``).

    Raises
    ------
    ConfigurationError
        The string names no connection. The message shows examples.
    """
    text = text.strip()
    scheme, colon, rest = text.partition(":")
    mavsdk = rest.startswith("//")
    if mavsdk:
        rest = rest[2:]
    scheme = scheme.lower()
    if colon and scheme in _NETWORK_KINDS:
        return _network(_NETWORK_KINDS[scheme], rest, text)
    if scheme in ("uds", "unix") and rest:
        return Address("unix", rest, 0, text)
    if colon and scheme in _LEFT_TO_PYMAVLINK:
        return Address("pymavlink", rest, 0, text)
    if colon and scheme in ("serial", "serial_flowcontrol"):
        device, _, baud = rest.rpartition(":") if ":" in rest else (rest, "", "")
        return _serial(device, baud, text)
    if mavsdk:
        raise ConfigurationError(f"Connection {text!r}: unknown kind {scheme!r}; write {_EXAMPLES}.")
    if text.startswith("/dev/") or text.upper().startswith("COM") or "," in text:
        device, _, baud = text.partition(",")
        return _serial(device, baud, text)
    if Path(text).is_file():
        raise ConfigurationError(f"Connection {text!r} is a file; a log is read with: advisor replay {text}.")
    if colon and "/" not in text:
        return _network("udpin", text, text)
    raise ConfigurationError(f"Connection {text!r} is not understood; write {_EXAMPLES}.")


def _network(kind: Kind, rest: str, text: str) -> Address:
    host, colon, port_text = rest.rstrip("/").rpartition(":")
    lowest = 0 if kind in ("udpin", "tcpin") else 1  # listening on 0: the system chooses
    if not colon or not port_text.isdigit() or not lowest <= int(port_text) < 65536:
        raise ConfigurationError(f"Connection {text!r} has no port between 1 and 65535; write {_EXAMPLES}.")
    if ":" in host and not host.startswith("["):
        raise ConfigurationError(f"Connection {text!r} has too many colons; write {_EXAMPLES}.")
    if not host and kind in ("udpout", "tcp"):
        raise ConfigurationError(f"Connection {text!r} names no host to call; write {_EXAMPLES}.")
    return Address(kind, host.strip("[]"), int(port_text), text)


def _serial(device: str, baud: str, text: str) -> Address:
    if not device or (baud and not baud.isdigit()):
        raise ConfigurationError(f"Connection {text!r}: a serial line is written /dev/ttyUSB0,57600.")
    return Address("serial", device, int(baud) if baud else DEFAULT_BAUD, text)
