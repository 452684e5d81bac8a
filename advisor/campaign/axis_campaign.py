"""The campaign of one axis: its manoeuvres, their verdicts, and the engineer's decisions on them."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

from advisor.aircraft.aircraft import Aircraft, CampaignPlan
from advisor.campaign.hand_decisions import ByHand
from advisor.campaign.single_maneuver import failed, objection
from advisor.campaign.state import JudgedManeuver
from advisor.decision.course import CriterionCourse
from advisor.decision.heard import Heard, revision
from advisor.decision.history import CandidateManeuver
from advisor.decision.judge import judge_campaign
from advisor.decision.verdict import FlightTestVerdict, ManeuverVerdict
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.process.parts import FailedPart, Parts
from advisor.words.axes import AxisName


@dataclass(slots=True)
class Flown:
    """A manoeuvre, its examination, and the engineer's notes on the manoeuvre."""

    maneuver: Maneuver
    examined: CandidateManeuver
    notes: tuple[str, ...]
    revisions: tuple[str, ...] = ()
    """Sentences about changes of the verdict after the crew heard it."""

    def exclude(self, because: str | None) -> None:
        """Exclude the manoeuvre for a reason; None includes the manoeuvre."""
        self.examined = replace(self.examined, excluded_because=because)

    def judged(self, verdict: ManeuverVerdict) -> JudgedManeuver:
        examined = self.examined
        cautions = dict.fromkeys((*self.revisions, *verdict.cautions))
        said = replace(verdict, cautions=tuple(cautions)) if self.revisions else verdict
        return JudgedManeuver(self.maneuver, examined.estimate, said, examined.excluded_because, self.notes)


