"""The lateral half of a campaign: its manoeuvres, their estimates and verdicts, and the joint estimate."""

from dataclasses import dataclass

from advisor.aircraft.aircraft import Aircraft
from advisor.decision.acceptance import MANEUVER_RULES
from advisor.decision.lateral_quality import judge_lateral
from advisor.decision.lateral_test import lateral_flight_test
from advisor.decision.verdict import FlightTestVerdict, ManeuverVerdict, Reason
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.oem.estimate import NoEstimate
from advisor.oem.lateral_estimator import LateralEstimate, estimate_lateral


@dataclass(frozen=True, slots=True)
class JudgedLateral:
    """One lateral manoeuvre, its estimate and the verdict on it."""

    maneuver: Maneuver
    estimate: LateralEstimate | NoEstimate
    verdict: ManeuverVerdict


@dataclass(frozen=True, slots=True)
class LateralState:
    """State of the lateral half of a campaign."""

    maneuvers: tuple[JudgedLateral, ...]
    flight_test: FlightTestVerdict
    model: LateralEstimate | None
    """Joint estimate over the accepted manoeuvres. None before the end, or without any."""
    estimate_from: tuple[int, ...]
    """Numbers of the manoeuvres that ``model`` is made from."""


class LateralCampaign:
    """Estimates and judges lateral manoeuvres as they come.

    Parameters
    ----------
    aircraft
        The crew's aircraft file.
    """

    def __init__(self, aircraft: Aircraft) -> None:
        self._aircraft = aircraft
        self._flown: list[tuple[Maneuver, LateralEstimate | NoEstimate, tuple[Reason, ...]]] = []
        self._model: LateralEstimate | None = None

    def take(self, maneuver: Maneuver) -> None:
        """Estimate and examine a manoeuvre that has just been flown."""
        estimate = estimate_lateral([maneuver], self._aircraft)
        self._flown.append((maneuver, estimate, judge_lateral(maneuver, estimate, self._aircraft)))

    @property
    def maneuvers(self) -> tuple[Maneuver, ...]:
        """Manoeuvres in the order flown."""
        return tuple(maneuver for maneuver, _, _ in self._flown)

    def finish(self) -> None:
        """Make the joint estimate over the accepted manoeuvres."""
        accepted = [maneuver for maneuver, _, reasons in self._flown if not reasons]
        model = estimate_lateral(accepted, self._aircraft)
        self._model = None if isinstance(model, NoEstimate) else model

    @property
    def state(self) -> LateralState:
        """State after the newest manoeuvre."""
        costs = [
            None if reasons or isinstance(estimate, NoEstimate) else estimate.estimate.cost
            for _, estimate, reasons in self._flown
        ]
        rules = {rule: judge(costs) for rule, judge in MANEUVER_RULES.items()}
        judged = tuple(
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
        history = [
            None if reasons or isinstance(estimate, NoEstimate) else estimate
            for _, estimate, reasons in self._flown
        ]
        return LateralState(
            judged,
            lateral_flight_test(history, self._aircraft.campaign),
            self._model,
            tuple(m.number for m, _, reasons in self._flown if not reasons) if self._model else (),
        )
