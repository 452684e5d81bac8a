"""ArduPlane in software in the loop, flown over loopback by a pilot of a few lines."""

import json
import os
import socket
import struct
import subprocess
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

SITL = Path(__file__).parents[3] / "shared" / "sitl"
SPEEDUP = os.environ.get("ADVISOR_SITL_SPEEDUP", "2")
"""Simulated seconds in a second. A loaded machine calls scripts too rarely at more than 2."""
HOME_M = 584.0
WALL_S = 240.0
"""Longest real time of a flight, s. A longer one says that the machine is slow, and nothing of the script."""
_RATES_HZ = {30: 50, 36: 100, 27: 50, 11020: 50, 65: 50, 74: 10, 33: 10, 29: 5}
"""Rate of each message: ATTITUDE, SERVO_OUTPUT_RAW, RAW_IMU, AOA_SSA, RC_CHANNELS, VFR_HUD,
GLOBAL_POSITION_INT, SCALED_PRESSURE. The servo outputs come twice as fast as a usual link sends them, so that
their edges show."""
_CRUISE_US = 1500
_SECOND = 2
"""TCP port of SERIAL1 in software in the loop, relative to the base port."""


class SlowMachineError(RuntimeError):
    """The flight took too long on this machine."""


@dataclass(frozen=True)
class Airframe:
    """An aircraft of ArduPlane's simulator."""

    coefficients: Mapping[str, float]
    """Numbers of the plane, by ArduPilot's names."""
    parameters: Mapping[str, float] = field(default_factory=dict)
    """Parameters in addition to those of ``plane.parm``."""
    model: str = "plane"
    """Model of the simulator, such as ``plane-vtail``."""


def light() -> Airframe:
    """Return the light plane of ``light.json``."""
    return Airframe(json.loads((SITL / "light.json").read_text(encoding="utf-8")))


@dataclass
class Pilot:
    """A pilot at the transmitter, who hears the telemetry."""

    link: Any
    tlog: BinaryIO
    t: float = 0.0
    height_m: float = 0.0
    sticks: list[int] = field(default_factory=lambda: [1500, 1500, 1000, 1500, 0, 0, 1000, 1800])
    texts: list[tuple[float, str]] = field(default_factory=list)
    outputs: list[tuple[float, tuple[int, ...]]] = field(default_factory=list)
    """Times since boot, s, and pulses of outputs 1 to 8, us."""
    radio: list[tuple[float, tuple[int, ...]]] = field(default_factory=list)
    """Times since boot, s, and pulses of radio channels 1 to 8 as the vehicle received them, us."""
    heights: list[tuple[float, float]] = field(default_factory=list)
    """Times since boot, s, and heights above home, m."""
    parameters: dict[str, float] = field(default_factory=dict)
    longest_s: float = WALL_S
    """Longest real time of the flight, s."""
    second_port: int = 0
    """TCP port of the vehicle's second link."""
    since_s: float = field(default_factory=time.monotonic)

    def fly(self, seconds: float, until: Callable[[], bool] = lambda: False) -> bool:
        """Fly with the present sticks for some simulated seconds, or until a condition holds.

        Raises
        ------
        SlowMachineError
            The whole flight takes too long.
        """
        end, sent = self.t + seconds, -1.0
        while self.t < end:
            if time.monotonic() - self.since_s > self.longest_s:
                took = f"{self.t:.0f} s of flight took more than {self.longest_s:.0f} s"
                raise SlowMachineError(f"{took} on this machine")
            message = self.link.recv_match(blocking=True, timeout=1)
            if message is None:
                continue
            self._hear(message)
            if self.t - sent > 0.05:
                sent = self.t
                self.link.mav.rc_channels_override_send(1, 1, *self.sticks)
            if until():
                return True
        return False

    def heard(self, begin: str, count: int = 1) -> Callable[[], bool]:
        """Return the condition that so many texts have begun so."""
        return lambda: sum(text.startswith(begin) for _, text in self.texts) >= count

    def at(self, begin: str) -> float:
        """Return the time of the first text that begins so, s."""
        return next(t for t, text in self.texts if text.startswith(begin))

    def said(self, begin: str) -> str:
        """Return the first text that begins so; empty without one."""
        return next((text for _, text in self.texts if text.startswith(begin)), "")

    def pulses(self) -> tuple[np.ndarray, np.ndarray]:
        """Return times, s, and pulses of outputs 1 to 8, shape (n, 8)."""
        return np.array([t for t, _ in self.outputs]), np.array([us for _, us in self.outputs], dtype=float)

    def _hear(self, message: Any) -> None:
        self.tlog.write(struct.pack(">Q", int(time.time() * 1e6)) + message.get_msgbuf())
        match message.get_type():
            case "ATTITUDE":
                self.t = message.time_boot_ms / 1000.0
            case "VFR_HUD":
                self.height_m = message.alt - HOME_M
            case "GLOBAL_POSITION_INT":
                self.heights.append((message.time_boot_ms / 1000.0, message.relative_alt / 1000.0))
            case "STATUSTEXT":
                self.texts.append((self.t, message.text))
            case "PARAM_VALUE":
                self.parameters[message.param_id] = message.param_value
            case "SERVO_OUTPUT_RAW":
                raw = tuple(getattr(message, f"servo{k}_raw") for k in range(1, 9))
                self.outputs.append((message.time_usec / 1e6, raw))
            case "RC_CHANNELS":
                received = tuple(getattr(message, f"chan{k}_raw") for k in range(1, 9))
                self.radio.append((message.time_boot_ms / 1000.0, received))


