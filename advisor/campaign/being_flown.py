"""The input that is being flown, for live faces: its errors, and the word that it is enough.

The samples up to each whole second after the begin count, once all channels have arrived. A replay therefore
shows the values of the flight.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from math import ceil, floor
from typing import Any

from advisor.aircraft.aircraft import Aircraft
from advisor.campaign.state import AxisState, LateralState
from advisor.decision.arriving import FIRST_S, Arriving
from advisor.decision.arriving_errors import Known, arriving, up_to
from advisor.decision.axes.lateral_stop import JUDGED, shares_of
from advisor.decision.envelope import moved_controls
from advisor.decision.history import CandidateManeuver
from advisor.decision.information import knowledge
from advisor.decision.verdict import FlightTestVerdict
from advisor.flight.elevator.elevator_watch import SETTLE_S
from advisor.flight.maneuvers.announced import Announced
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.stream.flights import Flights
from advisor.model.axes.lateral import LATERAL
from advisor.oem.axis.estimator import estimate_axis
from advisor.oem.estimate import Estimate
from advisor.oem.estimator import estimate
from advisor.process.aside import Aside
from advisor.process.parts import Parts
from advisor.words.axes import AxisName

_LONGER = 2
"""Factor on the length of an input's data before the input is estimated anew. All estimates of an input
together then cost at most twice the last one."""


class ArrivingInformation:
    """Computes the information of the input being flown once for each second."""

    def __init__(self, aircraft: Aircraft) -> None:
        self._aircraft = aircraft
        self._at: tuple[float, int] | None = None
        self._newest: Arriving | None = None
        self._alone: dict[AxisName, Known] = {}

    def follow(
        self,
        flying: Maneuver | None,
        model: Estimate | None,
        flight_test: FlightTestVerdict,
        lateral: LateralState | None,
    ) -> Arriving | None:
        """Return the errors with the samples so far; None before the first oscillation and between inputs."""
        if flying is None:
            self._begin(None)
            return None
        begun_s = flying.span.start_s
        seconds = floor(flying.span.end_s - SETTLE_S - begun_s)
        if seconds < FIRST_S:
            return None
        joint: dict[AxisName, Known] = {"pitch": Known(model, _percent(flight_test))}
        if lateral is not None:
            joint["lateral"] = Known(lateral.model, _percent(lateral.flight_test))
        if self._at is None or self._at[0] != begun_s:
            self._begin((begun_s, ceil(FIRST_S) - 1))
        assert self._at is not None
        # Estimates of the input alone follow from each other, so that no second may be left out.
        follows = any(side.model is None for side in joint.values())
        for second in range(self._at[1] + 1 if follows else max(self._at[1] + 1, seconds), seconds + 1):
            self._at = begun_s, second
            self._newest = self._after(second, flying, joint)
        return self._newest

    def is_due(self, now_s: float) -> bool:
        """Return whether another whole second of an input may have arrived at a time, s since boot."""
        return self._at is None or now_s - SETTLE_S >= self._at[0] + self._at[1] + 1

    def _begin(self, at: tuple[float, int] | None) -> None:
        self._at, self._newest = at, None
        self._alone.clear()

    def _after(self, second: int, flying: Maneuver, joint: Mapping[AxisName, Known]) -> Arriving:
        """Return the errors after a whole second of an input."""
        until_s = flying.span.start_s + second
        arrived = arriving(flying, until_s, *self._known(joint, second, flying, _LONGER))
        if arrived.is_enough and self._alone:
            # Added information leaves out what one input has in common, such as its servo's lag.
            arrived = arriving(flying, until_s, *self._known(joint, second, flying, 1))
        return arrived

    def _known(
        self, joint: Mapping[AxisName, Known], second: int, flying: Maneuver, longer: int
    ) -> tuple[Known, Known]:
        """Return the joint estimate of each axis. A moved axis without a joint estimate gets the estimate of
        the input alone.
        """
        by_axis: dict[AxisName, Known] = dict(joint)
        begun_s, until_s = flying.span.start_s, flying.span.start_s + second
        cut = up_to(until_s, flying)
        moved = {"pitch" if control == "elevator" else "lateral" for control in moved_controls(cut)}
        for axis in [axis for axis, before in joint.items() if before.model is None and axis in moved]:
            estimated = self._alone.get(axis)
            if estimated is None or until_s - begun_s >= longer * (estimated.since_s - begun_s):
                alone = self._pitch(cut) if axis == "pitch" else self._side(cut)
                self._alone[axis] = Known(*alone, until_s)
            by_axis[axis] = self._alone[axis]
        return by_axis["pitch"], by_axis.get("lateral", Known(None, {}))

    def _pitch(self, cut: Maneuver) -> tuple[Estimate | None, dict[str, float | None]]:
        plan, alone = self._aircraft.campaign, estimate(cut, self._aircraft)
        if not isinstance(alone, Estimate):
            return None, dict.fromkeys(plan.parameters)
        share = knowledge([CandidateManeuver(alone, maneuver=cut)], plan).share
        return alone, {name: _finite(100.0 * share[name]) for name in plan.parameters}

    def _side(self, cut: Maneuver) -> tuple[Estimate | None, dict[str, float | None]]:
        alone = estimate_axis(LATERAL, [cut], self._aircraft)
        if not isinstance(alone, Estimate):
            return None, dict.fromkeys(JUDGED)
        shares = shares_of(alone, self._aircraft.campaign.tolerance_percent)
        return alone, {name: _finite(share) for name, share in shares.items()}


def _finite(share: float) -> float | None:
    return share if share < float("inf") else None


def _percent(verdict: FlightTestVerdict) -> dict[str, float | None]:
    """Return the error of each judged derivative, % of its tolerance."""
    progress = verdict.by_rule.get("information")
    return {} if progress is None else dict(progress.parameter_percent)


Axes = Callable[[], Mapping[AxisName, AxisState[Any]]]
"""Function that returns the state of each axis before the input."""


@dataclass(frozen=True, slots=True)
class InputEnough:
    """The data of a multisine that a script flies are enough: the script may end it."""

    number: int
    """Number of the input in the script's texts."""


