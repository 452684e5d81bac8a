"""Reading a large telemetry log: ratio to pymavlink, and memory.

    python benchmarks/tlog.py [--megabytes 100] [--keep FILE]

Writes a log of the wanted size, 31 kinds of message at the rates a 50 Hz stream of ArduPlane
has, and reads the types the advisor needs from it twice: with pymavlink's reader for recorded
logs (`mavutil.mavlink_connection` and `recv_match(type=...)`) and with the advisor's. Both
must find the same number of messages. Processor time, one process, one run. pymavlink only
walks through its messages; the advisor's time includes the finished columns.
"""

import argparse
import os
import tempfile
import time
import tracemalloc
from collections.abc import Callable
from pathlib import Path

import numpy as np

os.environ["MAVLINK20"] = "1"

from pymavlink import mavutil
from pymavlink.dialects.v20 import ardupilotmega as dialect

from advisor.flight.signals.messages import Columns
from advisor.mavlink.logs.formats.telemetry import read_tlog

WANTED = [
    "HEARTBEAT",
    "PARAM_VALUE",
    "STATUSTEXT",
    "ATTITUDE",
    "AOA_SSA",
    "SERVO_OUTPUT_RAW",
    "RAW_IMU",
    "VFR_HUD",
    "GLOBAL_POSITION_INT",
]
"""What the advisor needs of a flight."""

RATES_HZ = {
    **dict.fromkeys(WANTED, 50),
    **dict.fromkeys(["HEARTBEAT", "PARAM_VALUE", "STATUSTEXT"], 1),
    **dict.fromkeys(
        [
            "SCALED_IMU2",
            "SCALED_IMU3",
            "SCALED_PRESSURE",
            "SCALED_PRESSURE2",
            "SIMSTATE",
            "ESC_TELEMETRY_1_TO_4",
        ],
        50,
    ),
    "LOCAL_POSITION_NED": 25,
    **dict.fromkeys(["RC_CHANNELS", "AHRS2"], 10),
    **dict.fromkeys(
        [
            "SYS_STATUS",
            "POWER_STATUS",
            "MEMINFO",
            "MISSION_CURRENT",
            "GPS_RAW_INT",
            "SYSTEM_TIME",
            "AHRS",
            "WIND",
            "TERRAIN_REPORT",
            "EKF_STATUS_REPORT",
            "VIBRATION",
            "BATTERY_STATUS",
            "NAV_CONTROLLER_OUTPUT",
        ],
        5,
    ),
}
SECONDS_PACKED = 20


def write_log(path: Path, megabytes: float) -> None:
    """Pack some seconds of telemetry with pymavlink; repeat them under advancing time stamps."""
    rng = np.random.default_rng(1)
    link = dialect.MAVLink(None, srcSystem=1, srcComponent=1)
    frames = sorted(
        (k / rate + 1e-4 * number, name)
        for number, (name, rate) in enumerate(RATES_HZ.items())
        for k in range(SECONDS_PACKED * rate)
    )
    pieces, stamps_at, stamps_us, at = [], [], [], 0
    for second, name in frames:
        frame = random_message(name, rng).pack(link)
        link.seq = (link.seq + 1) % 256
        stamps_at.append(at)
        stamps_us.append(int(second * 1e6))
        pieces += [bytes(8), bytes(frame)]
        at += 8 + len(frame)
    block = np.frombuffer(b"".join(pieces), dtype=np.uint8).copy()
    where = np.array(stamps_at)[:, None] + np.arange(8)
    start_us = 1_770_000_000_000_000
    with path.open("wb") as file:
        for repetition in range(int(np.ceil(megabytes * 1e6 / len(block)))):
            stamps = np.array(stamps_us, dtype=np.int64) + start_us + repetition * SECONDS_PACKED * 1_000_000
            block[where] = stamps.astype(">i8").view(np.uint8).reshape(-1, 8)
            file.write(block.tobytes())


def random_message(name: str, rng: np.random.Generator) -> dialect.MAVLink_message:
    """A message of this name with small random values."""
    kind = next(message for message in dialect.mavlink_map.values() if message.msgname == name)
    values = []
    for field, c_type in zip(kind.fieldnames, kind.fieldtypes, strict=True):
        length = kind.array_lengths[kind.ordered_fieldnames.index(field)]
        if c_type == "char":
            values.append(b"SERVO2_MIN")
        elif c_type == "float":
            values.append(rng.normal(size=length).tolist() if length else rng.normal())
        else:
            values.append(rng.integers(0, 127, length).tolist() if length else int(rng.integers(0, 127)))
    return kind(*values)


def processor_seconds(run: Callable[[], int]) -> tuple[float, int]:
    """Processor time of one run, and what it returned."""
    start = time.process_time()
    result = run()
    return time.process_time() - start, result


def by_pymavlink(path: Path) -> int:
    """Number of wanted messages pymavlink finds."""
    log = mavutil.mavlink_connection(str(path), dialect="ardupilotmega")
    count = 0
    while log.recv_match(type=WANTED) is not None:
        count += 1
    log.close()
    return count


def by_advisor(path: Path) -> list[Columns]:
    """The wanted messages as the advisor reads them."""
    return [columns for batch in read_tlog(path, WANTED) for columns in batch]


def bytes_of(columns: list[Columns]) -> int:
    """Bytes of the decoded columns."""
    return sum(
        c.order.nbytes + c.arrival_s.nbytes + sum(field.nbytes for field in c.fields.values())
        for c in columns
    )


def peak_over_decoded(path: Path) -> float:
    """Peak memory while a whole log is read and kept, over the bytes of its columns."""
    tracemalloc.start()
    columns = by_advisor(path)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    return peak / bytes_of(columns)


def row(name: str, figure: str, goal: str) -> None:
    """One line of the table."""
    print(f"{name:<52} {figure:>16}   {goal}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--megabytes", type=float, default=100.0)
    parser.add_argument("--keep", type=Path, help="write the log here and leave it")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        path = arguments.keep or Path(folder) / "large.tlog"
        write_log(path, arguments.megabytes)
        by_advisor(path)  # loads the compiled scanner
        ours_s, ours = processor_seconds(lambda: sum(map(len, by_advisor(path))))
        theirs_s, theirs = processor_seconds(lambda: by_pymavlink(path))
        if ours != theirs:
            raise SystemExit(f"pymavlink finds {theirs} messages, the advisor {ours}")
        size_mb = path.stat().st_size / 1e6
        row(f"log of {size_mb:.0f} MB, {ours} wanted messages: pymavlink", f"{theirs_s:.1f} s", "")
        row("the same: advisor", f"{ours_s:.2f} s", "")
        row("tlog: times faster than pymavlink", f"{theirs_s / ours_s:.0f} x", "at least 15 x")
        row("tlog: peak memory over decoded columns", f"{peak_over_decoded(path):.2f} x", "below 4 x")


if __name__ == "__main__":
    main()