@contextmanager
def airborne(
    script: str, folder: Path, airframe: Airframe | None = None, longest_s: float = WALL_S
) -> Iterator[Pilot]:
    """Start ArduPlane with a script, take off, and hand over the aircraft in FBWA above 70 m."""
    airframe = airframe or light()
    os.environ["MAVLINK20"] = "1"
    from pymavlink import mavutil

    install(script, folder, airframe)
    port = free_port()
    with (
        simulator(folder, airframe.model, port, SPEEDUP),
        (folder / "flight.tlog").open("wb") as tlog,
        closing(_connected(mavutil, port)) as link,
    ):
        pilot = Pilot(link, tlog, longest_s=longest_s, second_port=port + _SECOND)
        _take_off(pilot)
        yield pilot


@contextmanager
def simulator(folder: Path, model: str, port: int, speedup: str) -> Iterator[None]:
    """Run ArduPlane in its folder, and end the process afterwards."""
    words = ["./arduplane", "--model", model, "--speedup", speedup, "--home", "-35.36,149.16,584,353"]
    words += ["--defaults", "plane.parm", "--wipe", "--base-port", str(port)]
    with (folder / "sitl.out").open("wb") as said:
        process = subprocess.Popen(
            words, cwd=folder, stdin=subprocess.DEVNULL, stdout=said, stderr=said,
            env=os.environ | {"PLANE_COEFFICIENTS": "plane.json"},
        )  # fmt: skip
        try:
            yield
        finally:
            _end(process)


def free_port() -> int:
    """Return a TCP port that is free, as is that of the second link, without which ArduPlane ends."""
    while True:
        with socket.socket() as first, socket.socket() as second, suppress(OSError, OverflowError):
            first.bind(("127.0.0.1", 0))
            port: int = first.getsockname()[1]
            second.bind(("127.0.0.1", port + _SECOND))
            return port


def _end(process: subprocess.Popen[bytes]) -> None:
    """End ArduPlane, which may wait for a link that nobody reads any more."""
    process.terminate()
    try:
        process.wait(10)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait(10)


def install(script: str, folder: Path, airframe: Airframe) -> None:
    """Write all that ArduPlane reads in its folder."""
    (folder / "scripts").mkdir()
    (folder / "scripts" / "inflight.lua").write_text(script, encoding="utf-8")
    (folder / "plane.json").write_text(json.dumps(dict(airframe.coefficients), indent=1), encoding="utf-8")
    more = "".join(f"\n{name} {value}" for name, value in airframe.parameters.items())
    defaults = (SITL / "plane.parm").read_text(encoding="utf-8")
    (folder / "plane.parm").write_text(f"{defaults}{more}\n", encoding="utf-8")
    with (folder / "arduplane").open("wb") as unpacked:
        subprocess.run(["xz", "-dkc", SITL / "arduplane.xz"], stdout=unpacked, check=True)
    (folder / "arduplane").chmod(0o755)


def _connected(mavutil: Any, port: int) -> Any:
    for _ in range(50):
        time.sleep(0.2)
        with suppress(OSError):
            return mavutil.mavlink_connection(
                f"tcp:127.0.0.1:{port}", source_system=255, dialect="ardupilotmega", retries=0
            )
    raise OSError(f"no ArduPlane on port {port}")


def _take_off(pilot: Pilot) -> None:
    link = pilot.link
    link.wait_heartbeat(timeout=30)
    for number, hz in _RATES_HZ.items():
        link.mav.command_long_send(1, 1, 511, 0, number, 1e6 / hz, 0, 0, 0, 0, 0)
    link.mav.param_request_list_send(1, 1)
    assert pilot.fly(60.0, pilot.heard("EKF3 IMU0 is using GPS"))
    link.set_mode("TAKEOFF")
    link.mav.command_long_send(1, 1, 400, 0, 1, 21196, 0, 0, 0, 0, 0)
    assert pilot.fly(60.0, lambda: pilot.height_m > 45.0), pilot.texts[-3:]
    pilot.sticks[2], pilot.sticks[1] = 1600, 1800
    link.set_mode("FBWB")
    assert pilot.fly(40.0, lambda: pilot.height_m > 70.0), pilot.texts[-3:]
    pilot.sticks[2], pilot.sticks[1] = _CRUISE_US, 1500
    pilot.fly(8.0)
    link.set_mode("FBWA")
    pilot.fly(2.0)