class BeingFlown:
    """Computes what is known of the input that is being flown. No verdict depends on it.

    Parameters
    ----------
    informs
        Whether the information of the input is computed.
    aside
        Compute the information in another thread.
    """

    def __init__(
        self, aircraft: Aircraft, flights: Flights, parts: Parts, informs: bool, aside: bool
    ) -> None:
        self._flights, self._parts = flights, parts
        self._information = ArrivingInformation(aircraft) if informs else None
        self._computing: Aside[Arriving | None] = Aside(aside)
        self._newest: Arriving | None = None
        self._heard_enough: Announced | None = None

    def arrived(self, flying: Maneuver | None, axes: Axes | None) -> Arriving | None:
        """Return the errors with the information of the input.

        They add to the estimate of all manoeuvres before. ``axes`` is None while one of these is being
        judged.
        """
        information = self._information
        if information is None or axes is None:
            return None
        if not self._computing.is_busy and (flying is None or information.is_due(self._flights.stream.now_s)):
            before = axes()
            pitch, side = before["pitch"], before.get("lateral")
            follow = partial(information.follow, flying, pitch.model, pitch.flight_test, side)
            part = "information of the manoeuvre being flown"
            self._computing.do(lambda: self._parts.make(part, follow, lambda _: None))
        for arrived in self._computing.made():
            self._newest = arrived
        newest = self._newest
        of_earlier = newest is None or flying is None or newest.until_s < flying.span.start_s
        return None if of_earlier else newest

    def enough(self, axes: Axes | None) -> InputEnough | None:
        """Return the event of a multisine of a script whose data have become enough; None else."""
        stream = self._flights.stream
        flown = stream.marks.announced_now
        if flown is None or flown.input != "multisine" or self._information is None:
            self._heard_enough = None
            return None
        if flown == self._heard_enough or not self._information.is_due(stream.now_s):
            return None
        arrived = self.arrived(self._flights.so_far(), axes)
        if arrived is None or not arrived.is_enough:
            return None
        self._heard_enough = flown
        return InputEnough(flown.number)
