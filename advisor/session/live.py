"""A live link as the source of a campaign."""

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import replace
from shutil import disk_usage
from typing import TYPE_CHECKING

from advisor.analysis.marks_file import keep_by_hand
from advisor.campaign.state import ByHand
from advisor.flight.signals.messages import Columns
from advisor.mavlink.link.health import LinkStatistics
from advisor.mavlink.logs.parameter_file import ParameterFiles
from advisor.process.liveness import OLD_AFTER_S
from advisor.session.behind import backlog_s
from advisor.session.conducting import Condition, LinkHealth, LinkRequest

if TYPE_CHECKING:
    from advisor.mavlink.link.kept_link import KeptLink
    from advisor.mavlink.link.link import Link

SILENT_S = 2.0
LOSS_PERCENT = 5.0
_DECODED = ("vehicle_messages", "lost", "repeated", "repeated_after_s", "late")
"""Counts that only the reader of the records knows."""


class LinkSource:
    """Source that reads a live link. The source ends when the sender has finished.

    Parameters
    ----------
    connection
        Context that opens the link at the first ``read``.
    """

    def __init__(
        self, connection: "AbstractContextManager[Link | KeptLink]", over: Callable[[], bool] = lambda: False
    ) -> None:
        self._connection, self._over = connection, over
        self._link: Link | KeptLink | None = None
        self._files = ParameterFiles()
        self._ended = False

    def read(self, timeout_s: float) -> Sequence[Columns] | None:
        """Return the next batch; None when the sender has finished and everything was read.

        Raises
        ------
        UnusableInputError
            The connection cannot be opened.
        """
        if self._link is None:
            self._link = self._connection.__enter__()
        over = self._over()
        columns = self._link.read(timeout_s)
        self._ended = over and not columns
        return None if self._ended else self._files.followed(columns)

    def health(self) -> LinkHealth:
        """Return the state of the arriving data."""
        if self._link is None:
            return LinkHealth("waiting", "Opening the connection.")
        health = _health(self._link.statistics, self._link.read_to_s)
        if self._ended:
            return replace(health, condition="ended", sentence="The flight is over.")
        if self._link.catching_up:
            return replace(health, condition="waiting", sentence="The recording so far is being read.")
        return health

    def take_notices(self) -> Sequence[str]:
        """Return the notices of the link since the last call."""
        return self._link.take_notices() if self._link is not None else ()

    def order(self, order: LinkRequest) -> None:
        """Send a crew's request to the link."""
        if self._link is None:
            return
        if order.what == "follow":
            self._link.follow(order.number)
        elif order.what == "take":
            self._link.take_output(order.number)
        else:
            self._link.ask_for_outputs()

    def keep(self, by_hand: ByHand) -> str:
        """Store the decisions by hand next to the recording."""
        recording = self._link.statistics.recording if self._link is not None else None
        if recording is None:
            return "decisions by hand are not kept, because nothing is recorded: they hold until you quit"
        return keep_by_hand(recording, by_hand)

    def close(self) -> None:
        """Close the link. The recording is complete afterwards."""
        if self._link is not None:
            self._connection.__exit__(None, None, None)


def renewed(health: LinkHealth, link: LinkStatistics) -> LinkHealth:
    """Return the link's health with newer statistics.

    Parameters
    ----------
    health
        Health from the reader of the records, which holds the decoder's counts.
    link
        Newer counts from the process of the link.
    """
    decoded = health.link or LinkStatistics()
    link = replace(link, **{name: getattr(decoded, name) for name in _DECODED})
    return _health(link, health.read_to_s)


def _health(link: LinkStatistics, read_to_s: float) -> LinkHealth:
    condition, sentence = _glance(link)
    health = LinkHealth(
        condition, sentence, _figures(link, read_to_s), "", recording_line(link), link, read_to_s
    )
    old = sentence if condition == "stale" else ""
    return replace(health, alarm=link.recording_problem or old or health.behind)


def _glance(link: LinkStatistics) -> tuple[Condition, str]:
    if link.unanswered_s >= OLD_AFTER_S:
        return "stale", f"LINK NOT ANSWERING for {link.unanswered_s:.0f} s: the values below are old"
    if not link.connected:
        return "lost", "The connection is cut; it is opened again as soon as possible."
    if link.vehicle is None:
        return "waiting", "No vehicle heard yet; check that it sends to this address."
    if link.silent_s > SILENT_S:
        return "lost", f"Nothing heard for {link.silent_s:.0f} s."
    if link.lost_percent > LOSS_PERCENT:
        return "poor", f"{link.lost_percent:.0f} % of the packets are lost."
    return "good", f"{link.messages_per_s:.0f} messages/s."


def _figures(link: LinkStatistics, read_to_s: float) -> tuple[tuple[str, str], ...]:
    figures = [
        ("messages", f"{link.messages} ({link.messages_per_s:.0f}/s)"),
        ("lost", f"{link.lost} ({link.lost_percent:.1f} %)"),
        ("repeated, late", f"{link.repeated}, {link.late}"),
        ("bad checksum", f"{link.bad_crc}"),
        ("silent for", f"{link.silent_s:.1f} s"),
        ("reconnects", f"{link.reconnects}"),
        ("this computer behind by", f"{backlog_s(link, read_to_s):.1f} s"),
    ]
    figures += [(f"refused, {why}", f"{count}") for why, count in link.refused.items()]
    if link.recording is not None:
        figures.append(("recording", f"{link.recording} ({link.recorded_bytes / 1e6:.1f} MB)"))
    return tuple(figures)


def recording_line(link: LinkStatistics) -> str:
    """Return the size of the recording and the free disk space: ``REC 3.2 MB, 41 GB free``."""
    if link.recording is None:
        return "NOT RECORDED"
    size = f"{link.recorded_bytes / 1e6:.1f} MB"
    if link.recording_problem:
        return f"REC STOPPED at {size}"
    try:
        free_bytes = disk_usage(link.recording.parent).free
    except OSError:
        return f"REC {size}"
    free_gb = free_bytes / 1e9
    return f"REC {size}, {free_gb:.{0 if free_gb >= 10.0 else 1}f} GB free"
