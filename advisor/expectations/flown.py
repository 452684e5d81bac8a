"""Results of a flight, as far as an expectations file can ask for them, from the analysis of its log."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from math import nan

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import PARAMETERS, SIDE_PARAMETERS
from advisor.analysis.axis_flown import compare_side_flown
from advisor.analysis.gap import compare_logs
from advisor.analysis.whole_flights import WholeFlights
from advisor.campaign.state import CampaignState
from advisor.decision.axes.lateral_requirements import GROUPS
from advisor.decision.verdict import FlightTestVerdict
from advisor.expectations.read import MODES
from advisor.flight.signals.track import true_over_read
from advisor.model.axes.lateral import Trim
from advisor.model.mil_f_8785c import LevelFound
from advisor.oem.estimate import Estimate
from advisor.oem.flying_qualities import Quality
from advisor.report.qualities import levels_of, qualities_of, trim_of
from advisor.simulators.protocol import Progress
from advisor.words.axes import AxisName
from advisor.words.problems import UnusableInputError

_SHORT_PERIOD = {"short_period_omega": "natural_frequency", "short_period_zeta": "damping"}
"""Name of a flying quality of pitch, by the key of the mode in the file."""


@dataclass(frozen=True, slots=True)
class Measured:
    """One number of a flight, SI, or the reason why the flight does not show the number."""

    value: float = nan
    std: float = nan
    """Standard deviation, SI; NaN for a number without an error."""
    reason: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Flown:
    """Results of one flight, by the keys of an expectations file."""

    accepted: Mapping[AxisName, int]
    """Number of accepted manoeuvres."""
    tests: Mapping[AxisName, FlightTestVerdict]
    """Verdict on the flight test."""
    derivatives: Mapping[str, Measured]
    modes: Mapping[str, Measured]
    levels: Mapping[AxisName, tuple[LevelFound, ...]]
    """Levels of flying qualities; those of roll and yaw are of light aircraft."""
    pauses_s: Mapping[str, float]
    """Longest pause between two samples, s, by channel."""
    alarms: tuple[str, ...]
    """Warnings of the flight test, contradicted instruments, and parts of the analysis that failed."""
    gap: Mapping[AxisName, Measured] = field(default_factory=dict)
    """Gap of the simulator as given. Empty unless the gap was diagnosed."""
    trim: Trim | None = None
    """Steady flight of the lateral manoeuvres; None without an estimate."""
    airspeeds_m_s: Mapping[AxisName, float] = field(default_factory=dict)
    """True air speed of the joint estimate, m/s, by axis; an axis without a measured air speed is absent."""
    true_over_read: float = 1.0
    """Ratio of the true air speed to the air speed that the aircraft reads."""


def flown_of(flights: WholeFlights, aircraft: Aircraft, gap: Mapping[AxisName, Measured]) -> Flown:
    """Return the results of the flight of one log."""
    state, side = flights.state, flights.state.lateral
    qualities = qualities_of(state, aircraft.reference)
    levels: dict[AxisName, tuple[LevelFound, ...]] = {"pitch": qualities.levels if qualities else ()}
    derivatives = _derivatives(state.model, PARAMETERS, "no manoeuvre of the elevator is accepted")
    modes = dict(_modes(state, aircraft))
    trim = None
    if side is not None:
        light = next(iter(GROUPS))
        levels["lateral"] = tuple(rated.governing for rated in levels_of(side) if rated.group == light)
        none = "no manoeuvre of the aileron or the rudder is accepted"
        derivatives |= _derivatives(side.model, SIDE_PARAMETERS, none)
        if side.model is not None:
            joined = [m.maneuver for m in side.maneuvers if m.maneuver.number in side.estimate_from]
            trim = trim_of(joined, side.model.airspeed_m_s or nan)
    heard = {name: status for flight in state.flights for name, status in flight.channels.items()}
    judged = [m for axis in state.axes.values() for m in axis.maneuvers]
    return Flown(
        accepted={name: sum(j.verdict.accepted for j in axis.maneuvers) for name, axis in state.axes.items()},
        tests={name: axis.flight_test for name, axis in state.axes.items()},
        derivatives=derivatives,
        modes=modes,
        levels=levels,
        pauses_s={name: status.largest_gap_s for name, status in heard.items()},
        alarms=tuple(_alarms(state)),
        gap=gap,
        trim=trim,
        airspeeds_m_s={
            name: axis.model.airspeed_m_s
            for name, axis in state.axes.items()
            if axis.model and axis.model.airspeed_m_s
        },
        true_over_read=true_over_read(m.maneuver.channels for m in judged),
    )


def _derivatives(model: Estimate | None, names: tuple[str, ...], none: str) -> dict[str, Measured]:
    if model is None:
        return {name: Measured(reason=none) for name in names}
    numbers = zip(model.names, model.theta.tolist(), model.std.tolist(), strict=True)
    return {
        name: Measured(reason=model.not_identifiable[name])
        if name in model.not_identifiable
        else Measured(value, std)
        for name, value, std in numbers
    }


def _modes(state: CampaignState, aircraft: Aircraft) -> Iterator[tuple[str, Measured]]:
    pitch = qualities_of(state, aircraft.reference)
    side = state.lateral.model if state.lateral is not None else None
    for key in MODES:
        if key in _SHORT_PERIOD:
            name = _SHORT_PERIOD[key]
            quality = pitch.qualities.get(name) if pitch else None
            reason = pitch.left_out.get(name, "") if pitch else "no manoeuvre of the elevator is accepted"
        else:
            quality = side.modes.get(key) if side else None
            mode = next((mode for mode in side.modes_left_out if key.startswith(mode)), "") if side else ""
            reason = "no manoeuvre of the aileron or the rudder is accepted"
            reason = side.modes_left_out.get(mode, "the flight does not show this mode") if side else reason
        yield key, _measured(quality, reason)


def _measured(quality: Quality | None, reason: str) -> Measured:
    return Measured(reason=reason) if quality is None else Measured(quality.value, quality.std)


def _alarms(state: CampaignState) -> Iterator[str]:
    yield from (warning for axis in state.axes.values() for warning in axis.flight_test.warnings)
    yield from (finding.text for finding in state.instruments if finding.contradicts)
    yield from (failure.sentence for failure in state.failed)


def gap_of(
    axis: AxisName, flights: WholeFlights, aircraft: Aircraft, target_system: int | None, progress: Progress
) -> Measured:
    """Return the gap of the aircraft file's simulator on one axis, or the reason why there is none.

    Raises
    ------
    ConfigurationError
        The file's simulator cannot be built.
    """
    try:
        if axis == "lateral":
            diagnosis = compare_side_flown(flights.state, aircraft, progress=progress).diagnosis
        else:
            decided = [flights.by_hand.on_flight(flight) for flight in range(len(flights.logs))]
            compared = compare_logs(flights.logs, aircraft, None, target_system, progress, decided)
            diagnosis = compared.diagnosis
    except UnusableInputError as error:
        return Measured(reason=str(error))
    gap = diagnosis.gap
    return Measured(gap.before) if gap.by_channel else Measured(reason="the manoeuvres show no gap")
