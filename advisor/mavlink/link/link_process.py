"""Supervision of a link's process by the process of the screens, and the links that run now."""

import contextlib
import json
import os
import pickle
import signal
import subprocess
import threading
from collections.abc import Iterator
from dataclasses import dataclass, replace
from multiprocessing.connection import Connection
from multiprocessing.reduction import recv_handle
from pathlib import Path
from threading import Thread
from typing import Literal, Self

import platformdirs

from advisor.aircraft.aircraft import Elevator
from advisor.mavlink.link.kept_link import Door, Keeping, KeptLink, Request
from advisor.process.atomic_file import write_atomically
from advisor.process.children import python_module
from advisor.process.interrupt import hung_up

ANSWERS_WITHIN_S = 5.0
"""Time within which a link's process must answer a caller, s. No task of the process takes a second."""


@dataclass(frozen=True, slots=True)
class RunningLink:
    """A process that keeps a link."""

    pid: int
    master: str
    recording: Path | None
    door: Door
    alone: bool
    """Whether the process is unguarded, because its advisor ended abruptly."""


def note(link: RunningLink) -> None:
    """Write a file about a running link and its state, readable by the user only."""
    path = _path(link.pid)
    path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    content = {
        "master": link.master,
        "recording": str(link.recording) if link.recording else None,
        "address": link.door.address,
        "key": link.door.key.hex(),
        "alone": link.alone,
    }
    write_atomically(path, json.dumps(content))


def forget(pid: int) -> None:
    """Remove the file about a link that has ended."""
    with contextlib.suppress(OSError):
        _path(pid).unlink(missing_ok=True)


def running_alone() -> Iterator[RunningLink]:
    """Yield links that run without their advisor. Files about ended processes are removed.

    An unguarded process that hangs is ended, because it would keep its connection.
    """
    for path in sorted(_folder().glob("*.json")):
        with contextlib.suppress(OSError, ValueError, KeyError, TypeError):
            link = _read(path)
            state = _state(link.door)
            if state == "hangs" and link.alone:
                os.kill(link.pid, signal.SIGKILL)
            if state == "gone" or (state == "hangs" and link.alone):
                forget(link.pid)
            elif link.alone:
                yield link


def _state(door: Door) -> Literal["answers", "hangs", "gone"]:
    """Return whether the process at an address answers within ``ANSWERS_WITHIN_S``."""
    states: list[Literal["answers", "gone"]] = []

    def knock() -> None:
        try:
            door.open().close()
            states.append("answers")
        except (OSError, EOFError):
            states.append("gone")

    knocking = Thread(target=knock, daemon=True)
    knocking.start()
    knocking.join(ANSWERS_WITHIN_S)
    return states[0] if states else "hangs"


def _read(path: Path) -> RunningLink:
    content = json.loads(path.read_text(encoding="utf-8"))
    recording = Path(content["recording"]) if content["recording"] else None
    door = Door(content["address"], bytes.fromhex(content["key"]))
    return RunningLink(int(path.stem), content["master"], recording, door, bool(content["alone"]))


def _folder() -> Path:
    return Path(platformdirs.user_data_dir("inflight-advisor")) / "links"


def _path(pid: int) -> Path:
    return _folder() / f"{pid}.json"


RETRY_EVERY_S = 1.0
ASK_EVERY_S = 0.5
"""Time between two checks whether the process works, s."""
HUNG_AFTER_S = 5.0
"""Time without work, s, after which the process is ended and restarted. No task of the process takes a
second. Meanwhile the socket's buffer keeps packets of 1 s, and later ones are lost."""
PATIENCE_S = 10.0
"""Longest time that a process may take to close its recording, s."""


