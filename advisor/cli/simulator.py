"""``advisor simulator``: check a user's simulator before a flight is compared with it."""

import json
from dataclasses import replace
from pathlib import Path

import click

from advisor.aircraft.aircraft import Aircraft
from advisor.cli.options import aircraft_option, json_option, read_aircraft, target_system_option
from advisor.words.printable import printable
from advisor.words.problems import ConfigurationError, UnusableInputError


@click.group
def command() -> None:
    """Check your own simulator: signs, units, trim and responses.

    \b
    Example:
      advisor simulator check jsbsim:c172p --airspeed 50 --height 1000
      advisor simulator check fmu:plane.fmu --aircraft my-aircraft.yaml
      advisor simulator fly flight.tlog --master tcp:127.0.0.1:5760
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
    from advisor.report.simulator_check import document, lines
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


@command.command
@click.argument("log", type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option("--master", required=True, metavar="CONN", help="Connection of the simulated vehicle.")
@target_system_option
def fly(log: Path, master: str, target_system: int | None) -> None:
    """Replay the sticks of a flight into a simulation of ArduPilot or PX4, as an override of its receiver.

    The log's RC_CHANNELS are sent at their recorded times. Nothing is sent to a vehicle without a parameter
    that only a simulation has. First fly the simulation straight and level in MANUAL, and record it. The log
    of the simulation then serves as --simulator log:FILE.

    \b
    Example:
      advisor simulator fly flight.tlog --master tcp:127.0.0.1:5760
    """
    from advisor.analysis.sticks import sticks_of
    from advisor.mavlink.link.link import Link
    from advisor.mavlink.link.stick_replay import StickReplay

    recorded = sticks_of(log)
    replay = StickReplay(recorded.t, recorded.pulses)
    click.echo(f"{recorded.t[-1]:.0f} s of sticks go to {printable(master)}; Ctrl-C ends them.", err=True)
    with Link(master, target_system=target_system, talkers=[replay]) as link:
        while not replay.done:
            link.read(0.02)
            for notice in link.take_notices():
                click.echo(printable(notice), err=True)
    if replay.refused:
        raise UnusableInputError(
            "no_simulation",
            f"The vehicle on {master} has no parameter of a simulation: nothing was sent.",
            "Start ArduPilot's or PX4's software in the loop on this connection.",
        )


def _speed_of(aircraft: Aircraft) -> float:
    """Return the air speed that the aircraft file states; refuse a file that states none."""
    if aircraft.stated_airspeed_m_s is None:
        raise ConfigurationError(
            "advisor simulator check needs an air speed: "
            "give --airspeed, or airspeed_m_s in the aircraft file."
        )
    return aircraft.stated_airspeed_m_s
