"""Running a campaign with a screen where there is one, as lines of text where there is none."""

import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from functools import partial
from typing import TYPE_CHECKING

import click

from advisor.aircraft import Aircraft
from advisor.flight.messages import Columns
from advisor.problems import Problem, UnusableInputError
from advisor.tui.source import Source, Tempo

if TYPE_CHECKING:
    from advisor.by_hand import ByHand
    from advisor.campaign import Campaign
    from advisor.flight.marks import Mark

READ_S = 0.2

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
    names: Sequence[str] = (),
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
    names
        What the logs of the campaign are called, in their order.

    Raises
    ------
    UnusableInputError
        When the source can never serve, or has ended without anything to judge.
    """
    from advisor.by_hand import NOTHING

    before = by_hand or NOTHING
    make_campaign = partial(_campaign, aircraft, target_system, tell, tuple(marks), tuple(names))
    if headless():
        _narrate(open_source(), make_campaign(settle=False, by_hand=before))
    else:
        _show(open_source, partial(make_campaign, True), before, aircraft, title, tempo)


def _campaign(
    aircraft: Aircraft,
    target_system: int | None,
    tell: Listener | None,
    marks: "Sequence[Mark]",
    names: Sequence[str],
    settle: bool,
    by_hand: "ByHand",
) -> "Campaign":
    from advisor.campaign import Campaign

    return Campaign(aircraft, target_system, settle, tell, by_hand=by_hand, marks=marks, names=names)


def _show(
    open_source: Callable[[], Source],
    make_campaign: "Callable[[ByHand], Campaign]",
    by_hand: "ByHand",
    aircraft: Aircraft,
    title: str,
    tempo: Tempo | None,
) -> None:
    from advisor.tui.app import AdvisorApp
    from advisor.tui.remote import RemoteConductor, Task
    from advisor.tui.settings import load_settings

    conductor = RemoteConductor(Task(open_source, make_campaign, by_hand))
    app = AdvisorApp(conductor, aircraft, title, tempo, load_settings())
    app.run()
    if app.failure is not None:
        raise app.failure
    if tempo is not None:
        _refuse_if_unusable(app.view.problems)


def _narrate(source: Source, campaign: "Campaign") -> None:
    from advisor.report.follow import follow

    with closing(source):
        follow(_batches(source), campaign, click.echo)
    _refuse_if_unusable(campaign.problems)


def _refuse_if_unusable(problems: Sequence[Problem]) -> None:
    if problems:
        raise UnusableInputError(problems[0].code, problems[0].text, problems[0].fix)


def _batches(source: Source) -> Iterator[Sequence[Columns]]:
    while (columns := source.read(READ_S)) is not None:
        for notice in source.take_notices():
            click.echo(f"link: {notice}", err=True)
        yield columns
