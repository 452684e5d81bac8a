"""Sources of α and β that the aircraft file names, until their first value arrives."""

from collections.abc import Iterator

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.events import READER_NOTICE, Notice
from advisor.flight.signals.channels import Decoded
from advisor.flight.signals.messages import Columns

_NAMED = "named_value:"
_ANY = ("auto", "none", "derived")
"""Sources that require no message."""


class AskedSources:
    """Reports which named sources of the aircraft file have sent no value."""

    def __init__(self, aircraft: Aircraft) -> None:
        stated = {"alpha": aircraft.alpha.source, "beta": aircraft.beta.source}
        self._missing = {name: source for name, source in stated.items() if source not in _ANY}
        self._names: set[str] = set()

    def hear(self, columns: Columns) -> None:
        """Keep the names of NAMED_VALUE_FLOAT messages, for the sentence on a missing one."""
        if self._missing and columns.name == "NAMED_VALUE_FLOAT":
            raw = set(columns.fields["name"].tolist())
            self._names |= {name.rstrip(b"\0").decode("ascii", "replace") for name in raw}

    def take(self, new: Decoded) -> None:
        """Take samples of a channel from a possible source."""
        if new.channel in self._missing and len(new.t):
            del self._missing[new.channel]

    def finish(self) -> Iterator[Notice]:
        """Yield a notice on each source without a value, once."""
        for name, source in self._missing.items():
            others = ", ".join(sorted(self._names))
            there = f"the named values are {others}" if others else "no named value arrived"
            why = f"; {there}" if source.startswith(_NAMED) else ""
            yield Notice(READER_NOTICE, f"{name}.source asks for {source}, which is not in this record{why}.")
        self._missing = {}
