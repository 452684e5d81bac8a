"""Real peers: the bundled aircraft as a process, MAVProxy between, pymavlink's tools afterwards."""

import json
import socket
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from advisor.flight.signals.messages import Columns
from advisor.mavlink.link.announce import Announcer, SeparateConnection
from advisor.mavlink.link.inquiry import Inquiry
from advisor.mavlink.link.link import Link
from advisor.mavlink.link.rates import RateRequest
from advisor.mavlink.logs.logs import open_log
from tests.heard import hear
from tests.mavlink.link.builders import free_port, wait_until

TOOLS = Path(sys.executable).parent
SHORT_FLIGHT = """
maneuvers: [{input: "3211"}, {input: "rev"}]
"""


@contextmanager
def running(*command: str, folder: Path) -> Iterator[subprocess.Popen[bytes]]:
    """A process of its own, ended by its id."""
    with (folder / f"{Path(command[1]).stem}.out").open("wb") as output:
        process = subprocess.Popen(
            [sys.executable, *command], stdin=subprocess.PIPE, stdout=output, stderr=subprocess.STDOUT
        )
        try:
            yield process
        finally:
            process.kill()
            process.communicate()


def aircraft(connection: str, folder: Path, speed: float) -> tuple[str, ...]:
    scenario = folder / "short.yaml"
    scenario.write_text(SHORT_FLIGHT)
    return ("-m", "sim", "fly", "--master", connection, "--speed", str(speed), "--scenario", str(scenario))


def fly_to_the_end(link: Link, process: subprocess.Popen[bytes]) -> list[list[Columns]]:
    batches = []
    quiet_since_s = time.monotonic()
    while process.poll() is None or time.monotonic() - quiet_since_s < 0.5:
        if batch := link.read(0.1):
            batches.append(batch)
            quiet_since_s = time.monotonic()
    return batches


def maneuvers(batches: list[list[Columns]]) -> list[tuple[float, ...]]:
    """Start and every sample of every channel of every manoeuvre flown."""
    return hear(batches).samples


def test_a_flight_of_the_bundled_aircraft_is_the_same_live_and_from_the_recording_and_pymavlink_reads_it(
    tmp_path: Path,
) -> None:
    port = free_port()
    own = tmp_path / "own.tlog"
    with (
        Link(f"udpin:127.0.0.1:{port}", record_to=own) as link,
        running(*aircraft(f"udpout:127.0.0.1:{port}", tmp_path, 25.0), folder=tmp_path) as process,
    ):
        live = fly_to_the_end(link, process)
        assert link.statistics.lost == 0
    assert len(maneuvers(live)) == 2
    assert maneuvers(live) == maneuvers(list(open_log(own)))

    dump = subprocess.run(
        [sys.executable, str(TOOLS / "mavlogdump.py"), "--format", "json", str(own)],
        capture_output=True,
        check=True,
        timeout=60,
    )
    seen = Counter(
        json.loads(line)["meta"]["type"] for line in dump.stdout.splitlines() if line.startswith(b"{")
    )
    mine = Counter(part.name for batch in live for part in batch for _ in range(len(part)))
    assert {name: seen[name] for name in mine} == dict(mine)
    assert "BAD_DATA" not in seen


def test_mavproxy_between_passes_the_flight_the_requests_and_a_whole_announcement(tmp_path: Path) -> None:
    vehicle_port, advisor_port = free_port(), free_port()
    rates, inquiry = RateRequest({"ATTITUDE": 40.0, "AOA_SSA": 20.0}), Inquiry()
    announcer = Announcer()
    aside = SeparateConnection(announcer, f"udpout:127.0.0.1:{vehicle_port}")
    proxy = (
        str(TOOLS / "mavproxy.py"),
        f"--master=udpin:127.0.0.1:{vehicle_port}",
        f"--out=udpout:127.0.0.1:{advisor_port}",
        "--non-interactive",
        "--streamrate=-1",
        "--default-modules=link",
        f"--state-basedir={tmp_path}",
        f"--logfile={tmp_path / 'proxy.tlog'}",
    )
    sentence = "REPEAT: too gentle, pitch rate 3 deg/s (at least 5); use about 1.5 times the stick"
    with (
        Link(f"udpin:127.0.0.1:{advisor_port}", talkers=[rates, inquiry, aside]) as link,
        running(*proxy, folder=tmp_path),
    ):
        wait_for_udp(vehicle_port)
        with running(*aircraft(f"udpout:127.0.0.1:{vehicle_port}", tmp_path, 1.0), folder=tmp_path):
            wait_until(lambda: bool(rates.delivered_hz), timeout_s=20.0)
            wait_until(lambda: inquiry.done, timeout_s=20.0)
            announcer.judged(1, sentence)
            wait_until(lambda: f"@1 {sentence}".encode() in said_in(tmp_path), timeout_s=20.0)
        assert link.statistics.vehicle == (1, 1)
    assert rates.answers == {"ATTITUDE": "granted", "AOA_SSA": "granted"}
    assert 36.0 < rates.delivered_hz["ATTITUDE"] < 44.0
    assert 18.0 < rates.delivered_hz["AOA_SSA"] < 22.0
    assert inquiry.parameters["SERVO2_FUNCTION"] == 19.0
    assert {"SERVO2_MIN", "SERVO2_TRIM", "SERVO2_MAX", "SERVO2_REVERSED"} <= inquiry.parameters.keys()


def said_in(folder: Path) -> bytes:
    """What the processes that run in a folder have printed."""
    return b"".join(file.read_bytes() for file in folder.glob("*.out"))


def wait_for_udp(port: int) -> None:
    """Return once somebody listens on the port."""

    def taken() -> bool:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            try:
                probe.bind(("127.0.0.1", port))
            except OSError:
                return True
        return False

    wait_until(taken, timeout_s=20.0)
