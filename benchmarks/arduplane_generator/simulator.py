"""ArduPlane in software in the loop: started, armed, flown by a script, and recorded."""

import json
import lzma
import os
import socket
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path

os.environ.setdefault("MAVLINK20", "1")

from pymavlink import mavutil
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from .plan import END

FOLDER = Path("../shared/sitl")
"""Folder with the packed program and its defaults, next to a checkout."""
HOME = "-35.36,149.16,584,353"
SPEEDUP = "10"
CLIMBED_M = 40.0
"""Height above home at which the take-off ends, m."""
_LONGEST_S = 600.0
"""Longest vehicle time of a flight, s."""
_SILENCE_S, _PATIENCE_S = 30.0, 900.0
"""Longest time without a message, and of a whole flight, on the clock of the host, s."""
_RATES_HZ = {30: 50, 74: 10, 36: 50, 27: 50, 11020: 50, 33: 10, 29: 5}
"""Identifier of each message to its rate: ATTITUDE, VFR_HUD, SERVO_OUTPUT_RAW, RAW_IMU, AOA_SSA,
GLOBAL_POSITION_INT, SCALED_PRESSURE."""
_FORCED = 21196
"""Parameter of the arming command that leaves out its checks."""


class FlightError(RuntimeError):
    """The simulated flight did not come to its end."""


@dataclass
class Heard:
    """State of the vehicle by its newest messages, and everything that was heard."""

    boot_s: float = 0.0
    height_m: float = 0.0
    texts: list[str] = field(default_factory=list)
    messages: list[tuple[float, mavlink.MAVLink_message]] = field(default_factory=list)
    """Vehicle time of the newest attitude, s, with each message."""

    def take(self, message: mavlink.MAVLink_message) -> None:
        """Take a message of the vehicle."""
        kind = message.get_type()
        if kind == "ATTITUDE":
            self.boot_s = message.time_boot_ms * 1e-3
        elif kind == "GLOBAL_POSITION_INT":
            self.height_m = message.relative_alt * 1e-3
        elif kind == "STATUSTEXT":
            self.texts.append(message.text)
            if message.text.startswith("Lua:"):
                raise FlightError(message.text)
        self.messages.append((self.boot_s, message))


def is_here(folder: Path = FOLDER) -> bool:
    """Return whether the simulator lies next to this checkout."""
    return (folder / "arduplane.xz").is_file()


def fly(coefficients: Mapping[str, float], parameters: Mapping[str, float], lua: str) -> Heard:
    """Fly a script, and return everything that the vehicle sent.

    Parameters
    ----------
    coefficients
        Numbers of the plane, by ArduPilot's names.
    parameters
        Parameters of the vehicle in addition to the defaults.

    Raises
    ------
    FlightError
        The vehicle did not take off, fell silent, or did not end the script.
    """
    with tempfile.TemporaryDirectory() as name:
        work = Path(name)
        program = work / "arduplane"
        program.write_bytes(lzma.decompress((FOLDER / "arduplane.xz").read_bytes()))
        program.chmod(0o755)
        (work / "plane.json").write_text(json.dumps(dict(coefficients), indent=1), encoding="utf-8")
        more = "".join(f"\n{key} {value}" for key, value in parameters.items())
        defaults = (FOLDER / "plane.parm").read_text(encoding="utf-8")
        (work / "plane.parm").write_text(f"{defaults}{more}\n", encoding="utf-8")
        (work / "scripts").mkdir()
        (work / "scripts" / "flight.lua").write_text(lua, encoding="utf-8")
        with _running(work) as port:
            return _recorded(port)


@contextmanager
def _running(work: Path) -> Iterator[int]:
    """Run ArduPlane in a folder; provide the port of its link, and end the process afterwards."""
    port, rc_in, sim_in = _free_ports()
    arguments = [
        "./arduplane", "--model", "plane", "--speedup", SPEEDUP, "--home", HOME, "--defaults", "plane.parm",
        "--wipe", "--base-port", str(port), "--rc-in-port", str(rc_in), "--sim-port-in", str(sim_in),
    ]  # fmt: skip
    environment = dict(os.environ, PLANE_COEFFICIENTS="plane.json")
    with (work / "output.txt").open("w") as said:
        process = subprocess.Popen(
            arguments, cwd=work, env=environment, stdout=said, stderr=said, stdin=subprocess.DEVNULL
        )
        try:
            yield port
        finally:
            process.terminate()
            try:
                process.wait(10.0)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


def _free_ports() -> list[int]:
    """Return three free ports, chosen by the system."""
    sockets = [socket.socket() for _ in range(3)]
    for one in sockets:
        one.bind(("127.0.0.1", 0))
    ports = [int(one.getsockname()[1]) for one in sockets]
    for one in sockets:
        one.close()
    return ports


def _recorded(port: int) -> Heard:
    """Take off, start the script, and return what was heard until its end."""
    link, heard = _connected(port), Heard()
    with suppress(OSError):
        link.wait_heartbeat(timeout=_SILENCE_S)
    for message, rate in _RATES_HZ.items():
        link.mav.command_long_send(1, 1, 511, 0, message, 1e6 / rate, 0, 0, 0, 0, 0)
    link.mav.param_request_list_send(1, 1)
    until = time.monotonic() + _PATIENCE_S
    origin = "EKF3 IMU0 origin"
    _pump(link, heard, lambda: heard.boot_s > 45.0 or any(origin in text for text in heard.texts), until)
    link.set_mode("TAKEOFF")
    link.mav.command_long_send(1, 1, 400, 0, 1, _FORCED, 0, 0, 0, 0, 0)
    begun = heard.boot_s
    _pump(link, heard, lambda: heard.height_m > CLIMBED_M or heard.boot_s > begun + 120.0, until)
    if heard.height_m <= CLIMBED_M:
        raise FlightError(f"the take-off ended at {heard.height_m:.0f} m: {heard.texts[-5:]}")
    link.mav.param_set_send(1, 1, b"SCR_USER1", 1.0, 9)
    _pump(link, heard, lambda: END in heard.texts or heard.boot_s > _LONGEST_S, until)
    if END not in heard.texts:
        raise FlightError(f"the script did not end: {heard.texts[-5:]}")
    link.close()
    return heard


def _connected(port: int) -> mavutil.mavfile:
    """Connect to the vehicle, which begins to listen some time after its start."""
    until = time.monotonic() + _SILENCE_S
    while True:
        try:
            return mavutil.mavlink_connection(
                f"tcp:127.0.0.1:{port}", source_system=254, dialect="ardupilotmega", retries=0
            )
        except OSError:
            if time.monotonic() > until:
                raise FlightError(f"nothing listens on port {port}") from None
            time.sleep(0.2)


def _pump(link: mavutil.mavfile, heard: Heard, ends: Callable[[], bool], until: float) -> None:
    """Take messages until a condition holds, with a heartbeat of the ground each second."""
    beat = 0.0
    while not ends():
        message = link.recv_match(blocking=True, timeout=_SILENCE_S)
        if message is None or time.monotonic() > until:
            raise FlightError(f"the vehicle is silent or slow after {heard.boot_s:.0f} s: {heard.texts[-3:]}")
        if message.get_type() != "BAD_DATA" and message.get_srcSystem() == 1:
            heard.take(message)
        if time.monotonic() > beat + 1.0:
            beat = time.monotonic()
            link.mav.heartbeat_send(6, 8, 0, 0, 0)
