"""Axes that a diagnosis of logs can judge, and the comparison of roll and yaw with a simulator."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple, TypeVar

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import SIDE_PARAMETERS
from advisor.analysis.gap_flights import GapFlights, maneuvers_of, without_refused
from advisor.analysis.whole_flights import Axis, read_whole
from advisor.campaign.state import ByHand, CampaignState
from advisor.flight.maneuvers.maneuver import Maneuver, SideManeuverFlown
from advisor.flight.maneuvers.marks import Mark
from advisor.flight.stream.stream import FlightStream
from advisor.gap.axis.comparison import compare_axis
from advisor.gap.inference.prior import FIELD, FieldPrior
from advisor.gap.result import Diagnosis, Trace
from advisor.mavlink.logs.logs import read_whole_log
from advisor.model.axes.lateral import LATERAL
from advisor.oem.axis.estimator import estimate_axis
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.simulators.axes.side_difference import side_without_difference
from advisor.simulators.protocol import Progress
from advisor.simulators.specification import simulator_of
from advisor.words.problems import ConfigurationError, UnusableInputError


@dataclass(frozen=True)
class SideCompared:
    """Gap of roll and yaw, with the flight from which it was found."""

    diagnosis: Diagnosis
    state: CampaignState
    """State of the campaign at the end of the logs, with both axes."""
    aircraft: Aircraft
    """The aircraft file."""
    maneuvers: Sequence[Maneuver] = ()
    """Accepted lateral manoeuvres, as flown."""


def compare_side_flown(
    state: CampaignState, aircraft: Aircraft, prior: FieldPrior = FIELD, progress: Progress = lambda *_: None
) -> SideCompared:
    """Compare a flight with roll and yaw of the aircraft file, or of its simulator.

    Raises
    ------
    ConfigurationError
        The file's simulator cannot be built.
    UnusableInputError
        No manoeuvre of aileron or rudder is accepted, or the simulator does not fly them.
    """
    accepted = accepted_of(state)
    compared, against = beside_simulator(accepted, aircraft, progress)
    progress("comparing", 1.0)
    assert state.lateral is not None
    as_logged = compared is accepted and against is aircraft
    diagnosis = answered(compare_axis(LATERAL, compared, against, prior, state.lateral.model, as_logged))
    diagnosis = replace(diagnosis, traces=side_traces(diagnosis.traces, accepted, compared))
    return SideCompared(diagnosis, state, aircraft, accepted)


def side_traces(
    traces: Sequence[Trace], flown: Sequence[Maneuver], compared: Sequence[Maneuver]
) -> tuple[Trace, ...]:
    """Return the curves of every output and manoeuvre, with the part of a user's simulator that its surrogate
    lacks.

    Parameters
    ----------
    traces
        Curves of the compared manoeuvres.
    flown
        Manoeuvres as logged.
    compared
        Manoeuvres of the diagnosis, which lack the part of the simulator beyond its surrogate.
    """

    def whole(trace: Trace) -> Trace:
        logged, without = (
            next(m.channels[trace.channel] for m in maneuvers if m.number == trace.number)
            for maneuvers in (flown, compared)
        )
        lost = np.interp(trace.t, logged.t, logged.y - without.y)
        curves = {name: getattr(trace, name) + lost for name in ("measured", "before", "after")}
        return replace(trace, **curves)

    return tuple(map(whole, traces))


def beside_simulator(
    maneuvers: Sequence[Maneuver], aircraft: Aircraft, progress: Progress = lambda *_: None
) -> tuple[Sequence[Maneuver], Aircraft]:
    """Return manoeuvres without the difference between the file's simulator and its surrogate, and the
    surrogate.

    The model of the aircraft file is its own surrogate, as is the model that a simulator's log shows.
    """
    kind, _, rest = (aircraft.simulator or "linear").partition(":")
    if kind == "log":
        return maneuvers, _identified(Path(rest), aircraft)
    if kind == "linear":
        return maneuvers, aircraft
    simulator = simulator_of(str(aircraft.simulator), aircraft, lambda _: [])
    try:
        return side_without_difference(maneuvers, simulator, aircraft, progress)
    finally:
        simulator.close()


def accepted_of(state: CampaignState) -> list[Maneuver]:
    """Return the accepted manoeuvres of aileron and rudder."""
    lateral = state.lateral
    assert lateral is not None
    accepted = [judged.maneuver for judged in lateral.maneuvers if judged.verdict.accepted]
    if not accepted:
        raise UnusableInputError(
            "no_accepted",
            "No manoeuvre of the aileron or the rudder is accepted.",
            "advisor analyze --axis lateral gives the reason for each of them.",
        )
    return accepted


def _identified(log: Path, aircraft: Aircraft) -> Aircraft:
    """Return the aircraft file with the derivatives identified from a simulator's log."""
    if not log.is_file():
        raise ConfigurationError(f"--simulator log:{log}: there is no such file; name the simulator's log.")
    flown = accepted_of(read_whole([log], aircraft, no_marks=True, axis="lateral").state)
    estimate = answered(estimate_axis(LATERAL, flown, aircraft))
    return with_derivatives(aircraft, estimate, estimate.airspeed_m_s)


