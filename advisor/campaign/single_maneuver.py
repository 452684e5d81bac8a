"""One manoeuvre alone, while it is flown and after: estimate, objections, cautions, and contradicted
instruments.

While a manoeuvre is flown, the samples up to each whole second after its begin count, once all channels have
arrived. A replay therefore shows the values of the flight.
"""

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from math import ceil, floor
from typing import Any

from advisor.aircraft.aircraft import Aircraft
from advisor.campaign.state import AxisState, LateralState
from advisor.decision.arriving import FIRST_S, Arriving
from advisor.decision.arriving_errors import Known, arriving, up_to
from advisor.decision.axes.lateral_stop import JUDGED, shares_of
from advisor.decision.axes.requirements import judge
from advisor.decision.envelope import is_speed_carried, moved_controls, with_gap
from advisor.decision.first_unit import natural_period
from advisor.decision.history import CandidateManeuver
from advisor.decision.information import knowledge
from advisor.decision.verdict import FlightTestVerdict, Reason
from advisor.flight.elevator.elevator_watch import SETTLE_S
from advisor.flight.instruments.kinematics import check_alpha
from advisor.flight.maneuvers.announced import Announced
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.maneuvers.markers import MARKED
from advisor.flight.signals.trust import InstrumentFinding
from advisor.flight.stream.flights import Flights
from advisor.flight.vehicle.modes import closes_pitch_loop
from advisor.model.axes.lateral import LATERAL
from advisor.oem.axis.estimate import AxisEstimate
from advisor.oem.axis.estimator import estimate_axis
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.oem.estimator import estimate
from advisor.oem.notes import findings_of
from advisor.oem.surface import Servo
from advisor.process.aside import Aside
from advisor.process.parts import INTERNAL, FailedPart, Parts
from advisor.words.axes import AxisName
from advisor.words.quantities import NORMAL_95, symbol, with_half


def assess(maneuver: Maneuver, aircraft: Aircraft) -> CandidateManeuver:
    """Estimate a manoeuvre and examine it, before any rule compares it with other manoeuvres."""
    estimated = estimate(maneuver, aircraft)
    return CandidateManeuver(
        estimated,
        judge("pitch", maneuver, estimated, aircraft),
        tuple(cautions_of(maneuver, estimated, aircraft)),
        maneuver=maneuver,
        air_moved=isinstance(estimated, Estimate) and estimated.gust_rad is not None,
        servo=_servo(estimated, aircraft),
    )


def failed(maneuver: Maneuver, part: FailedPart) -> CandidateManeuver:
    """Return a manoeuvre whose estimate or examination was ended by a fault of the advisor."""
    return CandidateManeuver(untold(part), (objection(part),), maneuver=maneuver)


def untold(part: FailedPart) -> NoEstimate:
    """Return the missing estimate of a part that was ended by a fault of the advisor."""
    return NoEstimate(INTERNAL, str(part.problem))


def objection(part: FailedPart) -> Reason:
    """Return the reason against a manoeuvre that has no verdict because of a fault of the advisor."""
    return Reason(INTERNAL, str(part.problem), math.nan, math.nan)


def _servo(estimated: Estimate | NoEstimate, aircraft: Aircraft) -> Servo:
    """Return the servo of the estimate, from the aircraft file or identified from the record."""
    lag_s = aircraft.elevator.lag_s or 0.0
    if isinstance(estimated, Estimate):
        lag_s = estimated.servo_lag_s
    return Servo(lag_s, aircraft.elevator.delay_s or 0.0)


def cautions_of(maneuver: Maneuver, estimated: Estimate | NoEstimate, aircraft: Aircraft) -> list[str]:
    """Return cautions for the reader of an estimate. These cautions have no effect on the verdict."""
    cautions = list(maneuver.data_notes)
    if maneuver.span.closed_by in MARKED.values():
        cautions.append(maneuver.span.closed_by)
    if closes_pitch_loop(maneuver.mode):
        cautions.append(
            f"flown in {maneuver.mode} with the pitch loop closed: elevator, angle of attack and pitch rate "
            "move together and are hard to distinguish"
        )
    if not isinstance(estimated, Estimate):
        return cautions
    cautions += _carried_speed(maneuver, estimated, aircraft)
    alpha = maneuver.channels.get("alpha")
    if alpha is not None and "alpha" in estimated.outputs:
        cautions.append(f"angle of attack: {alpha.provenance}, from {alpha.source}")
        cautions += _uncertain_alpha(maneuver, estimated, aircraft)
    if estimated.gust_rad is not None and _shows(estimated, estimated.gust_rad):
        cautions.append(_moving_air(estimated, estimated.gust_rad))
    return cautions


def _shows(estimated: Estimate, gust_rad: float) -> bool:
    """Return whether the gusts differ from zero in the digits that people read."""
    size = math.degrees(gust_rad) if estimated.airspeed_m_s is None else gust_rad * estimated.airspeed_m_s
    return round(size, 1) > 0.0


