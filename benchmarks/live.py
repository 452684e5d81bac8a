"""Memory and open descriptors of a live flight test of hours, flown at a multiple of real time.

    python -m benchmarks.live [--minutes 12] [--speed 10]

The bundled aircraft flies over UDP into ``advisor live`` as text. Once a minute its processes are measured:
resident memory, open descriptors, processor time, verdicts.
"""

import argparse
import os
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from sim.scenario import Scenario

PAGE_MB = os.sysconf("SC_PAGE_SIZE") / 1e6
TICKS_PER_S = os.sysconf("SC_CLK_TCK")
MANEUVER_S = 15.0
"""Time of flight from one manoeuvre to the next, s; the shortest of the bundled aircraft take 16."""


def scenario(folder: Path, flight_s: float) -> Path:
    """Write the paper's campaign, flown again and again for at least so long."""
    names = [maneuver.input for maneuver in Scenario().maneuvers]
    every = [names[k % len(names)] for k in range(int(flight_s / MANEUVER_S) + 1)]
    path = folder / "scenario.yaml"
    path.write_text(f"noise: {{percent: 1.0, of: peak}}\nmaneuvers: [{', '.join(every)}]\n")
    return path


def processes(root: int, data: Path) -> Iterator[int]:
    """Yield a process with all its children, and the process of the link."""
    waiting = [root, *(int(note.stem) for note in data.glob("inflight-advisor/links/*.json"))]
    seen: set[int] = set()
    while waiting:
        pid = waiting.pop()
        children = Path(f"/proc/{pid}/task/{pid}/children")
        if pid not in seen and children.exists():
            seen.add(pid)
            waiting += map(int, children.read_text().split())
            yield pid


def counted(pids: list[int]) -> tuple[float, int, float]:
    """Return resident memory in MB, open descriptors and processor time in s of processes together."""
    memory, descriptors, seconds = 0.0, 0, 0.0
    for pid in pids:
        folder = Path(f"/proc/{pid}")
        memory += int((folder / "statm").read_text().split()[1]) * PAGE_MB
        descriptors += len(list((folder / "fd").iterdir()))
        seconds += (
            sum(map(int, (folder / "stat").read_text().rpartition(")")[2].split()[11:13])) / TICKS_PER_S
        )
    return memory, descriptors, seconds


def latest_s(told: str) -> float:
    """Return the time of flight of the newest manoeuvre that the simulator has told, s."""
    return float(([line.split()[0] for line in told.splitlines()] or ["0"])[-1])


def main() -> None:
    """Fly, count once a minute, and end."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=int, default=12)
    parser.add_argument("--speed", type=float, default=10.0)
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        _fly(Path(name), asked.minutes, asked.speed)


def _fly(folder: Path, minutes: int, speed: float) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    data, said, recording = folder / "data", folder / "said.txt", folder / "flight.tlog"
    flown = folder / "flown.txt"
    environment = {**os.environ, "HEADLESS": "1", "XDG_DATA_HOME": str(data)}
    live = [sys.executable, "-m", "advisor", "live", "--master", f"udpin:127.0.0.1:{port}"]
    master = f"udpout:127.0.0.1:{port}"
    fly = [sys.executable, "-m", "sim", "fly", "--master", master, "--speed", f"{speed:g}"]
    with said.open("wb") as out, flown.open("wb") as told:
        advising = subprocess.Popen([*live, "--record", str(recording)], stdout=out, env=environment)
        time.sleep(5.0)
        plan = str(scenario(folder, 60.0 * minutes * speed))
        flying = subprocess.Popen([*fly, "--scenario", plan], stdout=told, stderr=subprocess.STDOUT)
        began = time.monotonic()
        print("minute  flown h   MB  descriptors  CPU s  verdicts  recorded MB", flush=True)
        for minute in range(1, minutes + 1):
            time.sleep(max(0.0, began + 60.0 * minute - time.monotonic()))
            memory, descriptors, seconds = counted(list(processes(advising.pid, data)))
            text = said.read_text()
            verdicts = text.count("ACCEPTED:") + text.count("REPEAT:")
            hours = latest_s(flown.read_text()) / 3600.0
            print(
                f"{minute:6} {hours:8.2f} {memory:5.0f} {descriptors:11} {seconds:7.0f}"
                f" {verdicts:8} {recording.stat().st_size / 1e6:11.1f}",
                flush=True,
            )
        flying.terminate()
        flying.wait()
        advising.send_signal(signal.SIGINT)
        print(f"exit code {advising.wait()}")


if __name__ == "__main__":
    main()