class LinkProcess:
    """Supervisor of a link's process, which starts, restarts and stops it.

    Parameters
    ----------
    running
        Running process that keeps this link and is unguarded. None to start a new process.
    """

    def __init__(self, keeping: Keeping, running: RunningLink | None = None) -> None:
        self._keeping = keeping
        self._running = running
        self._process: subprocess.Popen[bytes] | None = None
        self._socket: int | None = None
        self._guard: Connection | None = None
        self._stopping = threading.Event()
        self._thread = threading.Thread(target=self._look_after, name="guard", daemon=True)
        self.recording: Path | None = running.recording if running else None
        """File of the recording; None without a recording."""

    def link(self, elevator: Elevator | None = None) -> KeptLink:
        """Return a new reader of the link, which can be handed to another process before its first read.

        Parameters
        ----------
        elevator
            Elevator of the aircraft file, which shows which vehicle has one. None to decide by parameters.
        """
        return KeptLink(self._keeping.door, elevator, self._keeping.target_system)

    @property
    def door(self) -> Door:
        return self._keeping.door

    @property
    def master(self) -> str:
        return self._keeping.master

    @property
    def pid(self) -> int | None:
        """Id of the process. None for a process started by another advisor."""
        return self._process.pid if self._process else None

    def __enter__(self) -> Self:
        """Start the process.

        Raises
        ------
        UnusableInputError
            The connection cannot be opened, or the recording cannot be made.
        """
        if self._running is None:
            self._start()
            # After a restart the process goes on with the recording that the first process made.
            goes_on = self.recording is not None
            self._keeping = replace(self._keeping, record_to=self.recording, goes_on=goes_on)
        self._guard = self._stand_guard()
        self._thread.start()
        return self

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        self._stopping.set()
        if hung_up(error):
            return  # nobody has asked for an end: the link goes on recording by itself
        _ask_to_stop(self._guard)
        self._thread.join(PATIENCE_S)
        if self._process is not None:
            try:
                self._process.wait(PATIENCE_S)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()
        self._let_go()

    def _start(self) -> None:
        process = subprocess.Popen(
            python_module("advisor.mavlink.link.keeper"),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            # The recording must not depend on a terminal's end or an interrupt in it.
            start_new_session=True,
            pass_fds=[] if self._socket is None else [self._socket],
        )
        assert process.stdin is not None
        assert process.stdout is not None
        with process.stdin as task, process.stdout as answers:
            pickle.dump(self._keeping, task)
            task.close()
            try:
                answer = pickle.load(answers)
            except EOFError:
                answer = RuntimeError(f"The process of the link ended with exit code {process.wait()}.")
        if isinstance(answer, Exception):
            process.wait()
            raise answer
        self._process, self.recording = process, answer

    def _stand_guard(self) -> Connection:
        """Guard the process, and hold its UDP socket for the next process."""
        connection = self._keeping.door.open()
        connection.send(Request.GUARD)
        if connection.recv():
            self._let_go()
            self._socket = recv_handle(connection)
            self._keeping = replace(self._keeping, inherited=self._socket)
        return connection

    def _let_go(self) -> None:
        if self._socket is not None:
            os.close(self._socket)
            self._socket = None

    def _hangs(self, guard: Connection) -> bool:
        """Wait until the process ends or hangs for ``HUNG_AFTER_S``, and return whether it hangs."""
        while True:
            guard.send(Request.ALIVE)
            if not guard.poll(HUNG_AFTER_S):
                return True
            if guard.recv() >= HUNG_AFTER_S:
                return True
            guard.poll(ASK_EVERY_S)  # nothing is sent: this returns early when the process ends

    def _kill(self) -> None:
        running = self._running.pid if self._running is not None else None
        pid = self._process.pid if self._process is not None else running
        if pid is not None:
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)

    def _await_end(self) -> None:
        if self._process is not None:
            with contextlib.suppress(subprocess.TimeoutExpired):  # the system itself waits, for a disk
                self._process.wait(PATIENCE_S)

    def _look_after(self) -> None:
        while not self._stopping.is_set():
            with contextlib.suppress(OSError, EOFError):
                if self._guard is not None and self._hangs(self._guard):
                    self._kill()
            if self._stopping.is_set():
                return
            self._await_end()
            try:
                self._start()
                self._guard = self._stand_guard()
            except Exception:
                self._guard = None
                self._stopping.wait(RETRY_EVERY_S)


def end(running: RunningLink) -> None:
    """End a link that runs without an advisor. The recording of the link is then complete."""
    with contextlib.suppress(OSError, EOFError):
        connection = running.door.open()
        _ask_to_stop(connection)
        if connection.poll(PATIENCE_S):
            connection.recv()  # nothing is sent: this returns when the process ends


def _ask_to_stop(connection: Connection | None) -> None:
    with contextlib.suppress(OSError):
        if connection is not None:
            connection.send(Request.STOP)
