"""The campaign of an axis: its manoeuvres, their verdicts, the joint estimate, and the engineer's
decisions on them.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

from advisor.aircraft.aircraft import Aircraft, CampaignPlan
from advisor.campaign.joint_estimate import NEWEST, Together, lag_said, may_learn, of_another_power_on
from advisor.campaign.joint_estimate import learnt as learnt_from
from advisor.campaign.single_maneuver import as_known_by, assess, failed, objection, untold
from advisor.campaign.state import ByHand, JudgedManeuver, LateralState
from advisor.decision.axes.lateral_stop import JUDGED, FlownInput, lateral_flight_test
from advisor.decision.axes.requirements import judge, responses_of
from advisor.decision.change import find_change
from advisor.decision.history import CandidateManeuver, Heard, revision
from advisor.decision.information import CriterionCourse
from advisor.decision.judge import judge_campaign
from advisor.decision.stopping import flight_test
from advisor.decision.verdict import FlightTestVerdict, ManeuverVerdict
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.model.axes.lateral import LATERAL
from advisor.oem.axis.estimate import AxisEstimate
from advisor.oem.axis.estimator import JointSearch, estimate_axis
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.process.parts import FailedPart, Parts
from advisor.words.axes import AxisName
from advisor.words.problems import Problem


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
