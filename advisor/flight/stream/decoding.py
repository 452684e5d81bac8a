"""Quantities in the messages of one vehicle, their sources that the aircraft file names, and all data of one
power-on."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.events import READER_NOTICE, Notice
from advisor.flight.signals.channels import Decoded, given_airspeed, named_value, of_companion, quantities
from advisor.flight.signals.messages import Columns
from advisor.flight.signals.power_on import PowerOn
from advisor.flight.signals.record import ALL_UNITS
from advisor.flight.signals.tracks import Tracks
from advisor.flight.stream.identity import Identity
from advisor.flight.vehicle.pieces import Master
from advisor.process.arrays import FloatArray

_NAMED = "named_value:"
"""Beginning of a vane's ``source`` if a NAMED_VALUE_FLOAT carries its angle."""


def decoded(columns: Columns, t: FloatArray, aircraft: Aircraft, companion: bool) -> Iterator[Decoded]:
    """Yield the quantities in messages of one type.

    Parameters
    ----------
    t
        Shape (n,): vehicle time of each message, s since boot.
    companion
        Whether another component than the autopilot sent the messages.
    """
    measured = quantities(columns, t)
    yield from map(of_companion, measured) if companion else measured
    if columns.name == "ATTITUDE" and aircraft.airspeed_m_s is not None:
        yield given_airspeed(columns, t, aircraft.airspeed_m_s)
    if columns.name == "NAMED_VALUE_FLOAT":
        for channel, source in (("alpha", aircraft.alpha.source), ("beta", aircraft.beta.source)):
            if source.startswith(_NAMED):
                yield named_value(columns, t, channel, source.removeprefix(_NAMED))


def power_on(
    boot: int,
    tracks: Tracks,
    who: Identity,
    is_backwards: bool,
    clock: Sequence[Master],
    modes: Sequence[tuple[float, str]],
) -> PowerOn:
    """Return all data received since the start of the vehicle's clock.

    Parameters
    ----------
    is_backwards
        Whether the elevator was found to move opposite to its nominal sign.
    modes
        Vehicle time of each flight mode change, s, and the mode's name.
    """
    cuts = {name: tracks.cut(name, -np.inf, np.inf) for name in ALL_UNITS}
    channels = {name: who.identified(c) for name, c in cuts.items() if c is not None}
    if is_backwards and "elevator" in channels:
        channels["elevator"] = replace(channels["elevator"], y=-channels["elevator"].y)
    heard = [(master.order, master.t) for master in clock if len(master.t)]
    order, t = map(np.concatenate, zip(*heard, strict=True)) if heard else (np.empty(0, int), np.empty(0))
    return PowerOn(boot, channels, order, t, tuple(modes))


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
