"""``advisor script``: write the test inputs as a script that the autopilot flies."""

import json
from pathlib import Path
from typing import TYPE_CHECKING

import click

from advisor.aircraft.aircraft import Aircraft
from advisor.cli.options import (
    UNUSABLE,
    aircraft_option,
    json_option,
    read_aircraft,
    refuse_unwritable,
    target_system_option,
    writing,
)
from advisor.words.problems import ConfigurationError, UnusableInputError, printable

if TYPE_CHECKING:
    from advisor.scripts.table import ScriptTable, Source

AUTOPILOTS = ("ardupilot",)
OPTIONS = range(300, 308)
"""Values of RCn_OPTION that ArduPilot keeps for scripts."""


def _inputs(_: click.Context, __: click.Parameter, text: str | None) -> tuple[str, ...]:
    """Read the names of ``--inputs``; all inputs without the option."""
    from advisor.scripts.inputs import NAMES

    if text is None:
        return NAMES
    names = tuple(name.strip() for name in text.split(","))
    unknown = [name for name in names if name not in NAMES]
    if unknown:
        raise ConfigurationError(f"--inputs: {unknown[0]!r} is no input; choose from {', '.join(NAMES)}.")
    return names


def _switch(_: click.Context, __: click.Parameter, channel: int) -> int:
    if not (1 <= channel <= 16 or channel in OPTIONS):
        raise ConfigurationError(
            f"--switch: {channel} is no channel; give 1 to 16, or the RCn_OPTION 300 to 307 of a channel."
        )
    return channel


@click.command
@click.argument("autopilot", type=click.Choice(AUTOPILOTS))
@click.argument("log", required=False, type=click.Path(path_type=Path))
@click.option(
    "-o", "--out", type=click.Path(path_type=Path), required=True, metavar="FILE.lua", help="File to write."
)
@aircraft_option
@click.option(
    "--period",
    "period_s",
    type=click.FloatRange(0.2, 10.0),
    metavar="S",
    help="Short period of the aircraft, s. This value replaces that of the file's model and of the log.",
)
@click.option(
    "--switch",
    type=int,
    default=7,
    show_default=True,
    metavar="CHANNEL",
    callback=_switch,
    help="Radio channel of the switch. Above 1700 us the next input starts, and below 1300 us the input "
    "ends at once.",
)
@click.option(
    "--inputs",
    "names",
    metavar="NAME[,NAME...]",
    callback=_inputs,
    help="Inputs in the order of flight: 3-2-1-1, reverse 3-2-1-1, aileron doublet, rudder doublet, "
    "aileron 1-2-1, multisine. Default: all.",
)
@click.option(
    "--lowest",
    "lowest_m",
    type=click.FloatRange(0.0, 5000.0),
    default=30.0,
    show_default=True,
    metavar="M",
    help="Height above home below which no input is flown, m. 0 makes a script for the check on the ground.",
)
@target_system_option
@json_option
def command(
    autopilot: str,
    log: Path | None,
    out: Path,
    aircraft_file: Path | None,
    period_s: float | None,
    switch: int,
    names: tuple[str, ...],
    lowest_m: float,
    target_system: int | None,
    as_json: bool,
) -> int:
    """Write a script that flies the test inputs, for the autopilot's own scripting engine.

    Time constants come from --period, the aircraft file's model, the log's estimate, or usual values. A
    switch starts each input. The switch, a stick, a change of mode and every limit end an input at once.

    \b
    Example:
      advisor script ardupilot -o inflight.lua --aircraft my-aircraft.yaml
      advisor script ardupilot flight.tlog -o inflight.lua --inputs multisine
    """
    from advisor.process.atomic_file import write_atomically
    from advisor.scripts.ardupilot import ardupilot_script
    from advisor.scripts.document import script_document
    from advisor.scripts.table import FlightLimits, script_table

    refuse_unwritable("-o", out)
    aircraft = read_aircraft(aircraft_file)
    try:
        source = _source(log, aircraft, target_system)
        limits = FlightLimits.of(aircraft, lowest_m)
        table = script_table(aircraft, source, names, period_s, switch, limits)
        left_out = _left_out(names, table, source)
    except UnusableInputError as error:
        if as_json:
            click.echo(json.dumps(script_document(None, str(out), error.problems), indent=1))
        click.echo(str(error), err=True)
        return UNUSABLE
    with writing("-o", out):
        write_atomically(out, ardupilot_script(table))
    if as_json:
        click.echo(
            json.dumps(script_document(table, str(out)), indent=1, ensure_ascii=False, allow_nan=False)
        )
    else:
        _print(table, out)
    for sentence in left_out:
        click.echo(sentence, err=True)
    return 0


def _source(log: Path | None, aircraft: Aircraft, target_system: int | None) -> "Source":
    from advisor.analysis.script_source import source_of_file, source_of_log

    return source_of_file(aircraft) if log is None else source_of_log(log, aircraft, target_system)


def _left_out(names: tuple[str, ...], table: "ScriptTable", source: "Source") -> list[str]:
    """Return sentences on inputs that the aircraft cannot fly.

    Raises
    ------
    UnusableInputError
        The aircraft can fly none of the inputs.
    """
    from advisor.scripts.inputs import CONTROLS

    absent = [control for control in CONTROLS if control not in source.controls]
    left_out = [name for name in names if name not in {entry.test.name for entry in table.entries}]
    lacking = f"The log states no output for the {' and the '.join(absent)}"
    keys = " and ".join(f"{control}.output" for control in absent)
    fix = f"Set SERVOn_FUNCTION, or give {keys} in the aircraft file."
    if not table.entries:
        raise UnusableInputError("no_output", f"{lacking}.", fix)
    return [f"{lacking}: {', '.join(left_out)} left out. {fix}"] if left_out else []


def _print(table: "ScriptTable", out: Path) -> None:
    from advisor.scripts.document import lines_of

    identity = table.identity
    click.echo(f"Wrote {printable(str(out))} for {identity.name} (calibration {identity.calibration}).")
    for line in lines_of(table):
        click.echo(f"  {line}")
    switch = f"channel {table.switch}" if table.switch < 300 else f"the channel of RCn_OPTION {table.switch}"
    click.echo(f"Switch: {switch}, above 1700 us starts the next input, below 1300 us ends it at once.")
    click.echo(
        "Next: copy the file to APM/scripts on the vehicle's card, set SCR_ENABLE 1, and restart the vehicle."
    )
    click.echo("Try the switch on the ground with the propeller off. Fly the first input high.")
