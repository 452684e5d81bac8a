"""Answer of ``advisor analyze`` to flights without a test input: the next inputs, and the examination."""

from typing import TYPE_CHECKING

import click

from advisor.aircraft.aircraft import Aircraft
from advisor.cli.doctor import examine_log
from advisor.words.printable import printable

if TYPE_CHECKING:
    from advisor.analysis.axes import Axis
    from advisor.analysis.log_series import LogSeries
    from advisor.campaign.state import CampaignState

_COLUMNS = 80
"""Width of the drawing, which a narrow terminal still holds."""


def print_untested(
    state: "CampaignState",
    series: "LogSeries",
    aircraft: Aircraft,
    target_system: int | None,
    axis: "Axis",
) -> None:
    """Print the next input of each axis with its drawing, then the examination of each log."""
    from advisor.doctor.text import ExaminationText
    from advisor.report.console import PlainConsole
    from advisor.tui.stick_drawing import drawn

    tests = [state.flight_test] if axis != "lateral" else []
    tests += [state.lateral.flight_test] if state.lateral is not None else []
    for test in tests:
        click.echo(test.sentence)
        if test.next is not None:
            click.echo(drawn(test.next, _COLUMNS, large=True))
        click.echo()
    for name, log in zip(series.names, series.logs, strict=True):
        click.echo(f"Without a test input, {printable(name)} tells:")
        PlainConsole(soft_wrap=True).print(ExaminationText(examine_log(log, aircraft, target_system)))
