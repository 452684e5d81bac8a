"""A live link: a tlog being written.

A thread of its own takes frames off the connection, puts a time stamp before each as a
tlog has it, hands these records to the recorder, and decodes the very same bytes with the
scanner that reads logs. What was seen live and what the recording replays are therefore
the same messages in the same order.
"""

import contextlib
import struct
import threading
import time
from collections import deque
from collections.abc import Iterable
from pathlib import Path
from queue import Empty, Full, Queue
from types import TracebackType
from typing import Self

from pymavlink.dialects.v20 import ardupilotmega as dialect

from advisor.flight.messages import Columns
from advisor.mavlink.connection import parse_connection
from advisor.mavlink.frames import FrameScanner, Received
from advisor.mavlink.framing import Frame
from advisor.mavlink.health import LinkStatistics, Notice
from advisor.mavlink.intake import Intake
from advisor.mavlink.outgoing import OWN_COMPONENT, OWN_SYSTEM, Heartbeat, Packer, Talker
from advisor.mavlink.recorder import Recorder
from advisor.mavlink.signing import SignatureCheck, signing_time
from advisor.mavlink.transport import ConnectionCutError, Transport
from advisor.mavlink.transports import open_transport
from advisor.mavlink.watch import LinkWatch
from advisor.problems import UnusableInputError

BATCH_S = 0.012
"""Frames gather this long before they are decoded and handed over together."""
PAUSE_S = 0.003
"""Rest between two looks at a busy socket, so that several packets share one look."""
REOPEN_EVERY_S = 1.0
QUEUE_LENGTH = 12_000  # batches: more than a minute behind at full load

_HEARD, _SENT_BY_US = 0, 3  # link numbers, the low two bits of a tlog's time stamps
_CRC_EXTRA = {number: message.crc_extra for number, message in dialect.mavlink_map.items()}


