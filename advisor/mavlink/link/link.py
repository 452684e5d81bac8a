"""A live link, processed like a tlog that is being written.

A separate thread takes frames from the connection and puts a time stamp before each, as in a tlog. The thread
gives these records to the recorder and to the link's reader. Readers decode the records with the scanner for
logs. Live messages and replayed messages are equal, in equal order.
"""

import contextlib
import math
import struct
import threading
import time
from collections import deque
from collections.abc import Iterable
from pathlib import Path
from queue import Empty, Full, Queue
from typing import TYPE_CHECKING, Self

from advisor.flight.signals.messages import Columns
from advisor.flight.vehicle.following import FOLLOW, TAKE
from advisor.flight.vehicle.pieces import DOWN
from advisor.mavlink.link.health import LinkStatistics
from advisor.mavlink.link.inquiry import Inquiry
from advisor.mavlink.link.intake import Intake
from advisor.mavlink.link.line import Line
from advisor.mavlink.link.link_watch import LinkWatch
from advisor.mavlink.link.outgoing import OWN_COMPONENT, OWN_SYSTEM, Conversation, Heartbeat, Ids, Talker
from advisor.mavlink.link.recorder import Recorder
from advisor.mavlink.link.transports import ConnectionCutError, parse_connection
from advisor.mavlink.wire.framing import CRC_EXTRA, Frame, SignatureCheck
from advisor.words.problems import printable

_ATTITUDE, _VFR_HUD = 30, 74


class MotionNow:
    """Newest bank and air speed of one system. No estimate delays these values."""

    def __init__(self) -> None:
        self.bank_rad = self.airspeed_m_s = math.nan
        """Newest bank, rad; NaN before the first message."""

    def look(self, frames: list[Frame], system: int) -> None:
        for frame in frames:
            if frame.system != system:
                continue
            # MAVLink 2 cuts zeros from the end of a payload.
            if frame.message_id == _ATTITUDE:
                self.bank_rad = struct.unpack_from("<f", frame.payload.ljust(8, b"\0"), 4)[0]
            elif frame.message_id == _VFR_HUD:
                self.airspeed_m_s = struct.unpack_from("<f", frame.payload.ljust(4, b"\0"))[0]


if TYPE_CHECKING:
    from advisor.mavlink.link.decoding import Decoding

BATCH_S = 0.012
"""Time for which frames are collected before they are passed on, s."""
PAUSE_S = 0.003
"""Pause between two checks of a busy socket, s, so that one check takes several packets."""
UNREACHABLE_S = 3.0
"""Silence of the vehicle after which nothing is sent to it, s: three heartbeats."""
FAREWELL_S = 0.7
"""Longest time at the end of a link for restoring the vehicle's settings, s."""
STOOD_STILL_S = 1.0
"""Time between two checks of the connection, s, above which packets may be lost."""
QUEUE_LENGTH = 12_000  # batches: more than a minute behind at full load

_HEARD, _SENT_BY_US = 0, 3  # link numbers, the low two bits of a tlog's time stamps


