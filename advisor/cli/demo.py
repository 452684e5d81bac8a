"""``advisor demo``: the bundled aircraft flies, and the advisor advises."""

from functools import partial
from pathlib import Path

import click

from advisor.aircraft.aircraft import Rule
from advisor.cli.options import RULES, aircraft_option, read_aircraft
from advisor.cli.screen import advise, headless
from advisor.process.first_run import compile_once
from advisor.process.interrupt import in_order

HEADLESS_SPEED = 10.0
MEANING = {
    "continuous": "the paper's rule of continuous improvement, Eqs. (10) and (12)",
    "separate": "the paper's rule of separate computation, Eqs. (11) and (12)",
    "information": "the rule for real flights, which judges the model's prediction",
}
"""Meaning of each rule, for the first line and the title."""


@click.command
@click.option(
    "--fly",
    "flown",
    type=click.Choice(["linear", "uav", "light"]),
    default="linear",
    show_default=True,
    help="Bundled aircraft: the paper's linear model, a 10 kg UAV, a 1,200 kg light aircraft.",
)
@click.option(
    "--speed",
    type=click.FloatRange(min=0.1, max=50.0),
    help="Multiple of real time. Default: 1, or 10 without a screen.",
)
@click.option(
    "--seed", type=click.IntRange(0), default=1, show_default=True, help="Seed of the instruments' noise."
)
@click.option(
    "--record",
    "record_to",
    type=click.Path(path_type=Path),
    help="File for the recording of the link (tlog).",
)
@aircraft_option
@click.option(
    "--rule",
    type=click.Choice(RULES),
    default="continuous",
    show_default=True,
    help="Rule that decides; the other rules are shown. The paper's rules are continuous and separate.",
)
def command(
    flown: str, speed: float | None, seed: int, record_to: Path | None, aircraft_file: Path | None, rule: Rule
) -> None:
    """Fly the bundled aircraft through the paper's seven manoeuvres, over a real MAVLink link on loopback.

    The paper's own rule decides, unless --rule names another. On real flights the default is information.
    Without a terminal, or with HEADLESS=1, the verdicts come as text.

    \b
    Example:
      advisor demo
      HEADLESS=1 advisor demo --fly uav --rule information
    """
    aircraft = read_aircraft(aircraft_file, rule)
    from advisor.bundled.demo import Demonstration
    from advisor.session.live import LinkSource

    if speed is None:
        speed = HEADLESS_SPEED if headless() else 1.0
    compile_once(partial(click.echo, err=True), {"bundled aircraft": Demonstration.fly_once})
    flight = Demonstration(flown, speed, seed, record_to)
    if headless():
        click.echo(f"rule {rule} decides: {MEANING[rule]}; --rule chooses another")
    title = f"demonstration: {flown} aircraft, {MEANING[rule]}"
    with in_order():
        advise(partial(LinkSource, flight, flight.over), title, aircraft)
