"""Markers of manoeuvres in flight: a switch of the transmitter, or texts of the vehicle."""

from collections.abc import Iterator

import numpy as np

from advisor.aircraft.aircraft import Markers
from advisor.flight.maneuvers.marks import Marker, Switched
from advisor.flight.signals.messages import Columns, FloatArray

HEARD = ("RC_CHANNELS", "STATUSTEXT")
"""Messages that may hold a mark."""
SYSTEM_ID_BEGINS, SYSTEM_ID_ENDS = b"SystemID Starting", b"SystemID stopped"
"""Texts that ArduPlane sends when its system identification begins and ends (``AP_SystemID`` of
ArduPlane)."""
_NO_PULSE_US = (0, 65535)
"""Values of a channel that the receiver does not have (RC_CHANNELS, MAVLink common.xml)."""


class MarkerWatch:
    """Finds the beginnings and ends of marks by a switch or by texts, message by message."""

    def __init__(self, markers: Markers) -> None:
        self._markers = markers
        self._texts: list[tuple[Marker, bytes, bytes]] = [("system id", SYSTEM_ID_BEGINS, SYSTEM_ID_ENDS)]
        if markers.text is not None:
            begins, ends = markers.text
            self._texts.append(("text", begins.encode(), ends.encode()))
        self._is_on = False

    def start_boot(self) -> None:
        """Begin another power-on. The switch counts as off until it is heard."""
        self._is_on = False

    def heard(self, columns: Columns, t: FloatArray) -> Iterator[Switched]:
        """Yield the beginnings and ends of marks in messages of one type.

        Parameters
        ----------
        columns
            Messages of a type in ``HEARD``, in order of arrival.
        t
            Shape (n,), vehicle time of each message, s since boot. NaN where unknown.
        """
        if columns.name == "STATUSTEXT":
            yield from self._texts_heard(columns, t)
        elif self._markers.rc is not None:
            yield from self._switch_heard(columns, t, f"chan{self._markers.rc}_raw")

    def _switch_heard(self, columns: Columns, t: FloatArray, field: str) -> Iterator[Switched]:
        pulses = columns.fields[field]
        known = np.isfinite(t) & ~np.isin(pulses, _NO_PULSE_US)
        for i in np.flatnonzero(known):
            on = bool(pulses[i] > self._markers.above_us)
            if on != self._is_on:
                self._is_on = on
                yield Switched(int(columns.order[i]), float(t[i]), "switch", on)

    def _texts_heard(self, columns: Columns, t: FloatArray) -> Iterator[Switched]:
        for i, raw in enumerate(columns.fields["text"].tolist()):
            if not np.isfinite(t[i]):
                continue
            for by, begins, ends in self._texts:
                # The end comes first, because the text that begins a mark may have the other text as its
                # beginning.
                said = [on for on, text in ((False, ends), (True, begins)) if raw.startswith(text)]
                if said:
                    yield Switched(int(columns.order[i]), float(t[i]), by, said[0])
