"""Announcements on the crew's own ground station: verdicts as STATUSTEXT."""

from collections import deque
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as dialect

from advisor.mavlink.link.outgoing import Ids, Packer, Talker
from advisor.mavlink.link.transports import ConnectionCutError, Transport, open_transport, parse_connection
from advisor.words.problems import plain

CHUNK_BYTES = 50
MOST_CHUNKS = 4
SPOKEN = "@"
"""First character of a text that MAVProxy's speech module speaks, from any of its vehicle's components."""


def status_text(text: str, number: int) -> list[Any]:
    """Return one sentence as STATUSTEXT messages.

    MAVLink, STATUSTEXT: a text longer than 50 bytes is sent in chunks that share an id
    other than 0. The first chunk that is not full ends the text. Texts are cut to ``MOST_CHUNKS``
    chunks and written in ASCII, which every ground station shows.

    Parameters
    ----------
    number
        Running number of the announcement, from which the id of a chunked text follows.
    """
    data = plain(" ".join(text.split())).encode("ascii")
    if len(data) >= CHUNK_BYTES * MOST_CHUNKS:
        data = data[: CHUNK_BYTES * MOST_CHUNKS - 4] + b"..."
    chunks = [data[i : i + CHUNK_BYTES] for i in range(0, len(data), CHUNK_BYTES)] or [b""]
    if len(chunks) > 1 and len(chunks[-1]) == CHUNK_BYTES:
        chunks.append(b"")
    chunk_id = 0 if len(chunks) == 1 else number % 0xFFFF + 1
    return [
        dialect.MAVLink_statustext_message(dialect.MAV_SEVERITY_NOTICE, chunk, chunk_id, sequence)
        for sequence, chunk in enumerate(chunks)
    ]


class Announcer(Talker):
    """Sender of one text for each manoeuvre.

    ``judged`` may be called from any thread. The link asks for the messages in its own thread.
    """

    def __init__(self) -> None:
        self._announced: set[tuple[str, int]] = set()
        self._waiting: deque[str] = deque()
        self._number = 0
        self._stops_told: set[str] = set()

    def judged(self, maneuver: int, sentence: str, stop: str = "", axis: str = "", about: str = "") -> None:
        """Queue the verdict on a manoeuvre for an announcement.

        Parameters
        ----------
        maneuver
            Number of the manoeuvre. A second verdict on a manoeuvre is not sent.
        stop
            Sentence about axes with a complete test; empty without one.
        axis
            Words before the number, if each axis numbers its own manoeuvres; empty for the elevator.
        about
            Axis or plan of ``stop``, which is sent only once.
        """
        if (axis, maneuver) in self._announced:
            return
        self._announced.add((axis, maneuver))
        sentence = f"{axis} {maneuver} {sentence}".lstrip()
        if stop and about not in self._stops_told:
            self._stops_told.add(about)
            sentence = f"{stop} ({sentence})"
        self.say(sentence)

    def say(self, sentence: str) -> None:
        """Queue a sentence that is no verdict for an announcement."""
        self._waiting.append(SPOKEN + sentence)

    def source(self, own: Ids, vehicle: Ids) -> Ids:
        """Return the ids of an onboard computer, because ground stations show only texts from their vehicle's
        system."""
        return vehicle[0], dialect.MAV_COMP_ID_ONBOARD_COMPUTER

    def speak(self, vehicle: tuple[int, int] | None, now_s: float) -> list[Any]:
        """Return the next waiting text, if a vehicle is known."""
        if vehicle is None or not self._waiting:
            return []
        self._number += 1
        return status_text(self._waiting.popleft(), self._number)


REOPEN_EVERY_S = 1.0


class SeparateConnection(Talker):
    """Separate connection to a ground station for the messages of a talker.

    MAVProxy forwards messages from its ``--out`` to the vehicle, and does not show these messages. MAVProxy
    shows a message from its ``--master`` when the text carries the system and component of its vehicle
    (MAVProxy, ``mavproxy_link.py``, ``message_is_from_primary_vehicle``).

    Raises
    ------
    ConfigurationError
        The connection string names no connection.
    """

    def __init__(self, talker: Talker, connection: str) -> None:
        self._talker = talker
        self._address = parse_connection(connection)
        self._packer = Packer(None)
        self._transport: Transport | None = None
        self._reopen_at_s = float("-inf")
        self._said: list[str] = []
        self._failed = False

    def speak(self, vehicle: Ids | None, now_s: float) -> list[Any]:
        """Send the due messages on the other connection; return nothing for the link."""
        if vehicle is not None and self._is_open(now_s):
            for message in self._talker.speak(vehicle, now_s):
                self._send(self._packer.pack(message, vehicle, 0))
        return []

    def leave(self, now_s: float) -> None:
        if self._transport is not None:
            self._transport.close()
            self._transport = None

    def report(self) -> list[str]:
        """Return one sentence if the connection could not be opened."""
        said, self._said = self._said, []
        return said

    def _is_open(self, now_s: float) -> bool:
        if self._transport is None and now_s >= self._reopen_at_s:
            self._reopen_at_s = now_s + REOPEN_EVERY_S
            try:
                self._transport = open_transport(self._address)
            except OSError as error:
                if not self._failed:
                    why = error.strerror or error
                    self._said.append(f"{self._address.text} cannot be opened for announcements: {why}")
                self._failed = True
        return self._transport is not None

    def _send(self, raw: bytes) -> None:
        if self._transport is None:
            return
        try:
            self._transport.receive()  # what a ground station says to the vehicle is not for us
            self._transport.send(raw, None)
        except ConnectionCutError:
            self.leave(0.0)
