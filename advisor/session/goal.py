"""Goals to which a replay hurries: a manoeuvre, a position, or the begin of the data."""

from dataclasses import dataclass

from advisor.campaign.state import CampaignState

LEAD_S = 1.0


@dataclass(frozen=True, slots=True)
class Goal:
    """The moment just before manoeuvre ``number`` is flown."""

    number: int
    start: tuple[int, int, float] | None
    """Flight, power-on and vehicle time of the first step, where the manoeuvre was judged before. None: it
    lies ahead."""

    def reached(self, state: CampaignState, position_s: float = 0.0) -> bool:
        """Return whether the replay has reached the goal, or passed it."""
        done = len(state.maneuvers)
        if done >= self.number:
            return True
        if self.start is not None:
            return done == self.number - 1 and (state.flight, state.boot, state.now_s + LEAD_S) >= self.start
        return state.flying is not None and state.flying.number >= self.number


@dataclass(frozen=True, slots=True)
class DataBegin:
    """The moment at which the data of a log can serve. Many logs begin with slow streams or parameters."""

    def reached(self, state: CampaignState, position_s: float = 0.0) -> bool:
        """Return whether the present data can serve."""
        return state.serves


@dataclass(frozen=True, slots=True)
class Position:
    """A position of the replay, s since the first record with silences shortened."""

    position_s: float

    def reached(self, state: CampaignState, position_s: float) -> bool:
        """Return whether the replay has reached the position, or passed it."""
        return position_s >= self.position_s
