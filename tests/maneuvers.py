"""Manoeuvres with another channel, or without one."""

from dataclasses import replace
from typing import Any

from advisor.flight.maneuvers.maneuver import Maneuver


def changed(maneuver: Maneuver, name: str, **fields: Any) -> Maneuver:
    """Return the manoeuvre with other fields of one channel."""
    return replace(maneuver, channels={**maneuver.channels, name: replace(maneuver.channels[name], **fields)})


def without(maneuver: Maneuver, *names: str) -> Maneuver:
    """Return the manoeuvre without some channels."""
    return replace(maneuver, channels={n: c for n, c in maneuver.channels.items() if n not in names})
