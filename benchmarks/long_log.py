"""What a log of hours takes, from its file to the document.

    python -m benchmarks.long_log [--hours 10] [--every 180]

The manoeuvres of a recorded flight come again and again, quiet flight between them, all clocks and counters
running on. The file is analysed by ``advisor analyze --json``.
"""

import argparse
import json
import resource
import struct
import subprocess
import tempfile
from collections import Counter
from collections.abc import Iterator
from itertools import cycle
from pathlib import Path
from typing import NamedTuple

from pymavlink.dialects.v20 import ardupilotmega as dialect

from advisor.mavlink.wire.checksum import crc16
from advisor.mavlink.wire.framing import CRC_EXTRA
from advisor.process.children import python_module

LOG = Path(__file__).parents[1] / "logs" / "arduplane-calm.tlog"
QUIET_S = (29.0, 13.0)
"""Beginning and end of the quiet flight before the last manoeuvre, s before the end of the log."""
FLIGHT = 7
"""Manoeuvres of the recorded flight."""
_CLOCKS = {"time_boot_ms": 1_000, "time_usec": 1_000_000}
_HEADER = 10


class Packet(NamedTuple):
    """One frame of a log, unsigned MAVLink 2."""

    arrival_us: int
    frame: bytes
    clock: tuple[str, int, int] | None
    """Format and place of the vehicle's clock in the frame, and its ticks a second."""


def packets(log: Path) -> list[Packet]:
    """All frames of a log, in order of arrival."""
    data, at, found = log.read_bytes(), 0, []
    while at < len(data):
        (arrival_us,) = struct.unpack_from(">Q", data, at)
        frame = data[at + 8 : at + 8 + 12 + data[at + 9]]
        found.append(Packet(arrival_us, frame, _clock(int.from_bytes(frame[7:10], "little"))))
        at += 8 + len(frame)
    return found


def _clock(message_id: int) -> tuple[str, int, int] | None:
    message = dialect.mavlink_map[message_id]
    name = message.ordered_fieldnames[0]
    return (message.unpacker.format[:2], _HEADER, _CLOCKS[name]) if name in _CLOCKS else None


def written(every: list[Packet], seconds: float, counters: "Counter[bytes]") -> Iterator[bytes]:
    """The packets so much later on all clocks, numbered on."""
    for arrival_us, frame, clock in every:
        body, sender = bytearray(frame[1:-2]), frame[5:7]
        body[3] = counters[sender] % 256
        counters[sender] += 1
        if clock is not None:
            form, at, ticks = clock
            (t,) = struct.unpack_from(form, body, at - 1)
            wraps = 1 << 8 * struct.calcsize(form)
            struct.pack_into(form, body, at - 1, (t + round(seconds * ticks)) % wraps)
        crc = crc16(bytes(body) + bytes([CRC_EXTRA[int.from_bytes(frame[7:10], "little")]]))
        late_us = arrival_us + round(seconds * 1e6)
        yield struct.pack(">Q", late_us) + frame[:1] + bytes(body) + crc.to_bytes(2, "little")


def write(out: Path, hours: float, every_s: float) -> None:
    """Write a flight of so many hours, with a manoeuvre every so many seconds in the mean."""
    flight = packets(LOG)
    first, last = flight[0].arrival_us, flight[-1].arrival_us
    begin, end = (last - round(1e6 * s) for s in QUIET_S)
    quiet = [packet for packet in flight if begin <= packet.arrival_us < end]
    length_s, pause_s = 1e-6 * (last - first) + 0.02, QUIET_S[0] - QUIET_S[1]
    pauses = max(0, round((FLIGHT * every_s - length_s) / pause_s))
    now_s, counters = 0.0, Counter[bytes]()
    with out.open("wb") as file:
        for k in cycle(range(pauses + 1)):
            if now_s >= hours * 3600.0:
                return
            part, begin_s = (flight, 0.0) if k == 0 else (quiet, 1e-6 * (begin - first))
            file.writelines(written(part, now_s - begin_s, counters))
            now_s += length_s if k == 0 else pause_s


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--hours", type=float, default=10.0)
    parser.add_argument("--every", type=float, default=180.0, help="seconds between two manoeuvres")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        log = Path(folder) / "long.tlog"
        write(log, given.hours, given.every)
        known = str(LOG.with_suffix(".yaml"))
        command = [*python_module("advisor"), "analyze", str(log), "--aircraft", known, "--json"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        found = json.loads(done.stdout)
        accepted = sum(one["verdict"] == "accepted" for one in found["maneuvers"])
        print(
            f"{log.stat().st_size / 1e6:.0f} MB, {found['log']['duration_s'] / 3600.0:.2f} h: "
            f"{len(found['maneuvers'])} manoeuvres, {accepted} accepted; {used.ru_maxrss / 1e3:.0f} MB, "
            f"{used.ru_utime + used.ru_stime:.0f} s of processor time"
        )


if __name__ == "__main__":
    main()
