"""Logs as one campaign and as complete power-ons, with the flights that are left out."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis.marks_file import LogSeries
from advisor.campaign.campaign import Campaign
from advisor.campaign.state import NOTHING, OF_ELEVATOR, ByHand, CampaignState
from advisor.flight.maneuvers.marks import Mark
from advisor.flight.signals.messages import Columns
from advisor.flight.signals.track import PowerOn
from advisor.flight.stream.flights import FlightHeard
from advisor.flight.stream.stream import FlightStream
from advisor.words.problems import Problem, UnusableInputError

Axis = Literal["pitch", "lateral", "both"]


@dataclass(frozen=True, slots=True)
class WholeFlights:
    """Logs of one campaign: its results, and every sample."""

    logs: tuple[Path, ...]
    """Logs in the order of their flights."""
    names: tuple[str, ...]
    """Name of each log."""
    order_said: str
    """Sentence on the order of the logs if it differs from the given order; else empty."""
    by_hand: ByHand
    """The engineer's decisions by hand on the logs."""
    state: CampaignState
    """State of the campaign at the end of the logs, as in ``advisor analyze``."""
    left_out: Mapping[int, tuple[Problem, ...]]
    """Reasons for which the log of a flight is not used, by the number of the flight."""
    power_ons: tuple[tuple[int, PowerOn], ...]
    """Every power-on with the number of its flight, 0 for the first flight. The list is empty for the lateral
    axis alone.
    """

    @property
    def said(self) -> list[str]:
        """Sentences on the order of the logs and on logs that are not used."""
        problems = [p.about(self.names[flight]) for flight, several in self.left_out.items() for p in several]
        failed = [part.sentence for part in self.state.failed]
        return [*([self.order_said] if self.order_said else []), *problems, *failed]

    @property
    def notes(self) -> list[str]:
        """Sentences on the logs, and on assumptions made in reading them."""
        state = self.state
        notes = (*self.said, *state.elevator_notes, *state.reader_notes, *state.mark_notes)
        return list(dict.fromkeys(notes))


def read_whole(
    logs: Sequence[Path],
    aircraft: Aircraft,
    target_system: int | None = None,
    marks: Sequence[Mark] = (),
    *,
    no_marks: bool = False,
    axis: Axis = "pitch",
    untested: bool = False,
) -> WholeFlights:
    """Read and analyze logs as one campaign, and keep every sample of their channels.

    Parameters
    ----------
    axis
        ``lateral`` keeps no samples, and estimates all manoeuvres jointly only at the end.
    target_system
        System id of the vehicle; None for the first vehicle that sends.
    marks
        Further stretches marked as manoeuvres, on a single log.
    no_marks
        Whether to ignore earlier decisions by hand on the logs.
    untested
        Whether logs without a test input are returned instead of refused.

    Raises
    ------
    UnusableInputError
        No log can be used. The error lists the reasons.
    ConfigurationError
        The file of decisions by hand that belongs to a log is wrong.
    """
    series = LogSeries(logs, aircraft.columns)
    by_hand = NOTHING if no_marks else series.read_by_hand()

    def begin() -> tuple[Campaign, dict[int, FlightStream]]:
        campaign = Campaign(
            aircraft, target_system, by_hand=by_hand, marks=marks, names=series.names,
            lateral=axis != "pitch", advises=axis != "lateral",
        )  # fmt: skip
        return campaign, {}

    def feed(heard: tuple[Campaign, dict[int, FlightStream]], columns: list[Columns]) -> None:
        campaign, streams = heard
        campaign.feed(columns)
        if axis == "lateral":
            return
        flight = columns[0].flight if columns else 0
        if flight not in streams:
            marked = [mark for mark in (*marks, *by_hand.marks) if mark.flight == flight]
            streams[flight] = FlightStream(aircraft, target_system, marked, keep_all=True)
        streams[flight].feed(columns)

    campaign, streams = series.fed_to(begin, feed)
    left_out: dict[int, tuple[Problem, ...]] = {
        flight: (problem,) for flight, problem in series.unreadable.items()
    }
    if len(left_out) < len(series.logs):
        campaign.finish()
        left_out |= left_out_of(axis, campaign.state)
    left_out = dict(sorted(left_out.items()))
    if len(left_out) == len(series.logs) and not (untested and holds_no_test(left_out)):
        raise UnusableInputError.of([problem for several in left_out.values() for problem in several])
    for stream in streams.values():
        stream.finish()
    power_ons = [(flight, boot) for flight, stream in sorted(streams.items()) for boot in stream.power_ons]
    return WholeFlights(
        logs=tuple(series.logs),
        names=tuple(series.names),
        order_said=series.order_said,
        by_hand=by_hand,
        state=campaign.state,
        left_out=left_out,
        power_ons=tuple(p for p in power_ons if p[1].channels),
    )


def left_out_of(axis: Axis, state: CampaignState) -> dict[int, tuple[Problem, ...]]:
    """Return the flights that are not used, each with its problems.

    A flight with an accepted lateral manoeuvre does not need the elevator's messages.
    """
    left_out = {log.flight: log.problems for log in state.flights if log.problems}
    if state.lateral is None:
        return left_out
    tested = {m.maneuver.flight for m in state.lateral.maneuvers if axis == "lateral" or m.verdict.accepted}
    elsewhere = {
        flight: problems
        for flight, problems in left_out.items()
        if not all(p.code in OF_ELEVATOR for p in problems)
    }
    if axis == "lateral":
        silent = [log for log in state.flights if log.flight not in tested and log.flight not in elsewhere]
        return elsewhere | {log.flight: (no_lateral(log),) for log in silent}
    return {flight: problems for flight, problems in left_out.items() if flight not in tested} | elsewhere


def holds_no_test(left_out: Mapping[int, Sequence[Problem]]) -> bool:
    """Return whether these flights are unused only because they contain no test input."""
    return bool(left_out) and all(p.code in _UNTESTED for several in left_out.values() for p in several)


_UNTESTED = frozenset({"no_maneuver", "no_aileron"})
"""Problem codes of a flight with sufficient telemetry and without a test input."""


def no_lateral(flight: FlightHeard) -> Problem:
    """Return the reason for which a flight has no lateral manoeuvre."""
    if flight.sides_unknown is not None:
        return flight.sides_unknown
    return Problem(
        "no_maneuver",
        "No test manoeuvre of the aileron or the rudder was found.",
        "Fly an aileron doublet and a rudder doublet in MANUAL, hands and feet still before and after.",
    )
