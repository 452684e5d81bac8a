"""``advisor replay``: logs played like a flight."""

from functools import partial
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING

import click

from advisor.aircraft.aircraft import Rule
from advisor.cli.options import (
    aircraft_option,
    maneuver_option,
    no_marks_option,
    read_aircraft,
    refuse_marks_on_several,
    rule_option,
    target_system_option,
)
from advisor.cli.screen import Show, advise
from advisor.words.printable import printable

if TYPE_CHECKING:
    from advisor.flight.maneuvers.marks import Mark


def _speed(ctx: click.Context, parameter: click.Parameter, text: str) -> float:
    if text == "max":
        return inf
    try:
        speed = float(text)
    except ValueError:
        speed = 0.0
    if not 0.0 < speed < inf:
        raise click.BadParameter("give a number above 0, or max")
    return speed


@click.command
@click.argument("logs", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option(
    "--speed", default="1", show_default=True, callback=_speed, metavar="N|max", help="Multiple of real time."
)
@aircraft_option
@rule_option
@target_system_option
@maneuver_option
@no_marks_option
def command(
    logs: tuple[Path, ...],
    speed: float,
    aircraft_file: Path | None,
    rule: Rule | None,
    target_system: int | None,
    marks: "tuple[Mark, ...]",
    no_marks: bool,
    show: Show | None = None,
) -> None:
    """Play logs on the screens of a live flight: pause, step, speed, jump to a manoeuvre.

    Several logs are one campaign of several flights, played one after the other. Without a terminal, or with
    HEADLESS=1, the verdicts come as text.

    \b
    Example:
      advisor replay logs/arduplane-calm.tlog --speed 10
      advisor replay battery-1.tlog battery-2.tlog --speed max
      advisor replay flight.tlog --maneuver +12:+24
    """
    aircraft = read_aircraft(aircraft_file, rule)
    refuse_marks_on_several(marks, logs)
    from advisor.analysis.log_series import LogSeries
    from advisor.campaign.hand_decisions import NOTHING
    from advisor.session.replay import LogPlayer
    from advisor.session.source import Tempo

    series = LogSeries(logs)
    by_hand = NOTHING if no_marks else series.read_by_hand()
    title = printable(", ".join(series.names))
    player = partial(
        LogPlayer,
        title,
        series.load,
        speed,
        # Several pages that replay one log would overwrite each other's decisions.
        keep_beside=() if no_marks or show is not None else series.logs,
        before=by_hand,
        said=series.said,
    )
    tempo = Tempo(speed=speed)
    advise(
        player,
        title,
        aircraft,
        target_system,
        tempo=tempo,
        by_hand=by_hand,
        marks=marks,
        names=series.names,
        logs=series.logs,
        show=show,
    )
