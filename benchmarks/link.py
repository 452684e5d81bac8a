"""A live link under load: losses, latency from packet to channel, processor time.

    python benchmarks/link.py --seconds 60 --rate 2000

A process sends an aircraft's messages over UDP on loopback, each stamped with the machine's
monotonic clock. As in `advisor live`, the process of the link receives and records them; this
process decodes them, turns them into channels, and compares that clock when a sample has become
a channel. Processor time is that of this process and of the link's, all threads.
"""

import argparse
import os
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from pymavlink.dialects.v20 import ardupilotmega as dialect

BURST = ("ATTITUDE", "AOA_SSA", "SERVO_OUTPUT_RAW", "RAW_IMU", "VFR_HUD", "GLOBAL_POSITION_INT")


def message(name: str, now_s: float) -> dialect.MAVLink_message:
    """One message of the vehicle, stamped now."""
    milliseconds, microseconds = int(now_s * 1e3) & 0xFFFFFFFF, int(now_s * 1e6)
    elevator = 1500 + int(20 * np.sin(now_s))
    match name:
        case "ATTITUDE":
            return dialect.MAVLink_attitude_message(milliseconds, 0.01, 0.05, 1.0, 0.0, 0.02, 0.0)
        case "AOA_SSA":
            return dialect.MAVLink_aoa_ssa_message(microseconds, 4.0, 0.1)
        case "SERVO_OUTPUT_RAW":
            outputs = [1500, elevator, *[1500] * 6]
            return dialect.MAVLink_servo_output_raw_message(microseconds & 0xFFFFFFFF, 0, *outputs)
        case "RAW_IMU":
            return dialect.MAVLink_raw_imu_message(microseconds, 10, 0, -1000, 0, 1, 0, 0, 0, 0)
        case "VFR_HUD":
            return dialect.MAVLink_vfr_hud_message(25.0, 25.0, 0, 50, 100.0, 0.0)
        case "GLOBAL_POSITION_INT":
            return dialect.MAVLink_global_position_int_message(milliseconds, 0, 0, 0, 100_000, 0, 0, 0, 0)
    return dialect.MAVLink_heartbeat_message(1, 3, 0, 0, 4, 3)


def send(port: int, seconds: float, rate: float) -> None:
    """Be the vehicle; print how many messages were sent."""
    mavlink = dialect.MAVLink(None, srcSystem=1, srcComponent=1)
    end = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    began = time.monotonic()
    sent = 0
    while (now_s := time.monotonic()) - began < seconds:
        due = int((now_s - began) * rate)
        for k in range(sent, due):
            name = "HEARTBEAT" if k % 500 == 0 else BURST[k % len(BURST)]
            raw = message(name, time.monotonic()).pack(mavlink)
            mavlink.seq = (mavlink.seq + 1) % 256
            end.sendto(raw, ("127.0.0.1", port))
        sent = max(sent, due)
        time.sleep(0.0005)
    print(sent)


def processor_time(pid: int) -> float:
    """Seconds of processor time of another process, as Linux counts them (proc(5), fields 14 and 15)."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def measure(seconds: float, rate: float) -> None:
    """Be the advisor; print the table."""
    from advisor.aircraft.aircraft import Aircraft, Elevator
    from advisor.flight.stream.stream import FlightStream
    from advisor.mavlink.link.kept_link import Keeping, new_door
    from advisor.mavlink.link.link_process import LinkProcess

    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    stream = FlightStream(Aircraft(elevator=Elevator(output=2)))
    latencies: list[float] = []
    received = 0
    with (
        tempfile.TemporaryDirectory() as folder,
        LinkProcess(
            Keeping(f"udpin:127.0.0.1:{port}", new_door(), record_to=Path(folder) / "own.tlog")
        ) as process,
        process.link() as link,
    ):
        assert process.pid is not None
        link.read(0.5)  # as in flight: the advisor reads before the vehicle flies
        vehicle = subprocess.Popen(
            [sys.executable, __file__, "--send", str(port), "--seconds", str(seconds), "--rate", str(rate)],
            stdout=subprocess.PIPE,
            text=True,
        )
        while not (columns := link.read(0.5)):
            pass
        wall_s, processor_s = time.monotonic(), time.process_time() + processor_time(process.pid)
        last_s = wall_s
        while columns or time.monotonic() - last_s < 1.0:
            stream.feed(columns)
            now_s = time.monotonic()
            for part in columns:
                received += len(part)
                last_s = now_s
                if part.name == "ATTITUDE":
                    latencies += (now_s - part.fields["time_boot_ms"].astype(float) / 1e3).tolist()
            columns = link.read(0.1)
        processor_s = time.process_time() + processor_time(process.pid) - processor_s
        wall_s = last_s - wall_s
        statistics = link.statistics
    sent = int(vehicle.communicate()[0])
    p50, p99, worst = 1e3 * np.percentile(latencies, [50, 99, 100])
    print(f"{'messages sent':<34}{sent:>10d}   in {wall_s:.1f} s, {sent / wall_s:.0f} a second")
    print(f"{'messages become columns':<34}{received:>10d}   lost {sent - received} (goal 0)")
    print(f"{'lost by sequence number':<34}{statistics.lost:>10d}")
    print(f"{'packet to channel, median':<34}{p50:>10.1f} ms")
    print(f"{'packet to channel, 99th percentile':<34}{p99:>10.1f} ms (goal 20)")
    print(f"{'packet to channel, worst':<34}{worst:>10.1f} ms")
    print(f"{'processor':<34}{100 * processor_s / wall_s:>10.1f} % of a core (goal 15)")


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    options.add_argument("--seconds", type=float, default=60.0)
    options.add_argument("--rate", type=float, default=2000.0)
    options.add_argument("--send", type=int, metavar="PORT", help=argparse.SUPPRESS)
    chosen = options.parse_args()
    if chosen.send:
        send(chosen.send, chosen.seconds, chosen.rate)
    else:
        measure(chosen.seconds, chosen.rate)


if __name__ == "__main__":
    main()
