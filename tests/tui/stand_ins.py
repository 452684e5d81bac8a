"""Stand-ins for the campaign and the link, under the tests' control."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from queue import Empty, SimpleQueue

import numpy as np

from advisor.campaign.engineer import Engineer
from advisor.campaign.state import NOTHING, ByHand, CampaignState, JudgedManeuver, Remark
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.maneuvers.marks import Mark
from advisor.flight.signals.messages import Columns
from advisor.session.conducting import LinkHealth, LinkRequest
from advisor.words.axes import AxisName
from advisor.words.problems import Problem
from tests.campaign.states import changed
from tests.tui import flights


def columns(order: Sequence[int], arrival_s: Sequence[float], name: str = "ATTITUDE") -> Columns:
    """Messages whose only field is their own arrival index."""
    index = np.asarray(order, dtype=np.int64)
    return Columns(name, 1, 1, index, np.asarray(arrival_s, dtype=np.float64), {"index": index})


class StagedCampaign:
    """Shows the states it was given, one more for each batch it is fed; records what it is asked."""

    judging_s = 0.0

    def __init__(
        self,
        states: Sequence[CampaignState],
        on_feed: Callable[[], None] = lambda: None,
        by_hand: ByHand = NOTHING,
    ) -> None:
        self._states = states
        self._on_feed = on_feed
        self._stage = 0
        self.fed: list[int] = []
        self.feeding = False
        self.calls: list[tuple[object, ...]] = []
        self.problems: list[Problem] = []
        self.decided = by_hand
        self.engineer = self
        self.is_judging = False
        self.waited = 0
        self._marking_since_s: float | None = None
        self._logged: list[tuple[int, str]] = []
        self._known: dict[object, tuple[JudgedManeuver, ...]] = {}

    @property
    def state(self) -> CampaignState:
        # As with the real campaign, what did not change stays the same object.
        now = self._states[min(self._stage, len(self._states) - 1)]
        return changed(
            now,
            maneuvers=self._maneuvers(now),
            marking_since_s=self._marking_since_s,
            notices=self._notices(now) if self._logged else now.notices,
        )

    def _notices(self, now: CampaignState) -> tuple[str, ...]:
        notices = list(now.notices)
        for k, (at, sentence) in enumerate(self._logged):
            notices.insert(at + k, f"      –  {sentence}")
        return tuple(notices)

    def log(self, sentence: str) -> None:
        self._logged.append((len(self._states[min(self._stage, len(self._states) - 1)].notices), sentence))

    def _maneuvers(self, now: CampaignState) -> tuple[JudgedManeuver, ...]:
        key = (id(now), self.decided)
        if key not in self._known:
            self._known[key] = tuple(
                replace(j, excluded_because=self.decided.excluded_because(j.maneuver)) for j in now.maneuvers
            )
        return self._known[key]

    def feed(self, batch: Sequence[Columns]) -> list[object]:
        self.feeding = True
        self._on_feed()
        self.feeding = False
        self._stage += 1
        self.fed += sorted(int(k) for piece in batch for k in piece.order)
        return []

    def wait(self) -> None:
        self.waited += 1

    def finish(self) -> list[object]:
        self.calls.append(("finish",))
        return []

    apply = Engineer.apply

    def exclude(self, number: int, because: str, axis: AxisName = "pitch") -> None:
        self.calls.append(("exclude", number, because))
        self.decided = self.decided.excluding(self._flown(number), because)

    def include(self, number: int, axis: AxisName = "pitch") -> None:
        self.calls.append(("include", number))
        self.decided = self.decided.excluding(self._flown(number), None)

    def mark(self, text: str) -> None:
        self.calls.append(("mark", text))
        self.decided = self.decided.remarking(Remark(self.state.now_s, text))

    def begin_maneuver(self) -> None:
        self._marking_since_s = self.state.now_s

    def end_maneuver(self) -> None:
        assert self._marking_since_s is not None
        self.decided = self.decided.marking(Mark(self._marking_since_s, self.state.now_s))
        self._marking_since_s = None

    def note(self, number: int, text: str, axis: AxisName = "pitch") -> None:
        self.calls.append(("note", number, text))
        self.decided = self.decided.noting(self._flown(number), text)

    def _flown(self, number: int) -> Maneuver:
        return next(j.maneuver for j in self.state.maneuvers if j.maneuver.number == number)


class HandFedSource:
    """Delivers what a test puts into it."""

    def __init__(self) -> None:
        self.batches: SimpleQueue[Sequence[Columns] | Exception | None] = SimpleQueue()
        self.condition = LinkHealth(
            "good", "412 messages/s, none lost.", (("messages", "412 /s"), ("lost", "0.0 %"))
        )
        self.notices: list[str] = []
        self.kept: list[ByHand] = []
        self.orders: list[LinkRequest] = []
        self.closed = False

    def deliver(self, count: int = 1) -> None:
        """Put in ``count`` batches of one message."""
        for _ in range(count):
            self.batches.put([columns([0], [0.0])])

    def order(self, order: LinkRequest) -> None:
        self.orders.append(order)

    def read(self, timeout_s: float) -> Sequence[Columns] | None:
        try:
            batch = self.batches.get(timeout=timeout_s)
        except Empty:
            return ()
        if isinstance(batch, Exception):
            raise batch
        return batch

    def health(self) -> LinkHealth:
        return self.condition

    def take_notices(self) -> Sequence[str]:
        taken, self.notices = self.notices, []
        return taken

    def keep(self, by_hand: ByHand) -> str:
        self.kept.append(by_hand)
        return "decisions by hand are kept"

    def close(self) -> None:
        self.closed = True


def staged(by_hand: ByHand = NOTHING) -> StagedCampaign:
    """A campaign of seven manoeuvres."""
    return StagedCampaign((flights.state(),), by_hand=by_hand)