class AxisCampaign(ABC):
    """Judges the manoeuvres of one axis, and decides whether the test of this axis may stop.

    Parameters
    ----------
    parts
        Computes manoeuvres, verdicts and the joint estimate, each of which may fail separately.
    """

    def __init__(self, axis: AxisName, aircraft: Aircraft, plan: CampaignPlan, parts: Parts) -> None:
        self.axis = axis
        """Name of the axis."""
        self._aircraft = aircraft
        self._plan = plan
        self._parts = parts
        self._flown: list[Flown] = []
        self._course = CriterionCourse(plan)
        self._heard: list[Heard] = []
        self._ended = False
        self._revised: list[str] = []
        self._spoken: tuple[JudgedManeuver, ...] = ()
        self.judged: tuple[JudgedManeuver, ...] = ()
        """Manoeuvres in the order flown, each with its estimate and verdict."""
        self.flight_test = self._decided((), ())
        """Decision whether the test may stop, with the next manoeuvre."""

    @abstractmethod
    def _examined(self, maneuver: Maneuver) -> CandidateManeuver:
        """Estimate and examine a manoeuvre, before any rule compares it with other manoeuvres."""

    @abstractmethod
    def _decided(self, history: Sequence[CandidateManeuver], heard: Sequence[Heard]) -> FlightTestVerdict:
        """Return whether the test may stop, from the examined and the ``judged`` manoeuvres."""

    def take(self, maneuver: Maneuver, by_hand: ByHand) -> None:
        """Estimate and judge a manoeuvre that has just been flown, and decide again whether to stop."""
        self._add(maneuver, by_hand)
        self.decide()
        self._hear()

    def take_better(self, maneuver: Maneuver, because: str | None) -> None:
        """Replace a manoeuvre's record by a better one; exclude the manoeuvre if a reason is given."""
        self._replace(maneuver)
        self.exclude(maneuver.number, because)

    def decide(self) -> None:
        """Judge all manoeuvres, and decide again whether to stop."""
        self._judge()

    def exclude(self, number: int, because: str | None) -> None:
        """Exclude a manoeuvre from every decision for a reason; None includes the manoeuvre again."""
        self._of(number).exclude(because)
        self.decide()

    def note(self, number: int, text: str) -> None:
        self._of(number).notes += (text,)
        self._judge()

    def finish(self) -> None:
        """End the flight, and estimate all accepted manoeuvres together."""
        self._ended = True
        self.decide()
        self._note_revisions()

    @property
    def maneuvers(self) -> tuple[Maneuver, ...]:
        """Manoeuvres in the order flown."""
        return tuple(flown.maneuver for flown in self._flown)

    @property
    def estimates(self) -> tuple[Estimate | NoEstimate, ...]:
        return tuple(flown.examined.estimate for flown in self._flown)

    def numbered(self, number: int) -> JudgedManeuver:
        return next(judged for judged in self.judged if judged.maneuver.number == number)

    def _add(self, maneuver: Maneuver, by_hand: ByHand) -> None:
        """Add a manoeuvre that has just been flown, with the engineer's decisions on it."""
        flown = Flown(maneuver, self._assessed(maneuver), by_hand.notes_on(maneuver))
        flown.exclude(by_hand.excluded_because(maneuver))
        self._flown.append(flown)

    def _replace(self, maneuver: Maneuver) -> None:
        """Examine a new record of a manoeuvre, and replace the record with the same number."""
        flown = self._of(maneuver.number)
        flown.maneuver = maneuver
        self._examine(flown)

    def _examine(self, flown: Flown) -> None:
        """Estimate and examine a manoeuvre again. An exclusion of the manoeuvre remains."""
        because = flown.examined.excluded_because
        flown.examined = self._assessed(flown.maneuver)
        flown.exclude(because)

    def _assessed(self, maneuver: Maneuver) -> CandidateManeuver:
        """Return an examined manoeuvre; one without an estimate after a fault of the advisor."""
        part = f"{self.axis}, manoeuvre {maneuver.number}"
        return self._parts.make(part, partial(self._examined, maneuver), partial(failed, maneuver))

    def _hear(self) -> None:
        """Record the verdicts and criteria that are announced to the crew after the newest manoeuvre."""
        self._note_revisions()
        usable = [i for i, flown in enumerate(self._flown) if flown.examined.usable]
        self._heard.append(Heard.of(self.flight_test, usable))

    def _of(self, number: int) -> Flown:
        return next(flown for flown in self._flown if flown.maneuver.number == number)

    @property
    def _examinations(self) -> Sequence[CandidateManeuver]:
        return [flown.examined for flown in self._flown]

    @property
    def _accepted(self) -> Sequence[JudgedManeuver]:
        return [judged for judged in self.judged if judged.verdict.accepted]

    @property
    def _still_heard(self) -> Sequence[Heard]:
        """Return the criteria announced so far; none after an exclusion by hand, because every decision is
        then repeated.
        """
        excluded = any(flown.examined.excluded_because is not None for flown in self._flown)
        return () if excluded else self._heard

    def _judge(self) -> None:
        """Judge manoeuvres and flight test; after a numerical fault no manoeuvre has a verdict."""
        self._parts.make(f"{self.axis}, verdicts", self._judged, self._unjudged)

    def _judged(self) -> None:
        """Judge the manoeuvres and the flight test from the examinations of the manoeuvres."""
        history = self._examinations
        verdicts = judge_campaign(history, self._plan)
        self.judged = tuple(
            flown.judged(verdict) for flown, verdict in zip(self._flown, verdicts, strict=True)
        )
        self.flight_test = self._decided(history, self._still_heard)

    def _note_revisions(self) -> None:
        """Note each verdict that differs from the one that the crew heard. A decision by hand is no such
        change."""
        newest = self._flown[-1].maneuver.number if self._flown else 0
        for flown, before, after in zip(self._flown, self._spoken, self.judged, strict=False):
            same = before.excluded_because == after.excluded_because
            if same and (said := revision(before.verdict, after.verdict, newest)):
                flown.revisions = (*flown.revisions, said)
                self._revised.append(f"manoeuvre {flown.maneuver.number}: {said}")
        if self._revised:
            self.judged = tuple(
                flown.judged(judged.verdict) for flown, judged in zip(self._flown, self.judged, strict=True)
            )
        self._spoken = self.judged

    def take_revisions(self) -> tuple[str, ...]:
        """Return the sentences about changed verdicts since the last call."""
        said, self._revised = tuple(self._revised), []
        return said

    def _unjudged(self, part: FailedPart) -> None:
        """Accept no manoeuvre after a failed part, and continue."""
        why = objection(part)
        verdict = ManeuverVerdict(False, why.text, (why,), {})
        self.judged = tuple(flown.judged(verdict) for flown in self._flown)
        self.flight_test = self._decided((), ())