class Link:
    """Link to one vehicle on one connection. A link without talkers sends nothing.

    Parameters
    ----------
    target_system
        System id of the vehicle; None for the first autopilot that sends.
    goes_on
        Whether the file exists and is continued.
    key
        Signing key of 32 bytes, with which messages are signed and without which they are refused.
    talkers
        Sources of the sent messages. A connection that must send before it receives (``udpout``) adds a
        heartbeat once a second.
    inherited
        File descriptor of another process's UDP socket for the connection. None to open a new socket.
    patience_s
        Time for attempts at the first connection, s. An interrupted connection is tried without limit.

    Raises
    ------
    ConfigurationError
        The connection string names no connection.
    """

    def __init__(
        self,
        connection: str,
        *,
        target_system: int | None = None,
        record_to: Path | None = None,
        goes_on: bool = False,
        key: bytes | None = None,
        talkers: Iterable[Talker] = (),
        inherited: int | None = None,
        patience_s: float = 5.0,
    ) -> None:
        self.address = parse_connection(connection)
        self._record_to, self._goes_on = record_to, goes_on
        self._patience_s = patience_s
        greeting = [Heartbeat()] if self.address.speaks_first else []
        self._conversation = Conversation([*talkers, *greeting], (OWN_SYSTEM, OWN_COMPONENT), key)
        signatures = SignatureCheck(key) if key is not None else None
        self._intake = Intake(CRC_EXTRA, target_system, signatures)
        self._target_system = target_system
        self._decoding: Decoding | None = None
        self._orders: deque[bytes | Talker | Ids] = deque()
        self._watch = LinkWatch(connection)
        self._notices: deque[str] = deque(maxlen=1000)
        self._motion = MotionNow()
        self._queue: Queue[tuple[float, bytes]] = Queue(QUEUE_LENGTH)
        """Batches of records, each with the host time at which it was passed on, s."""
        self.first_s = self.newest_s = self.read_to_s = math.nan
        """Host times of the newest batch and of the newest batch that was read, seconds since 1970."""
        self._recorder: Recorder | None = None
        self._failure: BaseException | None = None
        self._stop = threading.Event()
        self._line = Line(self.address, inherited, self._stop)
        self._thread = threading.Thread(target=self._run, name="link", daemon=True)
        self._unix_offset_s = 0.0
        self.looked_s = time.monotonic()
        """Monotonic time of the link thread's last check of its connection, s."""

    def start(self) -> Self:
        """Open the connection and the recording, and begin to listen.

        Raises
        ------
        UnusableInputError
            The connection cannot be opened, or the recording cannot be made.
        """
        self._line.open(self._patience_s)
        if self._record_to is not None:
            self._recorder = Recorder(self._record_to, self._goes_on)
        # Stamps run on the monotonic clock, so that setting the host's clock does not tear the recording.
        self._unix_offset_s = time.time() - time.monotonic()
        self.looked_s = time.monotonic()
        self._watch.begin(self.looked_s)
        if self._goes_on:
            self._orders.append(DOWN)
        if self.address.speaks_first:
            text = f"{self.address.text} learns the advisor's address from a heartbeat once a second"
            self._say([text])
        self._thread.start()
        return self

    def stop(self) -> None:
        """Close everything. The recording is then complete."""
        self._stop.set()
        if self._thread.ident is not None:
            self._thread.join()
        self._line.close()
        if self._recorder is not None:
            self._recorder.close()

    def __enter__(self) -> Self:
        return self.start()

    def __exit__(self, *error: object) -> None:
        self.stop()

    @property
    def port(self) -> int | None:
        """Local network port, chosen by the system if the address has port 0."""
        return self._line.port

    @property
    def descriptor(self) -> int | None:
        """File descriptor of a socket that another process can continue to use. None without such a
        socket."""
        return self._line.descriptor

    catching_up = False
    """Always False: a link in this process has no earlier records for a reader."""

    def read(self, timeout_s: float = 0.1) -> list[Columns]:
        """Return the messages of the next micro-batch, or an empty list after the timeout."""
        records = self.read_records(timeout_s)
        if not records:
            return []
        if self._decoding is None:
            # A process that only records needs no decoder, whose kernels take long to load.
            from advisor.mavlink.link.decoding import Decoding

            self._decoding = Decoding(None, self._target_system)
        columns = self._decoding.feed(records)
        if (vehicle := self._decoding.newly_followed()) is not None:
            self.listen_to(vehicle)
        return columns

    def read_records(self, timeout_s: float = 0.1) -> bytes:
        """Return the next micro-batch as records of a tlog, or nothing after the timeout."""
        with contextlib.suppress(Empty):
            self.read_to_s, records = self._queue.get(timeout=timeout_s)
            return records
        if self._failure is not None:
            raise self._failure
        return b""

    @property
    def recorder(self) -> Recorder | None:
        """Recorder of the link. None before the start, and without a recording."""
        return self._recorder

    def listen_to(self, vehicle: Ids) -> None:
        """Count, watch and answer the messages of this vehicle. The stream's decoder determines which vehicle
        to follow."""
        self._orders.append(vehicle)

    def follow(self, system: int) -> None:
        """Follow another vehicle. The stream records the choice; nothing is sent to a vehicle."""
        self._orders.append(FOLLOW + str(system).encode())

    def take_output(self, output: int) -> None:
        """Use an output as the elevator. The stream records the choice; nothing is sent to a vehicle."""
        self._orders.append(TAKE + str(output).encode())

    def ask_for_outputs(self) -> None:
        """Request once from the vehicle which output is its elevator."""
        self._orders.append(Inquiry(outputs_only=True))

    def take_notices(self) -> list[str]:
        """Return the notices since the last call, oldest first."""
        notices = []
        while self._notices:
            notices.append(self._notices.popleft())
        return notices

    @property
    def statistics(self) -> LinkStatistics:
        now_s = time.monotonic()
        counters = self._intake.counters
        statistics = LinkStatistics(
            connected=self._line.is_open,
            vehicle=self._intake.vehicle,
            messages=counters.messages,
            messages_per_s=counters.rate(now_s),
            bad_crc=self._intake.bad_crc,
            refused=dict(counters.refused),
            silent_s=self._watch.silent_s(now_s),
            reconnects=self._watch.reconnects,
            first_s=self.first_s,
            newest_s=self.newest_s,
            bank_rad=self._motion.bank_rad,
            airspeed_m_s=self._motion.airspeed_m_s,
            recording=self._recorder.path if self._recorder else None,
            recorded_bytes=self._recorder.bytes_written if self._recorder else 0,
            recording_problem=self._recorder.problem if self._recorder else None,
        )
        return self._decoding.counted(statistics) if self._decoding is not None else statistics

    # The methods below run in the reader thread.

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
            before_s, now_s = self.looked_s, time.monotonic()
            if now_s - before_s > STOOD_STILL_S:
                self._orders.append(DOWN)
            self.looked_s = now_s
            since_s = since_s if batch else now_s
            batch += self._records((frame.raw for frame in frames), now_s, _HEARD)
            batch += self._records(self._obey(), now_s, _SENT_BY_US)
            batch += self._records(self._talk(frames, now_s), now_s, _SENT_BY_US)
            self._say(self._watch.look(self._intake, frames, now_s))
            self._say(self._recorder.take_notices() if self._recorder else ())
            if self._intake.vehicle is not None:
                self._motion.look(frames, self._intake.vehicle[0])
            if batch and now_s - since_s >= BATCH_S:
                self._hand_over(bytes(batch))
                batch.clear()
            if batch:
                self._stop.wait(PAUSE_S)
        batch += self._take_leave()
        if batch:
            self._hand_over(bytes(batch))

    def _take_leave(self) -> bytes:
        """Let the talkers finish while the vehicle answers, for at most ``FAREWELL_S``."""
        records = bytearray()
        give_up_s = time.monotonic() + FAREWELL_S
        while (now_s := time.monotonic()) < give_up_s and self._reachable(now_s):
            unix_s = now_s + self._unix_offset_s
            sent = self._conversation.leave(self._intake.vehicle, now_s, unix_s, self._send)
            if sent is None:
                break
            frames = self._take_frames(wait_s=0.02)
            self._say(self._conversation.hear(frames, self._intake.vehicle, now_s))
            records += self._records((frame.raw for frame in frames), now_s, _HEARD)
            records += self._records(sent, now_s, _SENT_BY_US)
        return bytes(records)

    def _take_frames(self, wait_s: float) -> list[Frame]:
        try:
            pieces = self._line.take(wait_s)
        except ConnectionCutError as cut:
            self._intake.forget_pieces()
            self._say([self._watch.cut(str(cut), time.monotonic())])
            return []
        return self._intake.take(pieces, time.monotonic()) if pieces else []

    def _obey(self) -> list[bytes]:
        """Execute the orders since the last check, and return texts for the stream alone."""
        texts = []
        while self._orders:
            match self._orders.popleft():
                case Talker() as talker:
                    self._conversation.join(talker)
                case bytes() as text:
                    texts.append(self._conversation.note(text, time.time()))
                case vehicle if vehicle != self._intake.vehicle:
                    self._intake.follow(vehicle)
                    self._motion = MotionNow()
                    self._watch.start_again()
        return texts

    def _talk(self, frames: list[Frame], now_s: float) -> list[bytes]:
        self._say(self._conversation.hear(frames, self._intake.vehicle, now_s))
        unix_s, reachable = now_s + self._unix_offset_s, self._reachable(now_s)
        return self._conversation.speak(self._intake.vehicle, reachable, now_s, unix_s, self._send)

    def _reachable(self, now_s: float) -> bool:
        """Return whether the vehicle is known and receives messages."""
        down = not self._line.is_open or self._watch.silent_s(now_s) > UNREACHABLE_S
        return not down and self._intake.vehicle is not None

    def _send(self, raw: bytes) -> bool:
        return self._line.send(raw, self._intake.vehicle_peer)

    def _records(self, frames: Iterable[bytes], now_s: float, link_number: int) -> bytes:
        stamp_us = int((now_s + self._unix_offset_s) * 1e6) & ~3 | link_number
        stamp = struct.pack(">Q", stamp_us)
        return b"".join(part for raw in frames for part in (stamp, raw))

    def _hand_over(self, records: bytes) -> None:
        if self._recorder is not None:
            self._recorder.write(records)
        self.newest_s = time.monotonic() + self._unix_offset_s
        if math.isnan(self.first_s):
            self.first_s = self.newest_s
        while not self._stop.is_set():
            with contextlib.suppress(Full):  # the reader is a minute behind; the socket's buffer waits
                self._queue.put((self.newest_s, records), timeout=0.2)
                return

    def _say(self, texts: Iterable[str]) -> None:
        self._notices.extend(map(printable, texts))
