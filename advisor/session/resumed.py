"""A link that continues a flight test whose earlier flights are in logs."""

from collections.abc import Iterable, Iterator, Sequence
from math import inf
from pathlib import Path

import numpy as np

from advisor.analysis.log_series import LogSeries, of_flight
from advisor.analysis.marks_file import keep_on_all
from advisor.campaign.hand_decisions import ByHand
from advisor.flight.signals.messages import Columns
from advisor.session.source import LinkHealth, LinkRequest, Source
from advisor.session.timeline import Timeline

STRETCH_S = 30.0
"""Longest part of an earlier flight in one batch, s. An autopilot's own log comes as one batch, so that the
campaign would not report for minutes.
"""


def stretches(batches: Iterable[list[Columns]]) -> Iterator[list[Columns]]:
    """Yield the messages of the batches in their order, at most ``STRETCH_S`` of flight together."""
    for batch in batches:
        timeline = Timeline(batch)
        ends = np.arange(STRETCH_S, timeline.duration_s, STRETCH_S)
        yield from filter(None, map(timeline.up_to, [*ends.tolist(), inf]))


class ResumedSource:
    """Delivers the logs of earlier flights, then the messages of a link as the last flight.

    Parameters
    ----------
    logs
        Logs of earlier flights, the oldest first, only read.
    """

    def __init__(self, logs: Sequence[Path], link: Source) -> None:
        self._series = LogSeries(logs)
        self._link = link
        self._past: Iterator[list[Columns]] | None = stretches(self._series.batches())
        self._kept = self._series.read_by_hand()
        self._notices: list[str] = []

    def read(self, timeout_s: float) -> Sequence[Columns] | None:
        """Return the next batch, beginning with the earlier flights.

        Raises
        ------
        UnusableInputError
            The link can never be used.
        """
        if self._past is not None:
            batch = next(self._past, None)
            if batch is not None:
                return batch
            self._past = None
            self._notices += self._series.said()
        columns = self._link.read(timeout_s)
        return columns if columns is None else of_flight(columns, len(self._series.logs))

    def health(self) -> LinkHealth:
        """Return the state of the arriving data."""
        if self._past is not None:
            return LinkHealth("waiting", "The earlier flights are being read.")
        return self._link.health()

    def take_notices(self) -> Sequence[str]:
        """Return the notices since the last call."""
        notices, self._notices = self._notices, []
        return [*notices, *self._link.take_notices()]

    def order(self, order: LinkRequest) -> None:
        """Send a crew's request to the link."""
        self._link.order(order)

    def keep(self, by_hand: ByHand) -> str:
        """Store each decision by hand next to its log or recording."""
        before, self._kept = self._kept, by_hand
        said = keep_on_all(self._series.logs, before, by_hand)
        newest = self._link.keep(by_hand.on_flight(len(self._series.logs)))
        return "; ".join(filter(None, (said, newest)))

    def close(self) -> None:
        self._link.close()
