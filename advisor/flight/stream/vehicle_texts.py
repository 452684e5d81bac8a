"""Texts of vehicles (STATUSTEXT), joined if a text came in several messages."""

from collections.abc import Iterator
from dataclasses import dataclass

from advisor.flight.maneuvers.events import VehicleSaid
from advisor.flight.signals.messages import Columns
from advisor.flight.stream.identity import READER
from advisor.flight.vehicle.breaks import DOWN
from advisor.flight.vehicle.following import FOLLOW, TAKE
from advisor.words.printable import printable

SEVERITIES = ("emergency", "alert", "critical", "error", "warning", "notice", "info", "debug")
"""Names of MAV_SEVERITY 0 to 7 (MAVLink common.xml)."""

_LONGEST = 250
"""Largest number of characters of a text: five chunks, and the longest message of an ArduPilot log."""
_CHUNK = 50
"""Length of STATUSTEXT.text in bytes; a shorter chunk ends its text (MAVLink common.xml)."""
_OWN = (READER, FOLLOW, TAKE, DOWN)
"""Beginnings of the texts that the advisor writes into its own stream."""


@dataclass(slots=True)
class _Open:
    """A text that may continue in further chunks."""

    id: int
    severity: int
    sequence: int
    text: bytes


class VehicleTexts:
    """Texts joined from their chunks, sender by sender."""

    def __init__(self) -> None:
        self._open: dict[tuple[int, int], _Open] = {}

    def heard(self, columns: Columns, at_s: float) -> Iterator[VehicleSaid]:
        """Yield the texts that these messages complete.

        Parameters
        ----------
        columns
            STATUSTEXT of one sender, in order of arrival.
        at_s
            Vehicle time of the newest sample, s since boot; NaN before the first.
        """
        sender = (columns.system, columns.component)
        ids, sequences = columns.fields.get("id"), columns.fields.get("chunk_seq")
        for i, raw in enumerate(columns.fields["text"].tolist()):
            text, severity = bytes(raw).partition(b"\0")[0], int(columns.fields["severity"][i])
            number = 0 if ids is None else int(ids[i])
            sequence = 0 if sequences is None else int(sequences[i])
            open_ = self._open.pop(sender, None)
            if open_ is not None and (number, sequence) != (open_.id, open_.sequence + 1):
                yield from _said(sender, open_.severity, open_.text, at_s)
                open_ = None
            whole = (open_.text if open_ is not None else b"") + text
            if number and len(text) >= _CHUNK:
                self._open[sender] = _Open(number, severity, sequence, whole[: 2 * _LONGEST])
            else:
                yield from _said(sender, severity, whole, at_s)

    def finish(self, at_s: float) -> Iterator[VehicleSaid]:
        """Yield the texts whose last chunk did not arrive."""
        for sender, open_ in self._open.items():
            yield from _said(sender, open_.severity, open_.text, at_s)
        self._open.clear()


def _said(sender: tuple[int, int], severity: int, raw: bytes, at_s: float) -> Iterator[VehicleSaid]:
    text = printable(raw.decode("utf-8", "replace")).strip()
    if not text or raw.startswith(_OWN):
        return
    if len(text) > _LONGEST:
        text = f"{text[: _LONGEST - 1]}…"
    name = SEVERITIES[severity] if severity < len(SEVERITIES) else ""
    yield VehicleSaid(text, name, *sender, at_s)
