"""The elevator's campaign: its manoeuvres, their estimates and verdicts, and the joint estimate."""

from collections.abc import Callable, Sequence

from advisor.aircraft.aircraft import Aircraft
from advisor.campaign.axis_campaign import AxisCampaign
from advisor.campaign.hand_decisions import ByHand
from advisor.campaign.instruments import as_known_by
from advisor.campaign.joint_estimate import NEWEST, Together
from advisor.campaign.learning import lag_said, may_learn, of_another_power_on
from advisor.campaign.learning import learnt as learnt_from
from advisor.campaign.single_maneuver import assess
from advisor.campaign.state import JudgedManeuver
from advisor.decision.heard import Heard
from advisor.decision.history import CandidateManeuver
from advisor.decision.stopping import flight_test
from advisor.decision.verdict import FlightTestVerdict
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.oem.estimate import Estimate
from advisor.process.parts import Parts


class ElevatorCampaign(AxisCampaign):
    """Estimates and judges each elevator manoeuvre as it arrives. Each manoeuvre improves the instruments'
    values.

    Parameters
    ----------
    say
        Called with a sentence when the manoeuvres have given new values of the instruments.
    """

    def __init__(self, aircraft: Aircraft, say: Callable[[str], object], parts: Parts) -> None:
        super().__init__("pitch", aircraft, aircraft.campaign, parts)
        self.learnt = aircraft
        """The crew's aircraft with the instruments' values from the manoeuvres."""
        self._told_by: set[tuple[int, int]] = set()
        self._say = say
        self._together = Together(aircraft)

    def decide(self) -> None:
        """Judge all manoeuvres, and examine them again if they have given new values of the instruments."""
        self._judge()
        self._parts.make("pitch, instruments from the manoeuvres", self._learn, lambda _: None)

    @property
    def joined(self) -> Sequence[JudgedManeuver]:
        """Manoeuvres of the joint estimate: the newest accepted ones in flight, all accepted ones at the
        end."""
        accepted = self._accepted
        return accepted if self._ended else accepted[-NEWEST:]

    @property
    def model(self) -> Estimate | None:
        """The joint estimate; None without an accepted manoeuvre."""
        joined = [judged.maneuver for judged in self.joined]
        return self._parts.make(
            "pitch, joint estimate", lambda: self._together.estimate(joined), lambda _: None
        )

    def _examined(self, maneuver: Maneuver) -> CandidateManeuver:
        """Estimate and examine one manoeuvre with the instruments' values from the other manoeuvres."""
        learnt = self.learnt if maneuver.power_on in self._told_by else of_another_power_on(self.learnt)
        return assess(maneuver, learnt)

    def _add(self, maneuver: Maneuver, by_hand: ByHand) -> None:
        """Add a manoeuvre, and judge the earlier ones again if it contradicts their instruments."""
        super()._add(maneuver, by_hand)
        for flown in self._flown[:-1]:
            blamed = as_known_by(flown.maneuver, maneuver)
            if blamed is not flown.maneuver:
                self._replace(blamed)

    def _decided(self, history: Sequence[CandidateManeuver], heard: Sequence[Heard]) -> FlightTestVerdict:
        return flight_test(history, self._plan, self._aircraft, self._course, heard)

    @property
    def _of_lag(self) -> Estimate | None:
        """Joint estimate that determines the servo's lag; None before the first one."""
        accepted = [judged.maneuver for judged in self._accepted]
        estimate = self._together.of_lag if self._ended else self._together.of_lag_so_far
        return self._parts.make(
            "pitch, joint estimate of the servo's lag", lambda: estimate(accepted), lambda _: None
        )

    def _learn(self) -> None:
        """Examine all manoeuvres again if they have given new values of the instruments."""
        joined = self.joined
        if not may_learn(self.learnt, len(joined) == len(self._accepted)):
            return
        model = self._of_lag if self._aircraft.elevator.lag_s is None else self.model
        told_by = {judged.maneuver.power_on for judged in joined}
        learnt = learnt_from(self.learnt, model, one_power_on=len(told_by) == 1, exactly=self._ended)
        if learnt is self.learnt:
            return
        said, self.learnt, self._told_by = lag_said(self.learnt), learnt, told_by
        for flown in self._flown:
            self._examine(flown)
        if (sentence := lag_said(learnt)) not in ("", said):
            self._say(sentence)
        self._judge()
