"""The process of a link, as the process with the screens looks after it."""

import contextlib
import os
import pickle
import socket
import subprocess
import sys
import threading
from dataclasses import replace
from multiprocessing.connection import Connection
from pathlib import Path
from types import TracebackType
from typing import Self

from advisor.mavlink.connection import parse_connection
from advisor.mavlink.keeping import Guard, Keeping, Stop
from advisor.mavlink.kept_link import KeptLink
from advisor.mavlink.running import RunningLink
from advisor.mavlink.sockets import udp_socket

RETRY_EVERY_S = 1.0
PATIENCE_S = 10.0
"""So long a process may take to close its recording."""


class LinkProcess:
    """Starts the process of a link, starts it again when something ends it, and stops it.

    Parameters
    ----------
    keeping
        The link and its recording.
    running
        A process that keeps this link already and that nobody looks after; None: start one.
    """

    def __init__(self, keeping: Keeping, running: RunningLink | None = None) -> None:
        self._keeping = keeping
        self._running = running
        self._process: subprocess.Popen[bytes] | None = None
        self._socket: socket.socket | None = None
        self._guard: Connection | None = None
        self._stopping = threading.Event()
        self._thread = threading.Thread(target=self._look_after, name="guard", daemon=True)
        self.recording: Path | None = running.recording if running else None
        """File of the recording; None where nothing is recorded."""

    @property
    def link(self) -> KeptLink:
        """A new reader of the link; it can be handed to another process before it reads."""
        return KeptLink(self._keeping.door)

    @property
    def master(self) -> str:
        """Connection of the link."""
        return self._keeping.master

    @property
    def pid(self) -> int | None:
        """Number of the process; None for one that another advisor has started."""
        return self._process.pid if self._process else None

    def __enter__(self) -> Self:
        """Start.

        Raises
        ------
        UnusableInputError
            The connection cannot be opened, or the recording cannot be made.
        """
        if self._running is None:
            self._hold_socket()
            self._start()
            # Started again, the process goes on with the recording that the first one made.
            goes_on = self.recording is not None
            self._keeping = replace(self._keeping, record_to=self.recording, goes_on=goes_on)
        self._guard = self._stand_guard()
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._stopping.set()
        _ask_to_stop(self._guard)
        self._thread.join(PATIENCE_S)
        if self._process is not None:
            try:
                self._process.wait(PATIENCE_S)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()
        if self._socket is not None:
            self._socket.close()

    def _hold_socket(self) -> None:
        """Open a UDP socket here, so that packets wait in the kernel while the process is started again."""
        address = parse_connection(self._keeping.master)
        if address.kind.startswith("udp") and os.name == "posix":
            with contextlib.suppress(OSError):  # the process will meet the same error, and can say so
                self._socket = udp_socket(address)
                self._keeping = replace(self._keeping, inherited=self._socket.fileno())

    def _start(self) -> None:
        process = subprocess.Popen(
            [sys.executable, "-m", "advisor.mavlink.keeper"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            # A terminal that is closed, or an interrupt in it, is nothing to the recording.
            start_new_session=True,
            pass_fds=[self._socket.fileno()] if self._socket else [],
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
        connection = self._keeping.door.open()
        connection.send(Guard())
        return connection

    def _look_after(self) -> None:
        """Wait for the end of the process; unless it was asked for, start the process again."""
        while not self._stopping.is_set():
            with contextlib.suppress(OSError, EOFError):
                if self._guard is not None:
                    self._guard.recv()  # nothing is sent: this returns when the process has ended
            if self._stopping.is_set():
                return
            if self._process is not None:
                self._process.wait()
            try:
                self._start()
                self._guard = self._stand_guard()
            except Exception:
                self._guard = None
                self._stopping.wait(RETRY_EVERY_S)


def end(running: RunningLink) -> None:
    """End a link that runs alone; its recording is whole afterwards."""
    with contextlib.suppress(OSError, EOFError):
        connection = running.door.open()
        _ask_to_stop(connection)
        if connection.poll(PATIENCE_S):
            connection.recv()  # nothing is sent: this returns when the process ends


def _ask_to_stop(connection: Connection | None) -> None:
    with contextlib.suppress(OSError):
        if connection is not None:
            connection.send(Stop())
