"""An hour of flight out of a log of minutes."""

from dataclasses import replace
from math import inf
from pathlib import Path

import numpy as np

from advisor.flight.signals.messages import Columns
from advisor.mavlink.logs.logs import open_log
from advisor.session import conductor
from advisor.session.replay import LogPlayer


def player(log: Path, minutes: float) -> LogPlayer:
    """The flight as fast as it can be played; every half second of it is reported."""
    conductor.REPORT_EVERY_S = 0.0
    return LogPlayer(log.name, lambda: long_flight(log, minutes), inf)


def long_flight(log: Path, minutes: float) -> list[Columns]:
    """The log, then 16 s of quiet flight before its last manoeuvre again and again, all clocks running on."""
    pieces = [columns for batch in open_log(log) for columns in batch]
    arrival = np.concatenate([p.arrival_s for p in pieces])
    first, last = float(arrival.min()), float(arrival.max())
    last_order = max(int(p.order[-1]) for p in pieces)
    quiet = [p for p in (cut(p, last - 29.0, last - 13.0) for p in pieces) if len(p)]
    repeats = int((minutes * 60.0 - (last - first)) / 16.0)
    return pieces + [
        later(piece, 29.0 + 16.0 * k, (k + 1) * (last_order + 1)) for k in range(repeats) for piece in quiet
    ]


def cut(piece: Columns, start_s: float, end_s: float) -> Columns:
    """What arrived from ``start_s`` until before ``end_s``."""
    wanted = (piece.arrival_s >= start_s) & (piece.arrival_s < end_s)
    fields = {name: np.array(values)[wanted] for name, values in piece.fields.items()}
    return replace(piece, order=piece.order[wanted], arrival_s=piece.arrival_s[wanted], fields=fields)


def later(piece: Columns, seconds: float, order: int) -> Columns:
    """The same messages so much later on all clocks, and in the order of arrival."""
    fields = dict(piece.fields)
    for name, per_second in (("time_boot_ms", 1e3), ("time_usec", 1e6)):
        if name in fields:
            shifted = fields[name].astype(np.int64) + int(seconds * per_second)
            fields[name] = shifted.astype(fields[name].dtype)
    return replace(piece, order=piece.order + order, arrival_s=piece.arrival_s + seconds, fields=fields)
