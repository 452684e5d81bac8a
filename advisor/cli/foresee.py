"""``advisor foresee``: what a planned flight would show of each effect, without a log."""

from pathlib import Path

import click

from advisor.cli.options import aircraft_option, json_option, read_aircraft


@click.command
@aircraft_option
@click.option(
    "--plan", default="3211,rev,rev,3211,rev,3211,rev", show_default=True, help="Manoeuvres to fly."
)
@click.option("--rate", "rate_hz", type=float, default=50.0, show_default=True, help="Stream rate, Hz.")
@click.option("--amplitude-deg", type=float, default=2.0, show_default=True, help="Elevator step, deg.")
@click.option("--without", default="", help="Missing channels, e.g. a_z,theta.")
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
