"""Limits of the elevator that arrive after manoeuvres, which are judged anew or named as left out."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from advisor.flight.maneuvers.events import READER_NOTICE, ElevatorRescaled, Notice
from advisor.flight.maneuvers.maneuver import Maneuver


@dataclass(frozen=True, slots=True)
class Recount:
    """Effect of a limit that is heard late on the manoeuvres before."""

    anew: tuple[Maneuver, ...]
    """Manoeuvres whose pulses are counted by the limit heard."""
    lost: tuple[int, ...]
    """Numbers of manoeuvres whose pulses do not follow from their deflections."""
    heard: str

    @property
    def notice(self) -> Notice | None:
        """Sentence for the user; None where no manoeuvre is concerned."""
        said = []
        if self.anew:
            said.append(f"manoeuvres {_listed([m.number for m in self.anew])} are counted anew with it")
        if self.lost:
            said.append(f"manoeuvres {_listed(self.lost)} had an assumed value and are excluded")
        return Notice(READER_NOTICE, f"{self.heard}: {'; '.join(said)}.") if said else None


def recount(maneuvers: Sequence[Maneuver], event: ElevatorRescaled) -> Recount:
    """Return what a limit that is heard late means for the manoeuvres of its log or link.

    A manoeuvre that was not on the former scale keeps its own scale, because its vehicle had other settings.
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
