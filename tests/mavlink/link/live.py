"""``advisor live`` as processes, and a recorded flight that is sent to them over UDP."""

import json
import os
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from tests.mavlink.link.air import Record
from tests.mavlink.link.builders import free_port, wait_until

LONGEST_STEP_S = 0.01
"""Wall time between two looks at the flight's clock, s."""


class Advising:
    """One flight test as text; its files lie in a folder of its own.

    Every start makes a new process; ``narrator`` and ``keeper`` are the processes behind the newest one.
    """

    def __init__(self, folder: Path, *options: str) -> None:
        self.folder = folder
        self.port = free_port()
        self._options = options
        self.environment = {**os.environ, "HEADLESS": "1", "XDG_DATA_HOME": str(folder / "data")}
        self._starts = 0
        self.process: subprocess.Popen[bytes] | None = None

    @property
    def recording(self) -> Path:
        """The file of the recording."""
        return self.folder / "flight.tlog"

    def start(self, *options: str) -> None:
        """Begin; without options on the test's own port and recording."""
        self.launch(*options)
        wait_until(lambda: self.answers or self.process.poll() is not None, 30.0)

    def launch(self, *options: str) -> None:
        """Begin, and wait for nothing."""
        self._starts += 1
        words = options or ("--master", f"udpin:127.0.0.1:{self.port}", "--record", str(self.recording))
        with self._file("out").open("wb") as out, self._file("err").open("wb") as err:
            self.process = subprocess.Popen(
                [sys.executable, "-m", "advisor", "live", *words, *self._options],
                stdout=out,
                stderr=err,
                env=self.environment,
                preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_DFL),
            )

    def resume(self) -> None:
        """Take the flight test up."""
        self.start("--resume", str(self.recording))

    @property
    def answers(self) -> bool:
        """Whether the newest start has said where it records."""
        return any(
            line.startswith(("recording to ", "nothing is recorded")) for line in self.warned.splitlines()
        )

    def end(self, by: signal.Signals = signal.SIGINT) -> int:
        """Send a signal, and wait for the exit code."""
        assert self.process is not None
        self.process.send_signal(by)
        return self.process.wait(20.0)

    def kill(self) -> None:
        """Kill the process with the face as an out-of-memory killer does."""
        assert self.process is not None
        self.process.kill()
        self.process.wait()

    def clear(self) -> None:
        """End whatever still runs, each process by its id."""
        for pid in [self.keeper, *([self.process.pid] if self.process else [])]:
            if pid is not None:
                _signal(pid, signal.SIGKILL)
        if self.process is not None:
            self.process.wait()

    @property
    def said(self) -> list[str]:
        """Lines of the newest start on standard output."""
        return self._file("out").read_text().splitlines()

    @property
    def warned(self) -> str:
        """Everything of the newest start on standard error."""
        return self._file("err").read_text()

    @property
    def keeper(self) -> int | None:
        """Process of the link."""
        notes = list((self.folder / "data" / "inflight-advisor" / "links").glob("*.json"))
        return max((int(note.stem) for note in notes if _lives(int(note.stem))), default=None)

    @property
    def narrator(self) -> int | None:
        """Process that estimates."""
        assert self.process is not None
        listed = Path(f"/proc/{self.process.pid}/task/{self.process.pid}/children").read_text().split()
        for pid in map(int, listed):
            if b"narrator" in _command_of(pid):
                return pid
        return None

    @property
    def whole(self) -> bool:
        """Whether all three processes live, and the process of the link is looked after."""
        return (
            self.narrator is not None
            and self.keeper is not None
            and not self.note_of_keeper().get("alone", True)
        )

    def note_of_keeper(self) -> dict[str, object]:
        """What the process of the link notes of itself."""
        path = self.folder / "data" / "inflight-advisor" / "links" / f"{self.keeper}.json"
        try:
            content: dict[str, object] = json.loads(path.read_text())
        except OSError:  # it has just ended
            return {}
        return content

    def _file(self, kind: str) -> Path:
        return self.folder / f"{kind}-{self._starts}.txt"


def fly(
    records: Sequence[Record],
    port: int,
    speed: float | Callable[[], float],
    meanwhile: Callable[[float], object],
) -> None:
    """Send a recorded flight.

    Parameters
    ----------
    speed
        Multiple of the flight's own speed, which may change. A sender that gets no processor time holds the
        flight: nothing is sent in a burst.
    meanwhile
        Called between packets with the seconds of flight that have passed.
    """
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as end:
        flown_s, before_s = 0.0, time.monotonic()
        for record in records:
            due_s = (record.stamp_us - records[0].stamp_us) / 1e6
            while flown_s < due_s:
                meanwhile(flown_s)
                pace = speed() if callable(speed) else speed
                time.sleep(min((due_s - flown_s) / pace, LONGEST_STEP_S))
                now_s = time.monotonic()
                flown_s += pace * min(now_s - before_s, 2.0 * LONGEST_STEP_S)
                before_s = now_s
            end.sendto(record.frame, ("127.0.0.1", port))


def kill(pid: int | None) -> None:
    """Kill a process by its id, as an out-of-memory killer does."""
    if pid is not None:
        _signal(pid, signal.SIGKILL)


def stand_still(pid: int | None, seconds: float) -> None:
    """Stop a process by its id for a while, as a full memory or a debugger does."""
    if pid is not None:
        _signal(pid, signal.SIGSTOP)
        going_on = threading.Timer(seconds, _signal, (pid, signal.SIGCONT))
        going_on.daemon = True
        going_on.start()


def _signal(pid: int, number: int) -> None:
    try:
        os.kill(pid, number)
    except ProcessLookupError:
        return


def _lives(pid: int) -> bool:
    return b"keeper" in _command_of(pid)


def _command_of(pid: int) -> bytes:
    try:
        return Path(f"/proc/{pid}/cmdline").read_bytes()
    except OSError:
        return b""
