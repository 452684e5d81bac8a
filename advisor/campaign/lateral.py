"""The lateral half of a campaign: its manoeuvres, their estimates and verdicts, and the joint estimate."""

from dataclasses import replace

from advisor.aircraft.aircraft import Aircraft
from advisor.campaign.lateral_state import JudgedLateral, LateralState
from advisor.campaign.single_maneuver import objection, untold
from advisor.decision.acceptance import MANEUVER_RULES
from advisor.decision.lateral_advice import FlownInput
from advisor.decision.lateral_quality import judge_lateral
from advisor.decision.lateral_test import lateral_flight_test
from advisor.decision.verdict import FlightTestVerdict, ManeuverVerdict, Reason
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.oem.estimate import NoEstimate
from advisor.oem.lateral_estimate import LateralEstimate
from advisor.oem.lateral_estimator import estimate_lateral
from advisor.process.parts import Parts
from advisor.words.problems import Problem

NEWEST = 7
"""Number of newest accepted manoeuvres that are estimated together during the flight. The elevator has the
same number."""


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
        self._ended = False
        self._state: LateralState | None = None
        self._unknown: Problem | None = None

    def take(self, maneuver: Maneuver) -> JudgedLateral:
        """Estimate and examine a manoeuvre that has just been flown."""
        estimate, reasons = self._parts.make(
            f"lateral, manoeuvre {maneuver.number}",
            lambda: self._examined(maneuver),
            lambda part: (untold(part), (objection(part),)),
        )
        self._flown.append((maneuver, estimate, reasons))
        self._state = None
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
            joined = self._joined()
            model = self._parts.make(
                "lateral, joint estimate", lambda: estimate_lateral(joined, self._aircraft), untold
            )
            found = model if isinstance(model, LateralEstimate) else None
            numbers = tuple(maneuver.number for maneuver in joined) if found else ()
            verdict = self.flight_test
            if unknown is not None and not self._flown:
                verdict = replace(verdict, sentence=str(unknown), next=None)
            self._state = LateralState(self._judged(), verdict, found, numbers)
        return self._state

    @property
    def flight_test(self) -> FlightTestVerdict:
        """Whether the test may stop, and the next input."""
        history = [
            None if reasons or isinstance(estimate, NoEstimate) else estimate
            for _, estimate, reasons in self._flown
        ]
        inputs = [FlownInput.of(maneuver, reasons) for maneuver, _, reasons in self._flown]
        return self._parts.make(
            "lateral, stop or continue",
            lambda: lateral_flight_test(history, self._aircraft, inputs),
            lambda _: lateral_flight_test([], self._aircraft, []),
        )

    def _joined(self) -> list[Maneuver]:
        """Return the manoeuvres of the joint estimate: the newest accepted ones in flight, all at the end."""
        accepted = [maneuver for maneuver, _, reasons in self._flown if not reasons]
        return accepted if self._ended else accepted[-NEWEST:]

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
