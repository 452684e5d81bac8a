"""Texts of vehicles (STATUSTEXT), joined if a text came in several messages."""

from collections.abc import Iterator

import numpy as np

from advisor.flight.maneuvers.events import VehicleSaid
from advisor.flight.signals.messages import Columns
from advisor.flight.signals.whole_texts import LONGEST, WholeTexts
from advisor.flight.stream.identity import READER
from advisor.flight.vehicle.breaks import DOWN
from advisor.flight.vehicle.following import FOLLOW, TAKE
from advisor.words.printable import printable

SEVERITIES = ("emergency", "alert", "critical", "error", "warning", "notice", "info", "debug")
"""Names of MAV_SEVERITY 0 to 7 (MAVLink common.xml)."""

_OWN = (READER, FOLLOW, TAKE, DOWN)
"""Beginnings of the texts that the advisor writes into its own stream."""


class VehicleTexts:
    """Whole texts of every sender, as events."""

    def __init__(self) -> None:
        self._texts = WholeTexts()

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
        for whole in self._texts.heard(columns, np.full(len(columns.order), at_s)):
            yield from _said(sender, whole.severity, whole.text, at_s)

    def finish(self, at_s: float) -> Iterator[VehicleSaid]:
        """Yield the texts whose last chunk did not arrive."""
        for sender, whole in self._texts.finish():
            yield from _said(sender, whole.severity, whole.text, at_s)


def _said(sender: tuple[int, int], severity: int, raw: bytes, at_s: float) -> Iterator[VehicleSaid]:
    text = printable(raw.decode("utf-8", "replace")).strip()
    if not text or raw.startswith(_OWN):
        return
    if len(text) > LONGEST:
        text = f"{text[: LONGEST - 1]}…"
    name = SEVERITIES[severity] if severity < len(SEVERITIES) else ""
    yield VehicleSaid(text, name, *sender, at_s)