def _uncertain_alpha(maneuver: Maneuver, estimated: Estimate, aircraft: Aircraft) -> list[str]:
    """Return doubts about the angle of attack that the fit does not consider, from kinematics."""
    if estimated.instrument("vane_arm_m") or estimated.instrument("alpha_delay_s"):
        return []
    check = check_alpha(
        maneuver, aircraft.airspeed_m_s, aircraft.accelerometer.arm_m, aircraft.alpha.vane_arm_m
    )
    return [] if check.finding == "consistent" else [check.sentence]


def _carried_speed(maneuver: Maneuver, estimated: Estimate, aircraft: Aircraft) -> list[str]:
    """Return a sentence about an air speed that the accelerometers carry across a gap of its sensor."""
    channel = maneuver.channels.get("airspeed")
    if channel is None or aircraft.airspeed_m_s is not None or not is_speed_carried(maneuver):
        return []
    gaps = with_gap([channel], maneuver, natural_period(maneuver, estimated))
    return [f"{gap.fact}: its changes there are integrated from the accelerometers" for gap in gaps]


def _moving_air(estimated: Estimate, gust_rad: float) -> str:
    size = f"{math.degrees(gust_rad):.1f} deg"
    if estimated.airspeed_m_s is not None:
        size += f" ({gust_rad * estimated.airspeed_m_s:.1f} m/s)"
    how = (
        "filter error takes this into account"
        if estimated.filtered
        else "filter error failed, so output error is used"
    )
    return f"moving air, gusts of {size}: {how}"


def as_known_by(maneuver: Maneuver, newest: Maneuver) -> Maneuver:
    """Return a manoeuvre with the instruments' contradictions that a later one of its power-on shows.

    A contradiction that only later manoeuvres show was not removed from the earlier manoeuvre's channels.
    """
    removed = {f.code for f in maneuver.findings if f.used}
    findings = tuple(f if f.code in removed else replace(f, used=False) for f in newest.findings)
    if maneuver.power_on != newest.power_on or _codes(findings) == _codes(maneuver.findings):
        return maneuver
    return replace(maneuver, findings=findings)


def together(
    maneuvers: Iterable[Maneuver], before_flying: Iterable[InstrumentFinding]
) -> tuple[InstrumentFinding, ...]:
    """Return each contradiction once, with the values from the newest manoeuvre that shows it."""
    by_code = {f.code: f for f in before_flying}
    for maneuver in maneuvers:
        frozen = (d.finding for d in maneuver.distrusts if d.left_out or d.stops)
        by_code |= {f.code: f for f in (*maneuver.findings, *frozen)}
    return tuple(by_code.values())


def with_fit(
    by_motion: Iterable[InstrumentFinding],
    model: Estimate | None,
    single: Iterable[Estimate | NoEstimate],
    aircraft: Aircraft,
) -> tuple[InstrumentFinding, ...]:
    """Return the findings of the motion, then the fit's findings on properties that the motion does not
    determine.

    Parameters
    ----------
    by_motion
        Findings from the motion alone, without aerodynamics.
    model
        Joint estimate over the accepted manoeuvres. The estimate's findings are in use.
    single
        Estimates of all manoeuvres. Findings of single estimates refuse manoeuvres.
    """
    by_code = {f.code: f for f in by_motion}
    findings = [] if model is None else list(findings_of(model, aircraft))
    for own in single:
        if isinstance(own, Estimate):
            findings += [f for f in findings_of(own, aircraft) if f.refuses]
    for finding in findings:
        by_code.setdefault(finding.code, finding)
    return tuple(by_code.values())


def side_signs(model: AxisEstimate | None, aircraft: Aircraft) -> tuple[InstrumentFinding, ...]:
    """Return the direction in which positive aileron rolls and positive rudder yaws, if the motion determines
    the direction.

    By definition a positive deflection is to the left. Without a calibration nothing states the direction;
    the derivatives then have the sign that the parameters of the outputs give. The channels keep the log's
    sign where the motion contradicts that sign.
    """
    findings = []
    for control, name, moves in (("aileron", "L_delta_a", "rolls"), ("rudder", "N_delta_r", "yaws")):
        if model is None or name in model.not_identifiable:
            continue
        value = model.value(name)
        half = NORMAL_95 * float(model.std[model.names.index(name)])
        if not half < abs(value):
            continue
        stated = getattr(aircraft, control).calibration is not None
        side, wrong = ("left", False) if value < 0.0 else ("right", True)
        shown = f"a positive one {moves} to the {side} ({symbol(name)} {with_half(value, half)})"
        text = f"{control}.calibration states the sign: {shown}"
        if not stated:
            text = f"no {control}.calibration states the sign of the {control}: {shown}"
        if wrong:
            text += "; a positive deflection should be to the left; the derivatives keep this sign"
        findings.append(
            InstrumentFinding(
                control,
                "sign",
                "left" if stated else None,
                side,
                contradicts=wrong,
                text=text,
                fix=f"give {control}.calibration with positive to the left" if wrong else "",
                used=wrong,
            )
        )
    return tuple(findings)


def _codes(findings: Iterable[InstrumentFinding]) -> set[tuple[str, bool]]:
    return {(f.code, f.refuses) for f in findings}


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
