"""From logs to the dataset of an export: each log heard once, by the campaign and as whole power-ons."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from advisor import __version__
from advisor.aircraft import Aircraft
from advisor.campaign.campaign import Campaign
from advisor.campaign.hand_decisions import NOTHING
from advisor.campaign.state import CampaignState
from advisor.exporting.found import estimates, maneuvers, residuals
from advisor.exporting.grid import GRID, on_one_grid
from advisor.exporting.table import Column, Dataset, Recording, Table, numbers, texts
from advisor.flight.marks import Mark
from advisor.flight.power_on import PowerOn
from advisor.flight.record import ALL_UNITS
from advisor.flight.stream import FlightStream
from advisor.log_series import LogSeries
from advisor.problems import UnusableInputError


@dataclass(frozen=True, slots=True)
class WholeFlights:
    """Logs of one campaign: what was found, and every sample."""

    logs: tuple[Path, ...]
    """Flight by flight, in the order in which they count."""
    state: CampaignState
    """The campaign at the end of the logs, as ``advisor analyze`` has it."""
    power_ons: tuple[tuple[int, PowerOn], ...]
    """Every power-on with the number of its flight, 0 for the first."""
    notes: tuple[str, ...]
    """Sentences on the order of the logs, on logs left out, and on what was assumed in reading."""


def read_whole(
    logs: Sequence[Path],
    aircraft: Aircraft,
    target_system: int | None = None,
    marks: Sequence[Mark] = (),
    *,
    no_marks: bool = False,
) -> WholeFlights:
    """Read and analyze logs as one campaign, and keep every sample of their channels.

    Parameters
    ----------
    logs
        Paths of the logs, a flight each.
    target_system
        System id of the vehicle; None: the first one heard.
    marks
        Further stretches that are manoeuvres, on a single log.
    no_marks
        Leave out what was decided by hand on the logs.

    Raises
    ------
    UnusableInputError
        No log can be used; the error lists why.
    ConfigurationError
        The file of decisions by hand beside a log is wrong.
    """
    series = LogSeries(logs)
    by_hand = NOTHING if no_marks else series.read_by_hand()
    campaign = Campaign(aircraft, target_system, by_hand=by_hand, marks=marks, names=series.names)
    streams: dict[int, FlightStream] = {}
    for columns in series.batches():
        campaign.feed(columns)
        flight = columns[0].flight if columns else 0
        if flight not in streams:
            marked = [mark for mark in (*marks, *by_hand.marks) if mark.flight == flight]
            streams[flight] = FlightStream(aircraft, target_system, marked, keep_all=True)
        streams[flight].feed(columns)
    unreadable = list(series.unreadable.values())
    if len(unreadable) == len(logs):
        raise UnusableInputError.of(unreadable)
    campaign.finish()
    for stream in streams.values():
        stream.finish()
    if campaign.problems:
        raise UnusableInputError.of(campaign.problems)
    state = campaign.state
    left_out = [p.about(series.names[one.flight]) for one in state.flights for p in one.problems]
    power_ons = [(flight, one) for flight, stream in sorted(streams.items()) for one in stream.power_ons]
    notes = (*series.said(), *left_out, *state.elevator_notes, *state.reader_notes, *state.mark_notes)
    return WholeFlights(
        tuple(series.logs), state, tuple(p for p in power_ons if p[1].channels), tuple(dict.fromkeys(notes))
    )


def dataset(flights: WholeFlights) -> Dataset:
    """Return everything that an export holds, as tables."""
    record_of = {
        (flight, one.boot): number for number, (flight, one) in enumerate(flights.power_ons, start=1)
    }
    state = flights.state
    tables = (
        _channels(flights),
        maneuvers(state, record_of),
        estimates(state),
        *residuals(state, record_of),
    )
    about = {
        "advisor": __version__,
        "logs": [{"file": str(log), "sha256": _sha256(log)} for log in flights.logs],
        "grid": GRID,
        "decision": state.flight_test.sentence,
        "notes": list(flights.notes),
    }
    recordings = tuple(_recording(k, one) for k, (_, one) in enumerate(flights.power_ons, start=1))
    return Dataset(recordings, tables, about)


def _recording(number: int, power_on: PowerOn) -> Recording:
    channels = tuple(
        Table(
            name,
            f"{name} at its own stamps.",
            (
                Column("t_boot_s", channel.t, "s", "vehicle time since boot"),
                Column(
                    name, channel.y, ALL_UNITS[name], f"{name} from {channel.source}, {channel.provenance}"
                ),
            ),
        )
        for name, channel in power_on.channels.items()
    )
    return Recording(f"record_{number}", channels, on_one_grid(power_on.channels))


def _channels(flights: WholeFlights) -> Table:
    rows = [
        (number, flights.logs[flight], one.boot, channel)
        for number, (flight, one) in enumerate(flights.power_ons, start=1)
        for channel in one.channels.values()
    ]
    found = [channel for *_, channel in rows]
    columns = (
        Column("record", np.array([number for number, *_ in rows], np.int64), "", "number of the record"),
        Column("log", texts([str(log) for _, log, _, _ in rows]), "", "file of the log"),
        Column("boot", np.array([boot for *_, boot, _ in rows], np.int64), "", "power-on in the log, from 0"),
        Column("channel", texts([c.name for c in found]), "", "name of the channel"),
        Column("unit", texts([ALL_UNITS[c.name] for c in found]), "", "SI unit of the channel"),
        Column("source", texts([c.source for c in found]), "", "message and field"),
        Column("provenance", texts([c.provenance for c in found]), "", "how the quantity is known"),
        Column("samples", np.array([len(c) for c in found], np.int64), "1", "number of samples"),
        Column("rate_hz", numbers([c.rate_hz for c in found]), "Hz", "median sampling rate"),
        Column(
            "largest_gap_s", numbers([c.largest_gap_s for c in found]), "s", "longest time between stamps"
        ),
    )
    return Table("channels", "A row is a channel of one record.", columns)


def _sha256(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
