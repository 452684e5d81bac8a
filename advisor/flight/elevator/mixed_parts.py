"""Servo outputs that drive a control together, each with its share by the mixer's row."""

from collections import Counter
from collections.abc import Mapping

from advisor.flight.vehicle.mixers import Control, Role, sides_of
from advisor.flight.vehicle.surfaces import Part
from advisor.flight.vehicle.wiring import Wiring


def parts_of(control: Control, wiring: Wiring) -> tuple[Part, ...]:
    """Return the outputs of a control in rising order; empty if no set of outputs drives the whole control.

    A control consists of all plain outputs and of each mixed pair with all its members. The control's
    deflection is the mean of its parts. Several outputs of one member are averaged.
    """
    groups: dict[str, dict[int, Role]] = {}
    for n, role in wiring.roles.items():
        if role.weight(control):
            groups.setdefault(role.surface, {})[n] = role
    whole = [mine for surface, mine in groups.items() if _is_whole(surface, mine, control)]
    parts = []
    for mine in whole:
        members = Counter(role.side for role in mine.values())
        for n, role in mine.items():
            share = role.weight(control) / (len(whole) * members[role.side])
            side = f"{role.surface} {role.side}".strip()
            parts.append(Part(n, wiring.scale(n), share, n in wiring.known_directions, side))
    return tuple(sorted(parts, key=lambda part: part.output))


def _is_whole(surface: str, mine: Mapping[int, Role], control: Control) -> bool:
    """Return whether every member of a mixed pair is among the outputs."""
    return sides_of(surface, control) <= {role.side for role in mine.values()}
