"""``python -m sim``: fly the bundled aircraft on a link, or record its telemetry."""

import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import click

from sim.effects.fitting import flight_of
from sim.flight import Flight
from sim.loading import ScenarioError
from sim.modelled import modelled_flight
from sim.scenario import Scenario, read_scenario
from sim.trim import TrimError


def _speed(text: str) -> float | None:
    if text == "max":
        return None
    try:
        speed = float(text)
    except ValueError:
        speed = 0.0
    if speed <= 0.0:
        raise click.BadParameter("give a factor above 0, or max", param_hint="--speed")
    return speed


def _flown(options: dict[str, Any]) -> Flight:
    path = options["scenario"]
    scenario = read_scenario(path) if path else Scenario()
    changes = {key: options[key] for key in ("seed", "aircraft", "engine") if options[key] is not None}
    scenario = replace(scenario, **changes)
    replayed = options["replay_inputs"]
    if Path(scenario.aircraft).suffix in (".yaml", ".yml"):
        return modelled_flight(scenario, Path(scenario.aircraft), replayed)
    if replayed is not None:
        raise click.UsageError("--replay-inputs needs --aircraft FILE (an aircraft file with its model)")
    return flight_of(scenario)


def _flight_options(command: Callable[..., None]) -> Callable[..., None]:
    for option in (
        click.option(
            "--scenario", type=click.Path(path_type=Path), help="YAML file; default: the paper's campaign."
        ),
        click.option("--aircraft", help="uav, light, linear, an aircraft file; with JSBSim e.g. c172p."),
        click.option("--engine", type=click.Choice(["bundled", "jsbsim"]), help="Flight dynamics engine."),
        click.option(
            "--replay-inputs", type=click.Path(path_type=Path), help="Log whose elevator is flown again."
        ),
        click.option("--seed", type=int, help="Same seed, same bytes."),
    ):
        command = option(command)
    return command


@click.group()
def main() -> None:
    """The bundled aircraft: speaks MAVLink on a link, or writes a telemetry log."""


@main.command()
@click.option(
    "--master", default="udpout:127.0.0.1:14550", show_default=True, help="Connection, as in pymavlink."
)
@click.option("--speed", default="1", show_default=True, help="Times real time, or max.")
@_flight_options
def fly(master: str, speed: str, **options: Any) -> None:
    """Fly over a MAVLink link.

    Example: python -m sim fly --master udpout:127.0.0.1:14550 --speed 10
    """
    from sim.fly import serve

    factor = _speed(speed)
    sent = serve(_flown(options), master, factor, tell=lambda text: click.echo(text, err=True))
    click.echo(f"landed after {sent} messages", err=True)


@main.command()
@click.option("--out", type=click.Path(path_type=Path), required=True, help="Log to write.")
@_flight_options
def record(out: Path, **options: Any) -> None:
    """Write a flight as a .tlog.

    Example: python -m sim record --out flight.tlog --seed 7
    """
    from sim.record import record as write

    flight = _flown(options)
    count = write(flight, out)
    click.echo(f"{out}: {flight.duration_s:.0f} s of flight, {count} messages", err=True)


def run() -> None:
    """Run the command; mistakes of the user's end with exit code 2 and a sentence each."""
    try:
        main(prog_name="python -m sim", standalone_mode=True)
    except ScenarioError as error:
        for problem in error.problems:
            click.echo(f"error: {problem}", err=True)
        sys.exit(2)
    except (TrimError, OSError) as error:
        click.echo(f"error: {error}", err=True)
        sys.exit(2)


if __name__ == "__main__":
    run()
