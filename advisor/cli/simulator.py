"""``advisor simulator``: check a user's simulator before a flight is compared with it."""

import json
from dataclasses import replace
from pathlib import Path

import click

from advisor.aircraft.aircraft import Aircraft
from advisor.cli.options import aircraft_option, json_option, read_aircraft
from advisor.words.problems import ConfigurationError, printable


@click.group
def command() -> None:
    """Check your own simulator: signs, units, trim and responses.

    \b
    Example:
      advisor simulator check jsbsim:c172p --airspeed 50 --height 1000
      advisor simulator check fmu:plane.fmu --aircraft my-aircraft.yaml
    """


@command.command
@click.argument("specification", metavar="SPEC")
@click.option(
    "--airspeed", type=click.FloatRange(min=1.0), help="True air speed, m/s. Default: the aircraft file's."
)
@click.option(
    "--height", type=float, help="Height in the standard atmosphere, m. Default: the aircraft file's, or 0."
)
@aircraft_option
@json_option
def check(
    specification: str,
    airspeed: float | None,
    height: float | None,
    aircraft_file: Path | None,
    as_json: bool,
) -> None:
    """Load a simulator, trim it, step its elevator, and print the responses.

    The simulator flies 5 s at rest and one 3-2-1-1. A wrong sign or unit ends the command with exit code 3
    and one sentence, as in advisor gap.

    \b
    Example:
      advisor simulator check jsbsim:c172p --airspeed 50 --height 1000
      advisor simulator check python:my_simulator:make --aircraft my-aircraft.yaml
    """
    from advisor.analysis.gap import opened_simulator
    from advisor.report.improved import document, lines
    from advisor.simulators.check import check as checked
    from advisor.simulators.protocol import Condition

    aircraft = replace(read_aircraft(aircraft_file), simulator=specification)
    speed = airspeed or _speed_of(aircraft)
    high = height if height is not None else aircraft.reference.height_m or 0.0
    with opened_simulator(aircraft) as simulator:
        assert simulator is not None
        check = checked(simulator, Condition(speed, high, 0.0, aircraft.reference.mass_kg), aircraft)
    if as_json:
        click.echo(json.dumps(document(check), allow_nan=False, indent=1))
    else:
        for line in lines(check):
            click.echo(printable(line))
    if check.fault is not None:
        raise check.fault.refuse(check.simulator)


def _speed_of(aircraft: Aircraft) -> float:
    """Return the air speed that the aircraft file states; refuse a file that states none."""
    if aircraft.stated_airspeed_m_s is None:
        raise ConfigurationError(
            "advisor simulator check needs an air speed: "
            "give --airspeed, or airspeed_m_s in the aircraft file."
        )
    return aircraft.stated_airspeed_m_s
