"""Process of the link, which receives and records bytes and forwards them to its readers.

python -m advisor.mavlink.link.keeper

The keeper makes no estimate or drawing and decodes nothing, so no fault there can harm the link.
"""

import contextlib
import os
import pickle
import signal
import sys
import threading
import time
from collections import deque
from multiprocessing.connection import Connection, Listener
from multiprocessing.reduction import send_handle
from pathlib import Path
from queue import Empty, SimpleQueue
from threading import Thread

from advisor.mavlink.link import link_process
from advisor.mavlink.link.announce import Announcer, SeparateConnection
from advisor.mavlink.link.inquiry import Inquiry
from advisor.mavlink.link.kept_link import (
    AnnounceOrder,
    CallOrder,
    Heard,
    Hello,
    Keeping,
    Request,
    Told,
    UplinkOrder,
)
from advisor.mavlink.link.link import Link
from advisor.mavlink.link.outgoing import Talker
from advisor.mavlink.link.rates import STREAMS, RateRequest
from advisor.mavlink.link.uplink import Uplink
from advisor.process import interrupt
from advisor.words.problems import UnusableInputError

TELL_EVERY_S = 0.2
ALONE_FOR_S = 60.0
"""Time for which a link without an advisor waits for a silent vehicle before it ends, s."""
MOST_BEHIND_BYTES = 64_000_000
"""Backlog of a reader, bytes, above which its connection is closed. The reader connects again and reads the
recording."""

_Message = Hello | Heard | Told


class Reader:
    """Sender to one reader in a separate thread, so that a slow reader delays no other."""

    def __init__(self, connection: Connection, hello: Hello | None = None) -> None:
        self._connection = connection
        self._waiting: SimpleQueue[_Message] = SimpleQueue()
        self._behind_bytes = 0
        self.gone = False
        if hello is not None:
            self.send(hello)
        Thread(target=self._run, daemon=True).start()

    def send(self, message: _Message) -> None:
        if isinstance(message, Heard):
            self._behind_bytes += len(message.records)
        self._waiting.put(message)

    def _run(self) -> None:
        with contextlib.suppress(OSError):
            while self._behind_bytes <= MOST_BEHIND_BYTES:
                message = self._waiting.get()
                self._connection.send(message)
                if isinstance(message, Heard):
                    self._behind_bytes -= len(message.records)
        self.gone = True
        self._connection.close()