def with_derivatives(aircraft: Aircraft, estimate: Estimate, airspeed_m_s: float | None) -> Aircraft:
    """Return the aircraft file with the identifiable derivatives of an estimate, at a given air speed."""
    values = zip(SIDE_PARAMETERS, estimate.theta.tolist(), strict=True)
    model = {name: value for name, value in values if name not in estimate.not_identifiable}
    return replace(aircraft, model=model, reference_airspeed_m_s=airspeed_m_s)


_Answer = TypeVar("_Answer")


def answered(
    answer: _Answer | NoEstimate, fix: str = "Fly an aileron doublet and a rudder doublet.", option: str = ""
) -> _Answer:
    """Return the gap found, or refuse manoeuvres without one; ``option`` begins the message."""
    if isinstance(answer, NoEstimate):
        raise UnusableInputError(answer.code, f"{option}{answer.text}", fix)
    return answer


class AxisFlown(NamedTuple):
    """Axes that a diagnosis of the logs can judge, with the data that were read for this choice."""

    axis: Axis
    elevator: GapFlights | None
    """Manoeuvres of the elevator, if they can be read."""
    state: CampaignState | None = None
    """State of the campaign with both axes, if roll and yaw have an accepted manoeuvre."""


def axis_flown(
    logs: Sequence[Path],
    aircraft: Aircraft,
    target_system: int | None = None,
    by_hand: Sequence[ByHand] = (),
    marks: Sequence[Mark] = (),
    no_marks: bool = False,
) -> AxisFlown:
    """Return the axes with an accepted manoeuvre, and the data that were read.

    Without an accepted manoeuvre, the axis is pitch.
    """
    flown = None
    is_pitch = sideways = False
    try:
        flown = maneuvers_of(logs, aircraft, target_system, by_hand, lateral=True)
        sideways = flown.lateral
        if sideways:
            # An input of all controls at once has other ends where roll and yaw are looked for.
            flown = maneuvers_of(logs, aircraft, target_system, by_hand)
        chosen = without_refused(flown.maneuvers, aircraft)
        is_pitch = len(chosen.although_refused) < len(chosen.maneuvers)
    except UnusableInputError:
        pass  # The diagnosis of pitch gives the reason, where roll and yaw have no manoeuvre either.
    try:
        if is_pitch and not sideways:
            return AxisFlown("pitch", flown)
        state = read_whole(logs, aircraft, target_system, marks, no_marks=no_marks, axis="lateral").state
        accepted_of(state)
    except UnusableInputError:
        return AxisFlown("pitch", flown)
    return AxisFlown("both" if is_pitch else "lateral", flown, state)


def flies_roll_or_yaw(
    log: Path, aircraft: Aircraft, target_system: int | None, marks: Sequence[Mark]
) -> bool:
    """Return whether a log holds a manoeuvre of aileron or rudder, without an analysis of the campaign."""
    stream = FlightStream(aircraft, target_system, marks, lateral=True)
    events = [
        event for columns in read_whole_log(log, columns=aircraft.columns) for event in stream.feed(columns)
    ]
    return any(isinstance(event, SideManeuverFlown) for event in (*events, *stream.finish()))
