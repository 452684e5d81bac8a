"""Announcements on the crew's own ground station: verdicts as STATUSTEXT."""

from collections import deque
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as dialect

from advisor.mavlink.link.outgoing import Ids, Talker
from advisor.words.ascii_output import plain

CHUNK_BYTES = 50
MOST_CHUNKS = 4
SPOKEN = "@"
"""First character of a text that MAVProxy's speech module speaks, from any component of its vehicle's
system."""


def status_text(text: str, number: int) -> list[Any]:
    """Return one sentence as STATUSTEXT messages.

    MAVLink, STATUSTEXT: a text longer than 50 bytes is sent in chunks that share an id
    other than 0. The first chunk that is not full ends the text. Texts are cut to ``MOST_CHUNKS``
    chunks and written in ASCII, which every ground station shows.

    Parameters
    ----------
    text
        Text of the announcement.
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
    """Sends one text for each manoeuvre, and never a second one.

    ``judged`` may be called from any thread. The link asks for the messages in its own thread.
    """

    def __init__(self) -> None:
        self._announced: set[tuple[str, int]] = set()
        self._waiting: deque[str] = deque()
        self._number = 0
        self._stops_told: set[str] = set()

    def judged(self, maneuver: int, sentence: str, stop: str | None = None, axis: str = "") -> None:
        """Take the verdict on a manoeuvre.

        Parameters
        ----------
        maneuver
            Number of the manoeuvre. A later verdict on it is not sent.
        sentence
            Sentence of the verdict.
        stop
            Sentence of the flight-test verdict when it says stop. It is sent the first time only.
        axis
            Words before the number, where each axis counts its own manoeuvres; empty for the elevator's.
        """
        if (axis, maneuver) in self._announced:
            return
        self._announced.add((axis, maneuver))
        sentence = f"{axis} {maneuver} {sentence}".lstrip()
        if stop is not None and axis not in self._stops_told:
            self._stops_told.add(axis)
            sentence = f"{stop} ({sentence})"
        self.say(sentence)

    def say(self, sentence: str) -> None:
        """Take a sentence that is no verdict."""
        self._waiting.append(SPOKEN + sentence)

    def source(self, own: Ids, vehicle: Ids) -> Ids:
        """Return the id of a computer on board, because ground stations show texts of their vehicle's system
        only."""
        return vehicle[0], dialect.MAV_COMP_ID_ONBOARD_COMPUTER

    def speak(self, vehicle: tuple[int, int] | None, now_s: float) -> list[Any]:
        """Return the next text that waits, once a vehicle is known."""
        if vehicle is None or not self._waiting:
            return []
        self._number += 1
        return status_text(self._waiting.popleft(), self._number)
