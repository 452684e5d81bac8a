"""Run a campaign on screens, or as lines of text without a screen."""

import os
import sys
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from shutil import get_terminal_size
from textwrap import fill
from typing import TYPE_CHECKING

import click

from advisor.aircraft.aircraft import Aircraft
from advisor.process.interrupt import in_order
from advisor.session.conducting import Source, Tempo
from advisor.words.problems import UnusableInputError, printable

if TYPE_CHECKING:
    from pathlib import Path

    from advisor.campaign.campaign import Campaign
    from advisor.campaign.state import ByHand, CampaignState
    from advisor.flight.maneuvers.marks import Mark
    from advisor.mavlink.link.kept_link import Door
    from advisor.session.remote import ConductorTask

Listener = Callable[[object], object]
_HANGS = 4
"""Indentation, in columns, of the second row of a wrapped line."""
Show = Callable[["ConductorTask", Aircraft, str, Tempo | None], object]
"""Function that shows the campaign of a task until the user leaves. It receives the aircraft, the title, and
the tempo of a replay.
"""


def headless() -> bool:
    """Return whether the campaign is printed as lines.

    A screen needs a terminal on standard output and on standard error, which paints it, and a terminal that
    can place a cursor. ``HEADLESS=1`` asks for lines.
    """
    asked = os.environ.get("HEADLESS", "") not in ("", "0")
    dumb = os.environ.get("TERM", "") == "dumb"
    return asked or dumb or not (sys.stdout.isatty() and sys.stderr.isatty())


def advise(
    open_source: Callable[[], Source],
    title: str,
    aircraft: Aircraft,
    target_system: int | None = None,
    tell: Listener | None = None,
    tempo: Tempo | None = None,
    by_hand: "ByHand | None" = None,
    marks: "Sequence[Mark]" = (),
    kept: "Callable[[], ByHand] | None" = None,
    names: Sequence[str] = (),
    logs: "Sequence[Path]" = (),
    show: "Show | None" = None,
    aircraft_file: "Path | None" = None,
    door: "Door | None" = None,
) -> None:
    """Run a campaign on a source, on screens, as lines of text, or with ``show``.

    Parameters
    ----------
    open_source
        Function that opens the source in the estimating process. Both ``open_source`` and ``tell`` must be
        picklable.
    tell
        Function that receives every event of the campaign, in the estimating process.
    tempo
        Start settings of a replay; None if the source is no replay.
    kept
        Reads the decisions by hand since the start, for a source that can be read again from its
        beginning. A picklable source survives the death of the estimating process.
    logs
        Logs and recordings of each flight. Panes are saved next to their log.
    show
        Function that shows the campaign elsewhere. With None the terminal shows the campaign, or prints lines
        of text.

    Raises
    ------
    UnusableInputError
        The source can never be used, or has ended without a manoeuvre to judge.
    """
    from advisor.campaign.state import NOTHING
    from advisor.cli.narrator import narrate, narrate_here
    from advisor.session.conducting import report_before_first
    from advisor.session.remote import ConductorTask

    before = by_hand or NOTHING
    make_campaign = partial(_campaign, aircraft, target_system, tell, tuple(marks), tuple(names))
    if show is not None or not headless():
        first = report_before_first(aircraft, title)
        task = ConductorTask(open_source, partial(make_campaign, True), before, kept, door, first)
        (show or partial(_show, tuple(logs), aircraft_file))(task, aircraft, title, tempo)
    elif kept is not None:
        task = ConductorTask(open_source, partial(make_campaign, False), before, kept, door)
        narrate(task, say, partial(click.echo, err=True))
    else:
        narrate_here(open_source(), make_campaign(False, before), say)


def say(line: str) -> None:
    """Print a line. A terminal would break the line inside words, so it is wrapped between words."""
    if sys.stdout.isatty():
        behind = " " * (len(line) - len(line.lstrip()) + _HANGS)
        line = fill(line, get_terminal_size().columns, subsequent_indent=behind, break_on_hyphens=False)
    click.echo(line)


def _campaign(
    aircraft: Aircraft,
    target_system: int | None,
    tell: Listener | None,
    marks: "Sequence[Mark]",
    names: Sequence[str],
    screens: bool,
    by_hand: "ByHand",
) -> "Campaign":
    from advisor.campaign.campaign import Campaign

    return Campaign(
        aircraft, target_system, screens, tell, by_hand, marks, names, lateral=True, aside=screens
    )


def _show(
    logs: "Sequence[Path]",
    aircraft_file: "Path | None",
    task: "ConductorTask",
    aircraft: Aircraft,
    title: str,
    tempo: Tempo | None,
) -> None:
    from advisor.session.remote import RemoteConductor
    from advisor.tui.app import AdvisorApp
    from advisor.tui.settings import load_settings

    app = AdvisorApp(RemoteConductor(task), aircraft, title, tempo, load_settings(), logs, aircraft_file)
    with in_order():
        app.run()
    if app.failure is not None:
        raise app.failure
    for line in so_far(app.view.state):
        click.echo(printable(line))
    if tempo is not None and app.view.problems:
        raise UnusableInputError.of(app.view.problems[:1])


def so_far(state: "CampaignState") -> Iterator[str]:
    """Yield each verdict so far and stop or continue, after the user left. An axis without a verdict yields
    nothing.
    """
    from advisor.report.facts.answers import decisions
    from advisor.report.text import SIDE_ROOM, maneuver_line

    lateral = state.lateral is not None and state.lateral.maneuvers
    yield from map(maneuver_line, state.maneuvers)
    if state.lateral is not None and lateral:
        yield "Roll and yaw"
        yield from (maneuver_line(maneuver, SIDE_ROOM) for maneuver in state.lateral.maneuvers)
    if state.maneuvers or lateral:
        yield from decisions(state, pitch=bool(state.maneuvers))
