"""A live link as the source of a campaign."""

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from typing import TYPE_CHECKING

from advisor.flight.messages import Columns
from advisor.mavlink.health import LinkStatistics
from advisor.tui.source import Condition, LinkHealth

if TYPE_CHECKING:
    from advisor.mavlink.link import Link

SILENT_S = 2.0
LOSS_PERCENT = 5.0


class LinkSource:
    """Reads a link; ends only when told that the other side has.

    Parameters
    ----------
    opening
        Makes the link, still closed. It is called and opened by the first ``read``, in the
        reading thread, so that a screen is painted before the decoders are loaded.
    title
        What the status line calls it.
    over
        Says whether the far end has finished for good; a demonstration knows, a link never does.
    """

    def __init__(
        self,
        opening: "Callable[[], AbstractContextManager[Link]]",
        title: str,
        over: Callable[[], bool] = lambda: False,
    ) -> None:
        self._opening, self._title, self._over = opening, title, over
        self._opened: AbstractContextManager[Link] | None = None
        self._link: Link | None = None

    @property
    def title(self) -> str:
        """What it is, for the status line."""
        return self._title

    def read(self, timeout_s: float) -> Sequence[Columns] | None:
        """The next batch; None when the far end has finished and all of it was read.

        Raises
        ------
        UnusableInputError
            When the connection cannot be opened.
        """
        if self._link is None:
            opened = self._opening()
            self._link = opened.__enter__()
            self._opened = opened
        over = self._over()
        columns = self._link.read(timeout_s)
        return None if over and not columns else columns

    def health(self) -> LinkHealth:
        """How the data arrive at this moment."""
        if self._link is None:
            return LinkHealth("waiting", "Opening the connection.")
        statistics = self._link.statistics
        condition, sentence = _glance(statistics)
        if self._over():
            condition, sentence = "ended", "The flight is over."
        return LinkHealth(condition, sentence, _figures(statistics))

    def take_notices(self) -> Sequence[str]:
        """What the link has to report since the last call."""
        return [notice.text for notice in self._link.take_notices()] if self._link is not None else ()

    def close(self) -> None:
        """Stop listening; the recording is whole afterwards."""
        if self._opened is not None:
            self._opened.__exit__(None, None, None)
            self._opened = None


def _glance(link: LinkStatistics) -> tuple[Condition, str]:
    if not link.connected:
        return "lost", "The connection is cut; it is opened again as soon as it can be."
    if link.vehicle is None:
        return "waiting", "No vehicle heard yet; check that it sends to this address."
    if link.silent_s > SILENT_S:
        return "lost", f"Nothing heard for {link.silent_s:.0f} s."
    if link.lost_percent > LOSS_PERCENT:
        return "poor", f"{link.lost_percent:.0f} % of the packets are lost."
    return "good", f"{link.messages_per_s:.0f} messages/s."


def _figures(link: LinkStatistics) -> tuple[tuple[str, str], ...]:
    figures = [
        ("messages", f"{link.messages} ({link.messages_per_s:.0f}/s)"),
        ("lost", f"{link.lost} ({link.lost_percent:.1f} %)"),
        ("duplicated, late", f"{link.duplicated}, {link.late}"),
        ("bad checksum", f"{link.bad_crc}"),
        ("silent for", f"{link.silent_s:.1f} s"),
        ("reconnects", f"{link.reconnects}"),
    ]
    figures += [(f"refused, {why}", f"{count}") for why, count in link.refused.items()]
    if link.recording is not None:
        figures.append(("recording", f"{link.recording} ({link.recorded_bytes / 1e6:.1f} MB)"))
    return tuple(figures)
