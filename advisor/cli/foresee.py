"""``advisor foresee``: what a planned flight would show of each effect, without a log."""

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import click

from advisor.cli.options import aircraft_option, json_option, read_aircraft

F = TypeVar("F", bound=Callable[..., Any])


def plan_options(hidden: bool = False) -> Callable[[F], F]:
    """Return a decorator that adds the options of a planned flight.

    Parameters
    ----------
    hidden
        Whether the help omits the options.
    """
    options = (
        click.option(
            "--plan",
            default="3211,rev,rev,3211,rev,3211,rev",
            show_default=True,
            hidden=hidden,
            help="Manoeuvres to fly.",
        ),
        click.option(
            "--rate", "rate_hz", type=float, default=50.0, show_default=True, hidden=hidden,
            help="Stream rate, Hz.",
        ),
        click.option(
            "--amplitude-deg", type=float, default=2.0, show_default=True, hidden=hidden,
            help="Elevator step, deg.",
        ),
        click.option("--without", default="", hidden=hidden, help="Missing channels, e.g. a_z,theta."),
    )  # fmt: skip

    def add(command: F) -> F:
        for option in reversed(options):
            command = option(command)
        return command

    return add


@click.command
@aircraft_option
@plan_options()
@json_option
def command(
    aircraft_file: Path | None, plan: str, rate_hz: float, amplitude_deg: float, without: str, as_json: bool
) -> int:
    """Print the smallest size of each effect that a planned flight would detect.

    \b
    Example:
      advisor foresee --aircraft my-aircraft.yaml
      advisor foresee --aircraft my-aircraft.yaml --rate 20 --without a_z
    """
    from advisor.report.gap_plan import print_foresight

    return print_foresight(read_aircraft(aircraft_file), plan, rate_hz, amplitude_deg, without, as_json)
