"""``python -m sim``: fly the bundled aircraft on a link, or record its telemetry."""

import json
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import click

from .effects.fitting import flight_of
from .flight import Flight
from .lateral import lateral_flight
from .loading import ScenarioError
from .modelled import modelled_flight
from .scenario import Scenario, read_scenario
from .sealed.seal import SealError
from .trim import TrimError


def _speed(text: str) -> float | None:
    if text == "max":
        return None
    try:
        speed = float(text)
    except ValueError:
        speed = 0.0
    if not speed > 0.0:
        raise click.BadParameter("give a factor above 0, or max", param_hint="--speed")
    return speed


def _flown(options: dict[str, Any]) -> Flight:
    path = options["scenario"]
    scenario = read_scenario(path) if path else Scenario()
    changes = {key: options[key] for key in ("seed", "aircraft", "engine") if options[key] is not None}
    scenario = replace(scenario, **changes)
    replayed = options["replay_inputs"]
    if options["plan"] == "lateral":
        return lateral_flight(scenario)
    if Path(scenario.aircraft).suffix in (".yaml", ".yml"):
        return modelled_flight(scenario, Path(scenario.aircraft), replayed)
    if replayed is not None:
        raise click.UsageError("--replay-inputs needs --aircraft FILE (an aircraft file with its model)")
    return flight_of(scenario)


def _flight_options(command: Callable[..., None]) -> Callable[..., None]:
    for option in (
        click.option(
            "--scenario",
            type=click.Path(path_type=Path),
            help="Scenario file (YAML). Default: the paper's campaign.",
        ),
        click.option("--aircraft", help="uav, light, linear, or an aircraft file. With JSBSim, e.g. c172p."),
        click.option("--engine", type=click.Choice(["bundled", "jsbsim"]), help="Flight dynamics engine."),
        click.option(
            "--replay-inputs",
            type=click.Path(path_type=Path),
            help="Log whose elevator commands are flown again.",
        ),
        click.option(
            "--plan",
            type=click.Choice(["pitch", "lateral"]),
            default="pitch",
            show_default=True,
            help="Plan of the flight: inputs of the elevator, or of aileron and rudder.",
        ),
        click.option(
            "--seed", type=click.IntRange(0), help="Seed of the noise. Equal seeds give equal bytes."
        ),
    ):
        command = option(command)
    return command


@click.group()
def main() -> None:
    """Fly the bundled aircraft: over a MAVLink link, or into a telemetry log."""


@main.command()
@click.option(
    "--master", default="udpout:127.0.0.1:14550", show_default=True, help="Connection, as in pymavlink."
)
@click.option("--speed", default="1", show_default=True, help="Multiple of real time, or max.")
@_flight_options
def fly(master: str, speed: str, **options: Any) -> None:
    """Fly over a MAVLink link.

    Example: python -m sim fly --master udpout:127.0.0.1:14550 --speed 10
    """
    from .fly import serve

    factor = _speed(speed)
    sent = serve(_flown(options), master, factor, tell=lambda text: click.echo(text, err=True))
    click.echo(f"landed after {sent} messages", err=True)


@main.command()
@click.option("--out", type=click.Path(path_type=Path), required=True, help="File for the log.")
@_flight_options
def record(out: Path, **options: Any) -> None:
    """Write a flight as a .tlog.

    Example: python -m sim record --out flight.tlog --seed 7
    """
    from .record import record as write

    flight = _flown(options)
    count = write(flight, out)
    click.echo(f"{out}: {flight.duration_s:.0f} s of flight, {count} messages", err=True)


