"""Running a campaign with a screen where there is one, as lines of text where there is none."""

import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from typing import TYPE_CHECKING

import click

from advisor.aircraft import Aircraft
from advisor.flight.messages import Columns
from advisor.problems import UnusableInputError
from advisor.tui.campaign_like import CampaignLike
from advisor.tui.source import Playable, Source

if TYPE_CHECKING:
    from advisor.campaign import Campaign

READ_S = 0.2

Listener = Callable[[object], object]


def headless() -> bool:
    """Whether to print instead of painting: no terminal on stdout, or ``HEADLESS=1``."""
    return os.environ.get("HEADLESS", "") not in ("", "0") or not sys.stdout.isatty()


def advise(
    source: Source, aircraft: Aircraft, target_system: int | None = None, tell: Listener | None = None
) -> None:
    """Run a campaign on a source: in the terminal application, or as lines of text.

    Parameters
    ----------
    tell
        Called with every event of the campaign, from the thread that estimates.

    Raises
    ------
    UnusableInputError
        When the source can never serve, or has ended without anything to judge.
    """
    if headless():
        _narrate(source, aircraft, target_system, tell)
    else:
        _show(source, aircraft, target_system, tell)


def _show(source: Source, aircraft: Aircraft, target_system: int | None, tell: Listener | None) -> None:
    from advisor.tui.app import AdvisorApp
    from advisor.tui.settings import load_settings

    campaigns: list[Campaign] = []

    def make_campaign() -> CampaignLike:
        # Called in the working thread, after the first paint: the numerical libraries load there.
        from advisor.campaign import Campaign

        campaigns.append(Campaign(aircraft, target_system, settle=True, tell=tell))
        return campaigns[-1]

    app = AdvisorApp(source, make_campaign, aircraft, load_settings())
    app.run()
    if app.failure is not None:
        raise app.failure
    if isinstance(source, Playable) and campaigns:
        _refuse_if_unusable(campaigns[-1])


def _narrate(source: Source, aircraft: Aircraft, target_system: int | None, tell: Listener | None) -> None:
    from advisor.campaign import Campaign
    from advisor.report.follow import follow

    campaign = Campaign(aircraft, target_system, tell=tell)
    with closing(source):
        follow(_batches(source), campaign, click.echo)
    _refuse_if_unusable(campaign)


def _refuse_if_unusable(campaign: "Campaign") -> None:
    problems = campaign.problems
    if problems:
        raise UnusableInputError(problems[0].code, problems[0].text, problems[0].fix)


def _batches(source: Source) -> Iterator[Sequence[Columns]]:
    while (columns := source.read(READ_S)) is not None:
        for notice in source.take_notices():
            click.echo(f"link: {notice}", err=True)
        yield columns
