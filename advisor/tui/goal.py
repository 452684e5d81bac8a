"""Where a jump in a replay ends."""

from dataclasses import dataclass

from advisor.campaign_state import CampaignState

LEAD_S = 1.0


@dataclass(frozen=True, slots=True)
class Goal:
    """Just before manoeuvre ``number`` is flown."""

    number: int
    start_s: float | None
    """Vehicle time of its first step when it was judged before; None when it still lies ahead."""

    def reached(self, state: CampaignState) -> bool:
        """Whether the replay has come there, or past it."""
        done = len(state.maneuvers)
        if done >= self.number:
            return True
        if self.start_s is not None:
            return done == self.number - 1 and state.now_s >= self.start_s - LEAD_S
        return state.flying is not None and state.flying.number >= self.number
