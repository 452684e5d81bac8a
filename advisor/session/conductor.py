"""The conductor: reads one source into one campaign and reports the results.

Only the thread of ``run`` uses the campaign. The other methods only store a request, whose result comes
through ``tell``.
"""

from collections.abc import Callable
from math import inf
from queue import Empty, SimpleQueue
from threading import Event
from time import monotonic
from typing import TYPE_CHECKING, Any

from advisor.campaign.state import NOTHING, ByHand, HandDecision
from advisor.process.liveness import ENDED_AFTER_S
from advisor.session.conducting import Conducting, LinkRequest, SessionReport, Source, Tell
from advisor.session.replay import LogPlayer
from advisor.session.timeline import DataBegin, Goal, Position

if TYPE_CHECKING:
    from advisor.campaign.campaign import Campaign

REPORT_EVERY_S = 0.1
_READ_TIMEOUT_S = 0.05


class Conductor(Conducting):
    """Runs a campaign over a source until `stop` is called.

    Parameters
    ----------
    make_campaign : callable
        Makes a campaign from the decisions by hand. The function is called by ``run``, and again for a
        rewind.
    """

    def __init__(
        self, source: Source, make_campaign: "Callable[[ByHand], Campaign]", by_hand: ByHand = NOTHING
    ) -> None:
        self._source = source
        self._player = source if isinstance(source, LogPlayer) else None
        self._make_campaign = make_campaign
        self._tell: Tell = lambda report: None
        self._requests: SimpleQueue[Callable[[Campaign], None]] = SimpleQueue()
        self._by_hand = by_hand
        self._said_where = ""
        self._pending: list[HandDecision] = []
        self._goal: Goal | DataBegin | Position | None = None
        self._stopped = Event()
        self._rewound = False
        self._told_s = -inf

    def run(self, tell: Tell) -> None:
        """Run the campaign until `stop`. The calling thread is the working thread.

        Parameters
        ----------
        tell : callable
            Receives a `SessionReport` at most every `REPORT_EVERY_S`, in this thread.

        Raises
        ------
        UnusableInputError
            The source's data can never be sufficient.
        """
        self._tell = tell
        try:
            while not self._stopped.is_set():
                self._rewound = False
                self._conduct(self._make_campaign(self._by_hand))
        finally:
            self._source.close()

    def stop(self) -> None:
        """End `run` at the next possible moment."""
        self._stopped.set()

    def ask(self, name: str, *arguments: Any) -> None:
        """Store a request for the thread of ``run``. The tempo of a replay changes at once."""
        if name not in ("play", "step"):
            self._requests.put(lambda campaign: getattr(self, f"_{name}")(campaign, *arguments))
        elif self._player is not None:
            getattr(self._player, name)(*arguments)

    def _conduct(self, campaign: "Campaign") -> None:
        """Run one campaign until a rewind or the stop."""
        ended = False
        if self._goal is None and not campaign.state.serves:
            self._hurry_to(DataBegin())
        while not self._stopped.is_set():
            self._answer(campaign, _READ_TIMEOUT_S if ended else 0.0)
            if self._rewound:
                return
            if ended:
                self._arrive()
                continue
            batch = self._source.read(_READ_TIMEOUT_S)
            if batch is None:
                ended = True
                campaign.finish()
                self._keep(campaign)
                self._arrive()
            elif batch or campaign.is_judging:
                # Before a long estimate, whoever waits learns how old the data are.
                self._report_if_due(campaign)
                campaign.feed(batch)
                hurried = self._player is not None and self._player.is_hurried
                # Silence tells the watch of this process that an estimate hangs.
                if hurried or campaign.judging_s > ENDED_AFTER_S:
                    campaign.wait()
            if self._pending:
                self._decide_what_is_due(campaign)
            if self._goal and self._goal.reached(campaign.state, self._position_s()):
                self._arrive()
            if ended:
                self._report(campaign)
            else:
                self._report_if_due(campaign)

    def _answer(self, campaign: "Campaign", timeout_s: float) -> None:
        """Carry out the requests of the screens, after waiting for the first one."""
        try:
            self._requests.get(timeout=timeout_s or None, block=timeout_s > 0.0)(campaign)
        except Empty:
            return
        self._report(campaign)

    def _report_if_due(self, campaign: "Campaign") -> None:
        if monotonic() - self._told_s >= REPORT_EVERY_S:
            self._report(campaign)

    def _report(self, campaign: "Campaign") -> None:
        for sentence in self._source.take_notices():
            campaign.log(f"link: {sentence}")
        state = campaign.state
        playback = self._player.playback() if self._player is not None else None
        problems = () if state.maneuvers else tuple(campaign.problems)
        self._tell(SessionReport(state, self._source.health(), playback, state.notices, problems))
        self._told_s = monotonic()

    def _decide(self, campaign: "Campaign", decision: HandDecision) -> None:
        """Apply a decision at once, or after a jump back when its manoeuvre has been flown again."""
        self._pending.append(decision)
        self._decide_what_is_due(campaign)

    def _decide_what_is_due(self, campaign: "Campaign") -> None:
        state = campaign.state
        for decision in [d for d in self._pending if d.due(state)]:
            campaign.engineer.apply(decision)
            self._pending.remove(decision)
            self._keep(campaign)

    def _keep(self, campaign: "Campaign") -> None:
        """Store the decisions by hand for a rewind, and in the file next to the data."""
        if campaign.engineer.decided != self._by_hand:
            self._by_hand = campaign.engineer.decided
            where = self._source.keep(self._by_hand)
            if where != self._said_where:
                self._said_where = where
                campaign.log(where)

    def _order(self, campaign: "Campaign", order: LinkRequest) -> None:
        self._source.order(order)

    def _jump(self, campaign: "Campaign", number: int) -> None:
        if self._player is None:
            return
        maneuver = next((j.maneuver for j in campaign.state.maneuvers if j.maneuver.number == number), None)
        self._hurry_to(Goal(number, (*maneuver.power_on, maneuver.span.start_s) if maneuver else None))
        if maneuver:
            self._player.rewind()
            self._rewound = True

    def _seek(self, campaign: "Campaign", position_s: float) -> None:
        if self._player is None:
            return
        self._hurry_to(Position(position_s))
        if position_s < self._player.playback().position_s:
            self._player.rewind()
            self._rewound = True

    def _hurry_to(self, goal: Goal | DataBegin | Position) -> None:
        """Play a log as fast as possible until the goal is reached. A live link cannot play faster."""
        if self._player is not None:
            self._goal = goal
            self._player.hurry(True)

    def _position_s(self) -> float:
        """Return the position of the replay, s; 0 on a link."""
        return self._player.playback().position_s if self._player is not None else 0.0

    def _arrive(self) -> None:
        """End the jump, at its goal or at the end of the log."""
        if self._goal is not None and self._player is not None:
            self._player.hurry(False)
            self._goal = None