class Link:
    """Listens to one vehicle on one connection; sends nothing unless it was given something to say.

    Parameters
    ----------
    connection
        Where to listen, see ``parse_connection``.
    source_system, source_component
        Own ids, on whatever is sent.
    target_system
        System id of the vehicle; None: the first autopilot heard.
    record_to
        File of the recording; None: no recording.
    key
        32-byte signing key: what is not signed with it is refused, what is sent is signed.
    talkers
        What may be sent. A connection that must speak first to be heard (``udpout``) adds
        a heartbeat once a second by itself.
    patience_s
        How long the first connection is tried; later a lost one is tried for ever.

    Raises
    ------
    ConfigurationError
        When the connection string names no connection.
    """

    def __init__(
        self,
        connection: str,
        *,
        source_system: int = OWN_SYSTEM,
        source_component: int = OWN_COMPONENT,
        target_system: int | None = None,
        record_to: Path | None = None,
        key: bytes | None = None,
        talkers: Iterable[Talker] = (),
        patience_s: float = 5.0,
    ) -> None:
        self.address = parse_connection(connection)
        self._record_to = record_to
        self._patience_s = patience_s
        self._talkers = [*talkers, *([Heartbeat()] if self.address.speaks_first else [])]
        self._packer = Packer(source_system, source_component, key)
        signatures = SignatureCheck(key, signing_time(time.time())) if key is not None else None
        self._intake = Intake(_CRC_EXTRA, target_system, signatures)
        self._scanner = FrameScanner()
        self._watch = LinkWatch(connection)
        self._notices: deque[Notice] = deque(maxlen=1000)
        self._queue: Queue[list[Columns]] = Queue(QUEUE_LENGTH)
        self._recorder: Recorder | None = None
        self._transport: Transport | None = None
        self._reopen_at_s = 0.0
        self._failure: BaseException | None = None
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="link", daemon=True)
        self._unix_offset_s = 0.0

    def start(self) -> Self:
        """Open the connection and the recording, and begin to listen.

        Raises
        ------
        UnusableInputError
            When the connection cannot be opened or the recording cannot be made.
        """
        self._warm_up()
        self._transport = self._open_first()
        if self._record_to is not None:
            self._recorder = Recorder(self._record_to)
        # Stamps run on the monotonic clock: a host whose clock is set does not tear the recording.
        self._unix_offset_s = time.time() - time.monotonic()
        self._watch.begin(time.monotonic())
        if self.address.speaks_first:
            text = f"{self.address.text} is told our address by a heartbeat once a second"
            self._say([text], time.monotonic())
        self._thread.start()
        return self

    def stop(self) -> None:
        """Close everything; the recording is whole afterwards."""
        self._stop.set()
        if self._thread.ident is not None:
            self._thread.join()
        if self._transport is not None:
            self._transport.close()
            self._transport = None
        if self._recorder is not None:
            self._recorder.close()

    def __enter__(self) -> Self:
        return self.start()

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.stop()

    @property
    def port(self) -> int | None:
        """The local network port, which the system chose where the address says 0."""
        return self._transport.port if self._transport is not None else None

    def read(self, timeout_s: float = 0.1) -> list[Columns]:
        """The next micro-batch of messages, or nothing when none came in time."""
        with contextlib.suppress(Empty):
            return self._queue.get(timeout=timeout_s)
        if self._failure is not None:
            raise self._failure
        return []

    def take_notices(self) -> list[Notice]:
        """What happened to the link since the last call, oldest first."""
        notices = []
        while self._notices:
            notices.append(self._notices.popleft())
        return notices

    @property
    def statistics(self) -> LinkStatistics:
        """How the link is doing now."""
        now_s = time.monotonic()
        counters = self._intake.counters
        senders = self._scanner.statistics.senders
        vehicle = senders.get(self._intake.vehicle, Received()) if self._intake.vehicle else Received()
        return LinkStatistics(
            connected=self._transport is not None,
            vehicle=self._intake.vehicle,
            messages=counters.messages,
            messages_per_s=counters.rate(now_s),
            vehicle_messages=vehicle.frames,
            lost=vehicle.lost,
            repeated=vehicle.repeated,
            repeated_after_s=vehicle.repeated_after_s,
            late=vehicle.late,
            bad_crc=self._intake.bad_crc,
            garbage_bytes=self._intake.garbage_bytes,
            refused=dict(counters.refused),
            silent_s=self._watch.silent_s(now_s),
            reconnects=self._watch.reconnects,
            recording=self._recorder.path if self._recorder else None,
            recorded_bytes=self._recorder.bytes_written if self._recorder else 0,
        )

    def _warm_up(self) -> None:
        """Decode a heartbeat of our own, so that no packet waits for the scanner to be compiled."""
        frames = [self._packer.pack(message, 0) for message in Heartbeat().speak(None, 0.0)]
        FrameScanner().feed(self._records(frames, time.time(), _SENT_BY_US))

    def _open_first(self) -> Transport:
        give_up_s = time.monotonic() + self._patience_s
        while True:
            try:
                return open_transport(self.address)
            except ImportError as error:
                raise UnusableInputError(
                    "no_connection",
                    f"{self.address.text} needs the Python package {error.name}.",
                    f"Install it with: pip install {error.name}",
                ) from None
            except OSError as error:
                if time.monotonic() >= give_up_s or self.address.kind.startswith(("udp", "tcpin")):
                    raise UnusableInputError(
                        "no_connection",
                        f"{self.address.text} cannot be opened: {error.strerror or error}.",
                        "Check the address, and that no other program uses it.",
                    ) from None
            self._stop.wait(0.2)

    # From here on: the reader thread.

    def _run(self) -> None:
        try:
            self._listen()
        except BaseException as error:
            self._failure = error

    def _listen(self) -> None:
        batch = bytearray()
        since_s = 0.0
        while not self._stop.is_set():
            frames = self._take_frames(wait_s=0.0 if batch else 0.05)
            now_s = time.monotonic()
            since_s = since_s if batch else now_s
            batch += self._records((frame.raw for frame in frames), now_s, _HEARD)
            batch += self._records(self._talk(frames, now_s), now_s, _SENT_BY_US)
            self._say(self._watch.look(self._intake, frames, now_s), now_s)
            if batch and now_s - since_s >= BATCH_S:
                self._hand_over(bytes(batch))
                batch.clear()
            if batch:
                self._stop.wait(PAUSE_S)
        if batch:
            self._hand_over(bytes(batch))

    def _take_frames(self, wait_s: float) -> list[Frame]:
        if self._transport is None:
            self._reopen()
            return []
        try:
            pieces = self._transport.receive() if self._transport.wait(wait_s) else []
        except ConnectionCutError as cut:
            if not cut.listening:
                self._transport.close()
                self._transport = None
            self._intake.forget_pieces()
            self._say([self._watch.cut(str(cut), time.monotonic())], time.monotonic())
            return []
        return self._intake.take(pieces, time.monotonic()) if pieces else []

    def _reopen(self) -> None:
        if time.monotonic() < self._reopen_at_s:
            self._stop.wait(0.05)
            return
        self._reopen_at_s = time.monotonic() + REOPEN_EVERY_S
        with contextlib.suppress(OSError):  # not yet back: tried again a second later
            self._transport = open_transport(self.address)

    def _talk(self, frames: list[Frame], now_s: float) -> list[bytes]:
        vehicle = self._intake.vehicle
        from_vehicle = [frame for frame in frames if vehicle and frame.system == vehicle[0]]
        for talker in self._talkers:
            for frame in from_vehicle:
                talker.hear(frame, now_s)
            self._say(talker.report(), now_s)
        sent = []
        for talker in self._talkers:
            for message in talker.speak(vehicle, now_s):
                raw = self._packer.pack(message, signing_time(now_s + self._unix_offset_s))
                if self._transport is not None and self._transport.send(raw, self._intake.vehicle_peer):
                    sent.append(raw)
        return sent

    def _records(self, frames: Iterable[bytes], now_s: float, link_number: int) -> bytes:
        stamp_us = int((now_s + self._unix_offset_s) * 1e6) & ~3 | link_number
        stamp = struct.pack(">Q", stamp_us)
        return b"".join(part for raw in frames for part in (stamp, raw))

    def _hand_over(self, records: bytes) -> None:
        if self._recorder is not None:
            self._recorder.write(records)
        columns = self._scanner.feed(records)
        while columns and not self._stop.is_set():
            with contextlib.suppress(Full):  # the consumer is a minute behind; the socket's buffer waits
                self._queue.put(columns, timeout=0.2)
                return

    def _say(self, texts: Iterable[str], now_s: float) -> None:
        self._notices.extend(Notice(now_s + self._unix_offset_s, text) for text in texts)
