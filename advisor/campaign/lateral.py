"""The lateral half of a campaign: its manoeuvres, their estimates and verdicts, and the joint estimate."""

from dataclasses import replace

from advisor.aircraft.aircraft import Aircraft
from advisor.campaign.single_maneuver import objection, untold
from advisor.campaign.state import JudgedLateral, LateralState
from advisor.decision.axes.lateral import judge_lateral
from advisor.decision.heard import Heard
from advisor.decision.lateral_advice import FlownInput
from advisor.decision.lateral_test import lateral_flight_test
from advisor.decision.paper_rules import MANEUVER_RULES
from advisor.decision.verdict import FlightTestVerdict, ManeuverVerdict, Reason
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.model.lateral import LATERAL
from advisor.oem.estimate import NoEstimate
from advisor.oem.lateral_estimate import LateralEstimate
from advisor.oem.lateral_estimator import estimate_lateral
from advisor.process.parts import Parts
from advisor.words.problems import Problem

NEWEST = 7
"""Number of newest accepted manoeuvres that are estimated together in flight, as for the elevator."""
OF_EACH = 3
"""Number of them that are kept of each control, so that inputs of one control alone do not make the estimate
forget the other. The least number in which one contradicts two that agree."""


class LateralCampaign:
    """Estimates and judges lateral manoeuvres as they come.

    Parameters
    ----------
    aircraft
        The crew's aircraft file.
    parts
        Makes manoeuvres, decision and joint estimate, each of which may fail alone.
    """

    def __init__(self, aircraft: Aircraft, parts: Parts) -> None:
        self._aircraft = aircraft
        self._parts = parts
        self._flown: list[tuple[Maneuver, LateralEstimate | NoEstimate, tuple[Reason, ...]]] = []
        self._inputs: list[FlownInput] = []
        self._ended = False
        self._state: LateralState | None = None
        self._unknown: Problem | None = None
        self._joint: tuple[tuple[int, ...], LateralEstimate | None] | None = None
        self._heard: list[Heard] = []
        self._told = lateral_flight_test([], None, aircraft)

    def take(self, maneuver: Maneuver) -> JudgedLateral:
        """Estimate and examine a manoeuvre that has just been flown."""
        estimate, reasons = self._parts.make(
            f"lateral, manoeuvre {maneuver.number}",
            lambda: self._examined(maneuver),
            lambda part: (untold(part), (objection(part),)),
        )
        self._flown.append((maneuver, estimate, reasons))
        self._inputs.append(FlownInput.of(maneuver, reasons))
        self._state = None
        self._told = self._decided(self._joint_estimate if self._may_stop else None)
        self._heard.append(Heard.of(self._told))
        return self._judged()[-1]

    def _examined(self, maneuver: Maneuver) -> tuple[LateralEstimate | NoEstimate, tuple[Reason, ...]]:
        """Return the estimate of a manoeuvre, and the objections to it."""
        estimate = estimate_lateral([maneuver], self._aircraft)
        return estimate, judge_lateral(maneuver, estimate, self._aircraft)

    @property
    def maneuvers(self) -> tuple[Maneuver, ...]:
        """Manoeuvres in the order flown."""
        return tuple(maneuver for maneuver, _, _ in self._flown)

    def finish(self) -> None:
        """Take the end of the flight, after which the joint estimate is over all accepted manoeuvres."""
        self._ended = True
        self._state = None

    def state(self, unknown: Problem | None = None) -> LateralState:
        """Return the state after the newest manoeuvre; the identical object while nothing is added.

        Parameters
        ----------
        unknown
            Reason for which aileron or rudder cannot be followed. None: their outputs are known.
        """
        if self._state is None or unknown != self._unknown:
            self._unknown = unknown
            model = self._joint_estimate
            verdict = self._decided(model)
            if unknown is not None and not self._flown:
                verdict = replace(verdict, sentence=str(unknown), next=None)
            numbers = tuple(self._flown[i][0].number for i in self._joined()) if model else ()
            self._state = LateralState(self._judged(), verdict, model, numbers)
        return self._state

    @property
    def flight_test(self) -> FlightTestVerdict:
        """Whether the test may stop, and the next input, as the crew heard it after the newest manoeuvre."""
        return self._told

    @property
    def _may_stop(self) -> bool:
        """Whether the newest manoeuvre can decide: both controls were flown, and no stop was heard before.

        Without both, nothing is known of one control. A joint estimate takes a second.
        """
        moved = {control for one in self._accepted if one is not None for control in one.flown}
        return moved >= set(LATERAL.inputs) and not any(one.stops for one in self._heard)

    @property
    def _accepted(self) -> list[LateralEstimate | None]:
        """Estimate of every manoeuvre; None for one that is not accepted."""
        return [
            None if reasons or isinstance(estimate, NoEstimate) else estimate
            for _, estimate, reasons in self._flown
        ]

    @property
    def _joint_estimate(self) -> LateralEstimate | None:
        """Joint estimate, computed once for the same manoeuvres; None where there is none."""
        joined = self._joined()
        if self._joint is None or self._joint[0] != joined:
            maneuvers = [self._flown[i][0] for i in joined]
            found = self._parts.make(
                "lateral, joint estimate", lambda: estimate_lateral(maneuvers, self._aircraft), untold
            )
            self._joint = joined, found if isinstance(found, LateralEstimate) else None
        return self._joint[1]

    def _decided(self, joint: LateralEstimate | None) -> FlightTestVerdict:
        return self._parts.make(
            "lateral, stop or continue",
            lambda: lateral_flight_test(self._accepted, joint, self._aircraft, self._inputs, self._heard),
            lambda _: lateral_flight_test([], None, self._aircraft),
        )

    def _joined(self) -> tuple[int, ...]:
        """Return the places of the manoeuvres of the joint estimate: the newest accepted ones of each control
        in flight, all at the end."""
        accepted = [i for i, (_, _, reasons) in enumerate(self._flown) if not reasons]
        if self._ended:
            return tuple(accepted)
        kept: set[int] = set()
        for control in LATERAL.inputs:
            kept |= set([i for i in accepted if self._inputs[i].control == control][-OF_EACH:])
        others = [i for i in accepted if i not in kept]
        return tuple(sorted(kept.union(others[max(len(others) + len(kept) - NEWEST, 0) :])))

    def _judged(self) -> tuple[JudgedLateral, ...]:
        costs = [
            None if reasons or isinstance(estimate, NoEstimate) else estimate.estimate.cost
            for _, estimate, reasons in self._flown
        ]
        rules = {rule: judge(costs) for rule, judge in MANEUVER_RULES.items()}
        return tuple(
            JudgedLateral(
                maneuver,
                estimate,
                ManeuverVerdict(
                    not reasons,
                    f"REPEAT: {reasons[0].text}" if reasons else "accepted",
                    reasons,
                    {rule: results[i] for rule, results in rules.items()},
                    maneuver.data_notes,
                ),
            )
            for i, (maneuver, estimate, reasons) in enumerate(self._flown)
        )
