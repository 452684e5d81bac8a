"""``advisor demo``: the bundled aircraft flies, the advisor advises."""

from functools import partial
from pathlib import Path

import click

from advisor.aircraft import Rule
from advisor.commands.options import aircraft_option, read_aircraft, rule_option
from advisor.commands.screen import advise, headless

HEADLESS_SPEED = 10.0


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
    help="Multiple of real time; 1 by default, 10 without a screen.",
)
@click.option(
    "--seed", type=click.IntRange(0), default=1, show_default=True, help="Seed of the instruments' noise."
)
@click.option("--record", "record_to", type=click.Path(path_type=Path), help="Keep the link's tlog here.")
@aircraft_option
@rule_option
def command(
    flown: str,
    speed: float | None,
    seed: int,
    record_to: Path | None,
    aircraft_file: Path | None,
    rule: Rule | None,
) -> None:
    """The bundled aircraft flies the paper's seven manoeuvres over a real MAVLink link on loopback.

    Without a terminal, or with HEADLESS=1, the same verdicts come as text.

    \b
    Example:
      advisor demo
      HEADLESS=1 advisor demo --fly uav --rule information
    """
    aircraft = read_aircraft(aircraft_file, rule)
    from advisor.demo import Demonstration
    from advisor.tui.live import LinkSource

    if speed is None:
        speed = HEADLESS_SPEED if headless() else 1.0
    flight = Demonstration(flown, speed, seed, record_to)
    advise(partial(LinkSource, flight, flight.over), f"demonstration: {flown} aircraft", aircraft)
