"""``advisor replay``: logs played like a flight."""

from functools import partial
from math import inf

import click

from advisor.cli.options import LogsAsked, log_options
from advisor.cli.screen import Show, advise
from advisor.words.problems import printable


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
@log_options("rule", "marks", "no_marks")
@click.option(
    "--speed", default="1", show_default=True, callback=_speed, metavar="N|max", help="Multiple of real time."
)
def command(asked: LogsAsked, speed: float, show: Show | None = None) -> None:
    """Play logs on the screens of a live flight: pause, step, speed, jump to a manoeuvre.

    Several logs are one campaign of several flights, played one after the other. Without a terminal, or with
    HEADLESS=1, the verdicts come as text.

    \b
    Example:
      advisor replay logs/arduplane-calm.tlog --speed 10
      advisor replay battery-1.tlog battery-2.tlog --speed max
      advisor replay flight.tlog --maneuver +12:+24
    """
    aircraft = asked.read_aircraft()
    from advisor.analysis.marks_file import LogSeries
    from advisor.campaign.state import NOTHING
    from advisor.session.conducting import Tempo
    from advisor.session.replay import LogPlayer

    series = LogSeries(asked.logs, aircraft.columns)
    by_hand = NOTHING if asked.no_marks else series.read_by_hand()
    title = printable(", ".join(series.names))
    player = partial(
        LogPlayer,
        title,
        series.load,
        speed,
        # Several pages that replay one log would overwrite each other's decisions.
        keep_beside=() if asked.no_marks or show is not None else series.logs,
        before=by_hand,
        said=series.said,
    )
    tempo = Tempo(speed=speed)
    advise(
        player,
        title,
        aircraft,
        asked.target_system,
        tempo=tempo,
        by_hand=by_hand,
        marks=asked.marks,
        names=series.names,
        logs=series.logs,
        show=show,
        aircraft_file=asked.aircraft_file,
    )
