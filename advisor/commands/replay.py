"""``advisor replay``: a log played like a flight."""

from functools import partial
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING

import click

from advisor.aircraft import Rule
from advisor.commands.options import (
    aircraft_option,
    decided_on,
    maneuver_option,
    no_marks_option,
    read_aircraft,
    rule_option,
    target_system_option,
)
from advisor.commands.screen import advise
from advisor.flight.messages import Columns
from advisor.printable import printable

if TYPE_CHECKING:
    from advisor.flight.marks import Mark


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
@click.argument("log", type=click.Path(path_type=Path))
@click.option(
    "--speed", default="1", show_default=True, callback=_speed, metavar="N|max", help="Multiple of real time."
)
@aircraft_option
@rule_option
@target_system_option
@maneuver_option
@no_marks_option
def command(
    log: Path,
    speed: float,
    aircraft_file: Path | None,
    rule: Rule | None,
    target_system: int | None,
    marks: "tuple[Mark, ...]",
    no_marks: bool,
) -> None:
    """The same screens on a log: pause, step, speed, jump to a manoeuvre.

    Without a terminal, or with HEADLESS=1, the verdicts come as text.

    \b
    Example:
      advisor replay logs/arduplane-calm.tlog --speed 10
      advisor replay flight.tlog --maneuver +12:+24
    """
    aircraft = read_aircraft(aircraft_file, rule)
    by_hand = decided_on(log, no_marks)
    from advisor.tui.replay import LogPlayer
    from advisor.tui.source import Tempo

    keep_beside = None if no_marks else log
    title = printable(log.name)
    player = partial(LogPlayer, title, partial(_columns, log), speed, keep_beside=keep_beside)
    tempo = Tempo(speed=speed)
    advise(player, title, aircraft, target_system, tempo=tempo, by_hand=by_hand, marks=marks)


def _columns(log: Path) -> list[Columns]:
    # The log reader takes longer to load than the first screen to paint.
    from advisor.mavlink.logs import open_log

    return [columns for batch in open_log(log) for columns in batch]
