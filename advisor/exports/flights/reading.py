"""Dataset of an export: whole flights as tables."""

import hashlib
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from advisor import __version__
from advisor.analysis.whole_flights import WholeFlights
from advisor.exports.flights.findings import findings
from advisor.exports.flights.table import Column, Dataset, FlightTable, Recording, counts, numbers, texts
from advisor.flight.maneuvers.segmentation import GAP_S, MANY_INTERVALS
from advisor.flight.signals.record import ALL_UNITS, Channel
from advisor.flight.signals.track import PowerOn
from advisor.process.arrays import FloatArray


def dataset(flights: WholeFlights) -> Dataset:
    """Return all data of an export as tables."""
    record_of = {(flight, p.boot): number for number, (flight, p) in enumerate(flights.power_ons, start=1)}
    state = flights.state
    sideways = state.lateral is not None and state.lateral.maneuvers and not state.maneuvers
    judged = state.lateral if sideways and state.lateral is not None else state
    tables = (_channels(flights), *findings(state, record_of))
    about = {
        "advisor": __version__,
        "logs": [{"file": str(log), "sha256": sha256(log)} for log in flights.logs],
        "grid": GRID,
        "decision": judged.flight_test.sentence,
        "notes": flights.notes,
    }
    recordings = tuple(_recording(k, power_on) for k, (_, power_on) in enumerate(flights.power_ons, start=1))
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
        (number, flights.logs[flight], power_on.boot, channel)
        for number, (flight, power_on) in enumerate(flights.power_ons, start=1)
        for channel in power_on.channels.values()
    ]
    channels = [channel for *_, channel in rows]
    columns = (
        Column("record", counts([number for number, *_ in rows]), "", "number of the record"),
        Column("log", texts([str(log) for _, log, _, _ in rows]), "", "file of the log"),
        Column(
            "boot",
            counts([boot for *_, boot, _ in rows]),
            "",
            "number of the power-on in the log, counted from 0",
        ),
        Column("channel", texts([c.name for c in channels]), "", "name of the channel"),
        Column("unit", texts([ALL_UNITS[c.name] for c in channels]), "", "SI unit of the channel"),
        Column("source", texts([c.source for c in channels]), "", "message and field"),
        Column("provenance", texts([c.provenance for c in channels]), "", "origin of the quantity"),
        Column("samples", counts([len(c) for c in channels]), "1", "number of samples"),
        Column("rate_hz", numbers([c.rate_hz for c in channels]), "Hz", "median sampling rate"),
        Column(
            "largest_gap_s", numbers([c.largest_gap_s for c in channels]), "s", "longest time between stamps"
        ),
    )
    return FlightTable("channels", "A row is a channel of one record.", columns)


def sha256(path: Path) -> str:
    """Return the SHA-256 hash of a file, in hexadecimal digits."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


GRID = (
    "uniform, from the first to the last stamp of the pitch rate q at its median interval (without q, of the"
    " fastest channel); linear between a channel's stamps; none outside, or in gaps longer than"
    f" {GAP_S:g} s and {MANY_INTERVALS:g} median intervals"
)
"""Description of the time grid, and of the interpolation onto it."""


def on_one_grid(channels: Mapping[str, Channel]) -> FlightTable:
    """Return all channels at the times of ``GRID``; no rows if every channel has fewer than two samples."""
    t = grid_times(channels)
    columns = [
        Column(name, on_grid(c, t), ALL_UNITS[name], f"{name} from {c.source}")
        for name, c in channels.items()
    ]
    time = Column("t_boot_s", t, "s", "vehicle time since power-on")
    return FlightTable("grid", f"All channels on one grid: {GRID}.", (time, *columns))


def grid_times(channels: Mapping[str, Channel]) -> FloatArray:
    """Return the times of the common grid, shape (n,), s since power-on."""
    paced = {name: c for name, c in channels.items() if len(c) > 1}
    if not paced:
        return np.empty(0)
    pace = paced.get("q") or min(paced.values(), key=lambda c: float(np.median(np.diff(c.t))))
    step = float(np.median(np.diff(pace.t)))
    times: FloatArray = pace.t[0] + step * np.arange(int((pace.t[-1] - pace.t[0]) / step + 1e-6) + 1)
    return times


def on_grid(channel: Channel, t: FloatArray) -> FloatArray:
    """Return a channel at the times ``t``, shape (n,): linear between stamps, NaN outside and in gaps."""
    if len(channel) == 0 or len(t) == 0:
        return np.full(len(t), np.nan)
    y = np.interp(t, channel.t, channel.y, left=np.nan, right=np.nan)
    if len(channel) > 1:
        after = np.clip(np.searchsorted(channel.t, t, side="left"), 1, len(channel) - 1)
        apart = channel.t[after] - channel.t[after - 1]
        lost = apart > max(GAP_S, MANY_INTERVALS * float(np.median(np.diff(channel.t))))
        at_stamp = (t == channel.t[after]) | (t == channel.t[after - 1])
        y[lost & ~at_stamp] = np.nan
    return np.asarray(y, dtype=np.float64)
