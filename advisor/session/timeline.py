"""The messages of a log by replay time, and the goals of a fast replay."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from advisor.campaign.state import CampaignState
from advisor.flight.signals.messages import Columns, cut
from advisor.process.arrays import IntArray

LONGEST_SILENCE_S = 2.0
"""Longest replay time of a silence in a log, or of a jump of its clock, s."""


class Timeline:
    """Columns of a log, divided into parts by replay time. Each message is delivered once and in order.

    Parameters
    ----------
    columns : sequence of Columns
        One complete log, or several logs in the order of the flights. One message type may come in several
        pieces.
    """

    def __init__(self, columns: Sequence[Columns]) -> None:
        self._pieces = [piece for piece in columns if len(piece)]
        self._orders = _through(self._pieces)
        order = np.concatenate([np.zeros(0, np.int64), *self._orders])
        arrival = np.concatenate([np.zeros(0), *(p.arrival_s for p in self._pieces)])
        sequence = np.argsort(order)
        self._order = order[sequence]
        # Arrival stamps of damaged or spliced logs leap by years and run backwards.
        pauses = np.clip(np.diff(arrival[sequence]), 0.0, LONGEST_SILENCE_S)
        self._played_s = np.concatenate([np.zeros(min(1, len(order))), np.cumsum(pauses)])
        self._next = [0] * len(self._pieces)

    def __len__(self) -> int:
        return len(self._order)

    @property
    def duration_s(self) -> float:
        """Replay time of the last message, s."""
        return float(self._played_s[-1]) if len(self) else 0.0

    def up_to(self, position_s: float) -> list[Columns]:
        """Return the messages with a replay time of at most ``position_s`` that were not yet delivered."""
        count = int(np.searchsorted(self._played_s, position_s, side="right"))
        if count == 0:
            return []
        last = self._order[count - 1]
        batch = []
        for number, (piece, order) in enumerate(zip(self._pieces, self._orders, strict=True)):
            start, end = self._next[number], int(np.searchsorted(order, last, side="right"))
            if end > start:
                batch.append(cut(piece, slice(start, end)))
                self._next[number] = end
        return batch

    def rewind(self) -> None:
        """Begin again with the first message."""
        self._next = [0] * len(self._pieces)


def _through(pieces: Sequence[Columns]) -> list[IntArray]:
    """Return the order of arrival of each piece among the messages of all flights."""
    flights = sorted({piece.flight for piece in pieces})
    first, behind = {}, 0
    for flight in flights:
        orders = [piece.order for piece in pieces if piece.flight == flight]
        first[flight] = behind - min(int(order[0]) for order in orders)
        behind = first[flight] + max(int(order[-1]) for order in orders) + 1
    return [piece.order + first[piece.flight] for piece in pieces]


LEAD_S = 1.0


@dataclass(frozen=True, slots=True)
class Goal:
    """The moment just before manoeuvre ``number`` is flown."""

    number: int
    start: tuple[int, int, float] | None
    """Flight, power-on and vehicle time of the first step, if the manoeuvre was judged before. None: the
    start of the manoeuvre is still to come."""

    def reached(self, state: CampaignState, position_s: float = 0.0) -> bool:
        """Return whether the replay has reached or passed the goal."""
        done = len(state.maneuvers)
        if done >= self.number:
            return True
        if self.start is not None:
            return done == self.number - 1 and (state.flight, state.boot, state.now_s + LEAD_S) >= self.start
        return state.flying is not None and state.flying.number >= self.number


@dataclass(frozen=True, slots=True)
class DataBegin:
    """The moment at which the data of a log become sufficient. Many logs begin with slow streams or
    parameters."""

    def reached(self, state: CampaignState, position_s: float = 0.0) -> bool:
        return state.serves


@dataclass(frozen=True, slots=True)
class Position:
    """A position of the replay, in s since the first record, with silences shortened."""

    position_s: float

    def reached(self, state: CampaignState, position_s: float) -> bool:
        """Return whether the replay has reached the position, or passed it."""
        return position_s >= self.position_s