class Keeper:
    """Keeper of one link until a stop, or until no advisor guards it and the vehicle is silent."""

    def __init__(self, keeping: Keeping) -> None:
        self._keeping = keeping
        self._announcer = Announcer() if keeping.announce else None
        self._uplink = Uplink() if keeping.uplink else None
        self._link = Link(
            keeping.master,
            target_system=keeping.target_system,
            record_to=keeping.record_to,
            goes_on=keeping.goes_on,
            key=keeping.signing_key,
            talkers=[*_talkers(keeping, self._announcer), *([self._uplink] if self._uplink else [])],
            inherited=keeping.inherited,
        )
        self._listener = Listener(keeping.door.address, authkey=keeping.door.key)
        self._arrived: SimpleQueue[Connection] = SimpleQueue()
        self._readers: list[Reader] = []
        self._observers: list[Reader] = []
        self._passed_on = 0
        self._kept: deque[bytes] = deque()
        self._kept_bytes = 0
        self._looked_s = time.monotonic()
        self._guards = 0
        self._alone_since_s: float | None = None
        self._lock = threading.Lock()
        self._stop = threading.Event()

    def start(self) -> Path | None:
        """Open the link, and return the file of the recording.

        Raises
        ------
        UnusableInputError
            The connection cannot be opened, or the recording cannot be made.
        """
        self._link.start()
        self._passed_on = self._hello().before
        Thread(target=self._accept, daemon=True).start()
        return self.recording

    @property
    def recording(self) -> Path | None:
        """File of the recording. None if nothing is recorded."""
        recorder = self._link.recorder
        return recorder.path if recorder else None

    def run(self) -> None:
        """Forward the link's bytes until the end, then close link and recording."""
        told_s = time.monotonic()
        try:
            while not self._stop.is_set() and not self._abandoned():
                records = self._link.read_records(0.05)
                if records:
                    self._send(Heard(self._passed_on, records, self._link.read_to_s))
                    self._passed_on += len(records)
                    self._keep(records)
                self._looked_s = time.monotonic()
                self._admit()
                if time.monotonic() - told_s >= TELL_EVERY_S:
                    told_s = time.monotonic()
                    self._tell()
        finally:
            self._link.stop()
            self._tell()
            self._listener.close()

    def stop(self) -> None:
        """End ``run`` at the next opportunity."""
        self._stop.set()

    def _admit(self) -> None:
        with contextlib.suppress(Empty):
            while True:
                self._readers.append(Reader(self._arrived.get_nowait(), self._hello()))

    def _hello(self) -> Hello:
        recorder = self._link.recorder
        if recorder is None:
            kept = b"".join(self._kept)
            return Hello(None, self._passed_on - len(kept), kept, 0)
        recorded = recorder.recorded()
        return Hello(recorder.path, recorded.written, recorded.unsaved, recorder.before)

    def _keep(self, records: bytes) -> None:
        """Keep the newest records for later readers where no recording has them."""
        if self._link.recorder is None:
            self._kept.append(records)
            self._kept_bytes += len(records)
            while self._kept_bytes > MOST_BEHIND_BYTES:
                self._kept_bytes -= len(self._kept.popleft())

    def _tell(self) -> None:
        notices: tuple[str, ...] = tuple(self._link.take_notices()) if self._readers else ()
        statistics = self._link.statistics
        self._send(Told(statistics, notices))
        with self._lock:
            self._observers = [observer for observer in self._observers if not observer.gone]
        for observer in self._observers:
            observer.send(Told(statistics, ()))

    def _send(self, message: _Message) -> None:
        self._readers = [reader for reader in self._readers if not reader.gone]
        for reader in self._readers:
            reader.send(message)

    def _abandoned(self) -> bool:
        """Return whether no advisor guards the link, and the vehicle has long been silent."""
        since_s, now_s = self._alone_since_s, time.monotonic()
        if since_s is None or now_s - since_s < ALONE_FOR_S:
            return False
        return self._link.statistics.silent_s > ALONE_FOR_S

    # The methods below run in threads of the connections.

    def _accept(self) -> None:
        while not self._stop.is_set():
            try:
                connection = self._listener.accept()
            except Exception:  # a caller without the key, or one that hung up; at the end the listener itself
                if self._stop.is_set():
                    return
                time.sleep(0.01)
                continue
            Thread(target=self._serve, args=(connection,), daemon=True).start()

    def _serve(self, connection: Connection) -> None:
        guards = False
        with contextlib.suppress(EOFError, OSError):
            while True:
                match connection.recv():
                    case Request.LISTEN:
                        self._arrived.put(connection)
                    case Request.OBSERVE:
                        with self._lock:
                            self._observers.append(Reader(connection))
                    case Request.GUARD:
                        guards = True
                        self._lend_socket(connection)
                        self._guarded(+1)
                    case Request.ALIVE:
                        at_work_s = min(self._looked_s, self._link.looked_s)
                        connection.send(time.monotonic() - at_work_s)
                    case AnnounceOrder(method, arguments) if self._announcer:
                        getattr(self._announcer, method)(*arguments)
                    case UplinkOrder(which, size_deg, unit_s) if self._uplink:
                        self._uplink.order(which, size_deg, unit_s)
                    case CallOrder(method, arguments):
                        getattr(self._link, method)(*arguments)
                    case Request.STOP:
                        self._stop.set()
                        return
        if guards:
            self._guarded(-1)

    def _lend_socket(self, connection: Connection) -> None:
        """Share a UDP socket, in which packets wait for the next process after this one's death."""
        descriptor = self._link.descriptor if os.name == "posix" else None
        connection.send(descriptor is not None)
        if descriptor is not None:
            send_handle(connection, descriptor, None)

    def _guarded(self, more: int) -> None:
        with self._lock:
            self._guards += more
            self._alone_since_s = None if self._guards else time.monotonic()
            link = self._keeping
            alone = self._guards == 0
            with contextlib.suppress(OSError):
                link_process.note(
                    link_process.RunningLink(os.getpid(), link.master, self.recording, link.door, alone)
                )


def _talkers(keeping: Keeping, announcer: Announcer | None) -> list[Talker]:
    talkers: list[Talker] = [announcer] if announcer else []
    if announcer and keeping.announce_to:
        talkers = [SeparateConnection(announcer, keeping.announce_to)]
    if keeping.request_rates:
        talkers += [RateRequest(dict.fromkeys(STREAMS, 50.0)), Inquiry()]
    return talkers


def main() -> None:
    """Keep the link that standard input describes, and write the recording's file name first."""
    interrupt.ignore()  # a signal is for the screens, which stop this process in order
    keeping: Keeping = pickle.load(sys.stdin.buffer)
    with contextlib.suppress(OSError):  # left by a process of this link that was killed
        if os.name != "nt":
            Path(keeping.door.address).unlink(missing_ok=True)
    try:
        keeper = Keeper(keeping)
        signal.signal(signal.SIGTERM, lambda number, frame: keeper.stop())
        answer: Path | Exception | None = keeper.start()
    except Exception as failure:
        answer = failure
    pickle.dump(answer, sys.stdout.buffer)
    sys.stdout.buffer.flush()
    sys.stdout.close()
    if isinstance(answer, Exception):
        keeping.door.clear()
        sys.exit(0 if isinstance(answer, UnusableInputError) else 1)
    try:
        keeper.run()
    finally:
        link_process.forget(os.getpid())
        keeping.door.clear()


if __name__ == "__main__":
    main()
