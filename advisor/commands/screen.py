"""Running a campaign with a screen where there is one, as lines of text where there is none."""

import os
import sys
from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING

import click

from advisor.aircraft import Aircraft
from advisor.interrupt import in_order
from advisor.problems import UnusableInputError
from advisor.tui.source import Source, Tempo

if TYPE_CHECKING:
    from pathlib import Path

    from advisor.campaign.campaign import Campaign
    from advisor.campaign.hand_decisions import ByHand
    from advisor.flight.marks import Mark
    from advisor.tui.remote import Task

Listener = Callable[[object], object]


def headless() -> bool:
    """Whether to print instead of painting: no terminal on stdout, or ``HEADLESS=1``."""
    return os.environ.get("HEADLESS", "") not in ("", "0") or not sys.stdout.isatty()


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
) -> None:
    """Run a campaign on a source: in the terminal application, or as lines of text.

    Parameters
    ----------
    open_source
        Makes the source, in the process that estimates: it must be picklable, as must ``tell``.
    title
        What the source is called on the screens.
    tell
        Called with every event of the campaign, where it is estimated.
    tempo
        How a replay starts; None: the source is no replay.
    by_hand
        What was decided by hand on this flight before.
    marks
        Marks of the command line.
    kept
        Reads what was decided by hand since the start, for a source that can be read from its
        beginning again: the death of the estimating process then ends nothing.
    names
        What the logs of the campaign are called, in their order.
    logs
        Logs and recordings, flight by flight, beside which panes are saved.

    Raises
    ------
    UnusableInputError
        When the source can never serve, or has ended without anything to judge.
    """
    from advisor.campaign.hand_decisions import NOTHING
    from advisor.commands.narrator import narrate, narrate_here
    from advisor.tui.remote import Task

    before = by_hand or NOTHING
    make_campaign = partial(_campaign, aircraft, target_system, tell, tuple(marks), tuple(names))
    if not headless():
        task = Task(open_source, partial(make_campaign, True), before, kept)
        _show(task, aircraft, title, tempo, logs)
    elif kept is not None:
        task = Task(open_source, partial(make_campaign, False), before, kept)
        narrate(task, click.echo, partial(click.echo, err=True))
    else:
        narrate_here(open_source(), make_campaign(False, before), click.echo)


def _campaign(
    aircraft: Aircraft,
    target_system: int | None,
    tell: Listener | None,
    marks: "Sequence[Mark]",
    names: Sequence[str],
    settle: bool,
    by_hand: "ByHand",
) -> "Campaign":
    from advisor.campaign.campaign import Campaign

    return Campaign(aircraft, target_system, settle, tell, by_hand=by_hand, marks=marks, names=names)


def _show(task: "Task", aircraft: Aircraft, title: str, tempo: Tempo | None, logs: "Sequence[Path]") -> None:
    from advisor.tui.app import AdvisorApp
    from advisor.tui.remote import RemoteConductor
    from advisor.tui.settings import load_settings

    app = AdvisorApp(RemoteConductor(task), aircraft, title, tempo, load_settings(), logs)
    with in_order():
        app.run()
    if app.failure is not None:
        raise app.failure
    if tempo is not None and app.view.problems:
        raise UnusableInputError.of(app.view.problems[:1])
