"""The dataset of an export: whole flights as tables."""

import hashlib
from pathlib import Path

import numpy as np

from advisor import __version__
from advisor.analysis.whole_flights import WholeFlights
from advisor.exports.flights.found import estimates, maneuvers, residuals
from advisor.exports.flights.grid import GRID, on_one_grid
from advisor.exports.flights.table import Column, Dataset, FlightTable, Recording, numbers, texts
from advisor.flight.signals.power_on import PowerOn
from advisor.flight.signals.record import ALL_UNITS


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
        "notes": flights.notes,
    }
    recordings = tuple(_recording(k, one) for k, (_, one) in enumerate(flights.power_ons, start=1))
    return Dataset(recordings, tables, about)


def _recording(number: int, power_on: PowerOn) -> Recording:
    channels = tuple(
        FlightTable(
            name,
            f"{name} at its own stamps.",
            (
                Column("t_boot_s", channel.t, "s", "vehicle time since power-on"),
                Column(
                    name, channel.y, ALL_UNITS[name], f"{name} from {channel.source}, {channel.provenance}"
                ),
            ),
        )
        for name, channel in power_on.channels.items()
    )
    return Recording(f"record_{number}", channels, on_one_grid(power_on.channels))


def _channels(flights: WholeFlights) -> FlightTable:
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
    return FlightTable("channels", "A row is a channel of one record.", columns)


def _sha256(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
