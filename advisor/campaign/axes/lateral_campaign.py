"""The lateral campaign: its manoeuvres, their estimates and verdicts, and the joint estimate."""

from collections.abc import Sequence
from dataclasses import replace

from advisor.aircraft.aircraft import Aircraft
from advisor.campaign.axis_campaign import AxisCampaign, Flown
from advisor.campaign.joint_estimate import NEWEST
from advisor.campaign.single_maneuver import untold
from advisor.campaign.state import LateralState
from advisor.decision.axes.lateral_stop import JUDGED, lateral_flight_test
from advisor.decision.axes.requirements import judge, responses_of
from advisor.decision.axes.side_input import FlownInput
from advisor.decision.change import find_change
from advisor.decision.heard import Heard
from advisor.decision.history import CandidateManeuver
from advisor.decision.verdict import FlightTestVerdict
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.model.axes.lateral import LATERAL
from advisor.oem.axis.estimate import AxisEstimate
from advisor.oem.axis.estimator import JointSearch, estimate_axis
from advisor.process.parts import Parts
from advisor.words.problems import Problem

OF_EACH = 3
"""Number of newest manoeuvres of each control that stay in the joint estimate, so that both controls stay
represented. With three manoeuvres, one may contradict two that agree."""


class LateralCampaign(AxisCampaign):
    """Estimates and judges each lateral manoeuvre as it arrives.

    Parameters
    ----------
    aircraft
        The crew's aircraft file. The lateral stopping rule is ``information``, whatever the aircraft file
        chooses for pitch.
    advises
        Whether the decision to stop in flight uses the joint estimate.
    """

    def __init__(self, aircraft: Aircraft, parts: Parts, advises: bool = True) -> None:
        self._advises = advises
        self._state: LateralState | None = None
        self._unknown: Problem | None = None
        self._joint: tuple[tuple[int, ...], AxisEstimate | None] | None = None
        self._search = JointSearch()
        plan = replace(aircraft.campaign, rule="information", parameters=tuple(JUDGED))
        super().__init__("lateral", aircraft, plan, parts)

    def _examined(self, maneuver: Maneuver) -> CandidateManeuver:
        estimate = estimate_axis(LATERAL, [maneuver], self._aircraft)
        return CandidateManeuver(
            estimate,
            judge("lateral", maneuver, estimate, self._aircraft),
            maneuver.data_notes,
            maneuver=maneuver,
            responses=tuple(response.output for response in responses_of("lateral", estimate)),
        )

    def _examine(self, flown: Flown) -> None:
        super()._examine(flown)
        self._joint = None  # it holds the former record

    def state(self, unknown: Problem | None = None) -> LateralState:
        """Return the lateral state after the newest manoeuvre; the identical object until a manoeuvre is
        added.

        Parameters
        ----------
        unknown
            Reason for which the output of aileron or rudder cannot be identified. None: the outputs of
            aileron and rudder are known.
        """
        if self._state is None or unknown != self._unknown:
            self._unknown = unknown
            model = self._joint_estimate
            verdict = self._by(model, self._still_heard)
            if unknown is not None and not self._flown:
                verdict = replace(verdict, sentence=str(unknown), next=None)
            numbers = tuple(self.judged[i].maneuver.number for i in self._joined()) if model else ()
            self._state = LateralState(self.judged, verdict, model, numbers)
        return self._state

    def _decided(self, history: Sequence[CandidateManeuver], heard: Sequence[Heard]) -> FlightTestVerdict:
        """Return the decision after the newest manoeuvre, as announced to the crew."""
        self._state = None
        joint = (self._advises or self._ended) and self._may_stop
        return self._by(self._joint_estimate if joint else None, heard)

    def _by(self, joint: AxisEstimate | None, heard: Sequence[Heard]) -> FlightTestVerdict:
        return self._parts.make(
            "lateral, stop or continue",
            lambda: lateral_flight_test(
                self._told,
                joint,
                self._aircraft,
                self._inputs,
                heard,
                find_change(self._examinations, self._plan),
                self._controls,
            ),
            lambda _: lateral_flight_test([], None, self._aircraft),
        )

    @property
    def _inputs(self) -> list[FlownInput]:
        """Inputs of all lateral manoeuvres, accepted or not."""
        return [
            FlownInput.of(judged.maneuver, judged.verdict.reasons, judged.estimate) for judged in self.judged
        ]

    @property
    def _controls(self) -> tuple[str, ...]:
        """Controls that any manoeuvre has recorded; both before the first manoeuvre."""
        recorded = {name for maneuver in self.maneuvers for name in maneuver.channels}
        return tuple(name for name in LATERAL.inputs if name in recorded) or LATERAL.inputs

    @property
    def _may_stop(self) -> bool:
        """Whether the test can stop after the newest manoeuvre: once, and after both controls were flown."""
        moved = {control for estimate in self._told if estimate is not None for control in estimate.flown}
        return moved >= set(self._controls) and not any(item.stops for item in self._still_heard)

    @property
    def _told(self) -> list[AxisEstimate | None]:
        """Lateral estimate of every manoeuvre; None for a manoeuvre that is not accepted."""
        return [
            m.estimate if m.verdict.accepted and isinstance(m.estimate, AxisEstimate) else None
            for m in self.judged
        ]

    @property
    def _joint_estimate(self) -> AxisEstimate | None:
        """Joint estimate, computed once for the same manoeuvres; None without accepted manoeuvres."""
        joined = self._joined()
        if self._joint is None or self._joint[0] != joined:
            maneuvers = [self.judged[i].maneuver for i in joined]
            # At the end all manoeuvres are searched from the data alone.
            search = None if self._ended else self._search
            joint = self._parts.make(
                "lateral, joint estimate",
                lambda: estimate_axis(LATERAL, maneuvers, self._aircraft, search),
                untold,
            )
            self._joint = joined, joint if isinstance(joint, AxisEstimate) else None
        return self._joint[1]

    def _joined(self) -> tuple[int, ...]:
        """Return indices of manoeuvres in the joint estimate: newest accepted in flight; all at the end."""
        accepted = [i for i, judged in enumerate(self.judged) if judged.verdict.accepted]
        if self._ended:
            return tuple(accepted)
        kept: set[int] = set()
        inputs = self._inputs
        for control in LATERAL.inputs:
            kept |= set([i for i in accepted if inputs[i].control == control][-OF_EACH:])
        others = [i for i in accepted if i not in kept]
        return tuple(sorted(kept.union(others[max(len(others) + len(kept) - NEWEST, 0) :])))