@main.command()
@click.argument("flight", type=click.Path(path_type=Path, exists=True))
@click.argument("replays", type=click.Path(path_type=Path, exists=True), nargs=-1, required=True)
def compare(flight: Path, replays: tuple[Path, ...]) -> None:
    """Print the differences between a flight and replays of its inputs.

    \b
    Example: python -m sim record --aircraft now.yaml      --replay-inputs flight.tlog --out now.tlog
             python -m sim record --aircraft improved.yaml --replay-inputs flight.tlog --out improved.tlog
             python -m sim compare flight.tlog now.tlog improved.tlog
    """
    from .compare import distances

    for replay in replays:
        for apart in distances(flight, replay):
            share = 100.0 * apart.difference / apart.signal if apart.signal else 0.0
            said = (
                f"{apart.channel:6s} {apart.difference:.3g} {apart.unit} apart, {share:.1f} % of the signal"
            )
            click.echo(f"{replay}: {said}")


@main.command()
@click.option("--cases", default=100, show_default=True, help="Number of cases.")
@click.option(
    "--seed",
    required=True,
    type=click.IntRange(0),
    help="Seed of all draws. Keep the seed secret from the person who answers.",
)
@click.option("--out", type=click.Path(path_type=Path), required=True, help="Folder for the logs.")
@click.option("--only", multiple=True, help="Groups to draw from: clean, hard, jsbsim, none, ...")
def blind(cases: int, seed: int, out: Path, only: tuple[str, ...]) -> None:
    """Write flights whose effect is withheld, and seal the key next to the folder.

    Example: python -m sim blind --cases 200 --seed 11 --out cases
    """
    from .blind.draw import GROUPS
    from .blind.generate import generate
    from .sealed.cases import key_beside

    unknown = [name for name in only if name not in GROUPS]
    if unknown:
        raise click.BadParameter(
            f"{', '.join(unknown)}: choose from {', '.join(GROUPS)}", param_hint="--only"
        )
    chosen = [group for group in GROUPS if not only or group in only]
    digest = generate(
        cases, seed, out, chosen, tell=lambda text: click.echo(f"\r{text}  ", err=True, nl=False)
    )
    click.echo(f"\nsealed {cases} cases, key {key_beside(out)}, hash {digest}", err=True)


@main.command()
@click.argument("folder", type=click.Path(path_type=Path, exists=True))
@click.argument("answers", type=click.Path(path_type=Path, exists=True))
def commit(folder: Path, answers: Path) -> None:
    """Commit answers by their hash, before the key is opened.

    ANSWERS holds one JSON object a line: {"case": NAME, "answer": document of advisor gap --json}.
    """
    from .sealed.seal import commit as commit_answers

    click.echo(commit_answers(folder, answers))


@main.command()
@click.argument("folder", type=click.Path(path_type=Path, exists=True))
@click.argument("answers", type=click.Path(path_type=Path, exists=True))
@click.option(
    "--key",
    type=click.Path(path_type=Path, exists=True),
    help="File of the key. Default: next to the folder.",
)
@click.option("--details", is_flag=True, help="Print each effect and every wrong answer as well.")
@click.option("--json", "as_json", is_flag=True, help="Print the figures as one JSON document.")
def reveal(folder: Path, answers: Path, key: Path | None, details: bool, as_json: bool) -> None:
    """Open the key and score committed answers, with 95 % intervals."""
    from .sealed.cases import key_beside
    from .sealed.reveal import report, score_document

    opened = key or key_beside(folder)
    if as_json:
        click.echo(json.dumps(score_document(folder, answers, opened), indent=1))
        return
    for line in report(folder, answers, opened, details):
        click.echo(line)


def run(arguments: Sequence[str] | None = None) -> None:
    """Run the command. A user's mistake ends with exit code 2 and one sentence."""
    name = f"python -m {__package__}"  # a wheel installs this package under another name
    for each in main.commands.values():
        each.help = (each.help or "").replace("python -m sim", name)
    try:
        main(arguments, prog_name=name)
    except ScenarioError as error:
        for problem in error.problems:
            click.echo(f"error: {problem}", err=True)
        sys.exit(2)
    except (TrimError, SealError, OSError) as error:
        click.echo(f"error: {error}", err=True)
        sys.exit(2)


if __name__ == "__main__":
    run()
