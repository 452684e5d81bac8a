"""Write a flight as a telemetry log (.tlog)."""

from pathlib import Path
from typing import BinaryIO

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from .flight import Flight
from .mavlink import COMPONENT, SYSTEM
from .telemetry import Telemetry


def write_tlog(flight: Flight, out: BinaryIO) -> int:
    """Fly, write the telemetry log, and return the number of messages.

    Each record is eight bytes of microseconds since 1970, big-endian, then the frame. The stamps come from
    simulated time, so that equal scenarios and seeds give equal bytes. The two lowest bits of a stamp are the
    link number, which is 0.
    """
    packer = mavlink.MAVLink(None, srcSystem=SYSTEM, srcComponent=COMPONENT)
    telemetry = Telemetry(flight)
    unix_us = round(1e6 * flight.scenario.clock.unix_s)
    count = 0
    for burst in telemetry.bursts():
        stamp = unix_us + round(1e6 * burst.arrival_s)
        for place, message in enumerate(burst.messages):
            frame = message.pack(packer)
            packer.seq = (packer.seq + 1) % 256
            out.write(((stamp + 40 * place) & ~3).to_bytes(8, "big") + frame)
            count += 1
    return count


def record(flight: Flight, path: Path) -> int:
    """Fly and write the log to ``path``; return the number of messages."""
    with path.open("wb") as out:
        return write_tlog(flight, out)
