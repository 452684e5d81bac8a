"""Cutting a batch of columns where something changes that all later messages depend on."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from advisor.flight.messages import Columns

_EVERY = 100_000
"""Longest piece in arrival orders (bytes of a log), so that memory stays bounded whatever the batch."""


def pieces(columns: Sequence[Columns]) -> Iterator[list[Columns]]:
    """The batch in order of arrival, cut before every change of vehicle, mode or parameter."""
    filled = [c for c in columns if len(c)]
    if not filled:
        return
    first = min(int(c.order[0]) for c in filled)
    past = max(int(c.order[-1]) for c in filled) + 1
    cuts = {first, past, *range(first, past, _EVERY)}
    for c in filled:
        cuts.update(_turning_points(c))
    edges = sorted(cuts)
    for a, b in pairwise(edges):
        yield between(filled, a, b)


def between(columns: Sequence[Columns], first: int, past: int) -> list[Columns]:
    """Rows with ``first <= order < past``; types without any are left out."""
    found = []
    for c in columns:
        i, j = np.searchsorted(c.order, [first, past])
        if j > i:
            rows = slice(int(i), int(j))
            fields = {name: values[rows] for name, values in c.fields.items()}
            found.append(replace(c, order=c.order[rows], arrival_s=c.arrival_s[rows], fields=fields))
    return found


def _turning_points(c: Columns) -> list[int]:
    if c.name == "HEARTBEAT":
        mode = np.asarray(c.fields["custom_mode"], dtype=np.int64)
        changed = np.concatenate(([True], mode[1:] != mode[:-1]))
        return [int(n) for n in c.order[changed]]
    if c.name == "PARAM_VALUE":
        servo = [raw.startswith(b"SERVO") for raw in c.fields["param_id"].tolist()]
        return [int(n) for n in c.order[np.array(servo, dtype=bool)]]
    if c.name in ("STATUSTEXT", "AUTOPILOT_VERSION"):
        return [int(n) for n in c.order]
    return []
