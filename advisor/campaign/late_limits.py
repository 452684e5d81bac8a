"""Elevator limits that arrive after manoeuvres, which are then judged again or reported as omitted."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from advisor.flight.maneuvers.events import READER_NOTICE, ElevatorRescaled, Notice
from advisor.flight.maneuvers.maneuver import Maneuver


@dataclass(frozen=True, slots=True)
class Recount:
    """Effect of a late elevator limit on the earlier manoeuvres."""

    anew: tuple[Maneuver, ...]
    """Manoeuvres whose pulses are scaled by the late limit."""
    lost: tuple[int, ...]
    """Numbers of manoeuvres whose pulses cannot be derived from their deflections."""
    heard: str

    @property
    def notice(self) -> Notice | None:
        """Sentence for the user; None if the late limit changes no manoeuvre."""
        said = []
        if self.anew:
            said.append(f"manoeuvres {_listed([m.number for m in self.anew])} are counted anew with it")
        if self.lost:
            said.append(f"manoeuvres {_listed(self.lost)} had an assumed value and are excluded")
        return Notice(READER_NOTICE, f"{self.heard}: {'; '.join(said)}.") if said else None


def recount(maneuvers: Sequence[Maneuver], event: ElevatorRescaled) -> Recount:
    """Return the effect of a late elevator limit on the manoeuvres of its log or link.

    A manoeuvre without the former scale keeps its own scale, because its vehicle had other settings.
    """
    before, after = event.before.scale, event.after.scale
    anew, lost = [], []
    for maneuver in (m for m in maneuvers if m.flight == event.flight):
        if maneuver.scale is None or before is None or after is None:
            lost.append(maneuver.number)
        elif replace(maneuver.scale, reversed=before.reversed) == before:
            anew.append(maneuver.rescaled(after))
    return Recount(tuple(anew), tuple(lost), event.heard)


def _listed(numbers: Sequence[int]) -> str:
    return ", ".join(map(str, numbers))
