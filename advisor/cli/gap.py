"""``advisor gap``: why the real aircraft does not fly like the simulator."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from advisor.cli.gap_asked import refuse_figure
from advisor.cli.improvement_export import export_option, orders_of
from advisor.cli.options import LogsAsked, decided_on, json_option, log_options, refuse_unwritable
from advisor.cli.proving import prove_option, refuse_proving
from advisor.cli.running import Stages
from advisor.words.problems import ConfigurationError

if TYPE_CHECKING:
    from advisor.aircraft.aircraft import Aircraft
    from advisor.analysis.axis_flown import AxisFlown
    from advisor.campaign.state import ByHand
    from advisor.exports.models.formats import AxisAsked

_LATERAL = (
    "No manoeuvre of the elevator is accepted, but some of the aileron or the rudder are: "
    "the diagnosis is of roll and yaw."
)


@click.command
@log_options("marks", "no_marks", "fixes", "terms", required=False)
@click.option(
    "--holdout",
    type=click.IntRange(1),
    help="Number of last manoeuvres to hold out. The gap is measured in them, and the fit uses the other "
    "manoeuvres.",
)
@click.option(
    "--simulator",
    "specification",
    metavar="SPEC",
    help="Your own simulator: linear, jsbsim:MODEL, fmu:FILE, python:module:factory or log:FILE.",
)
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    help="File for the improved simulator. Without this option none is written.",
)
@click.option(
    "--figure",
    type=click.Path(path_type=Path),
    help="File for the picture: measured, simulated before and after. Ends in .svg or .png.",
)
@export_option()
@click.option(
    "--axis",
    type=click.Choice(["pitch", "lateral", "both"]),
    help="Axis to diagnose. Default: the axes that were flown.",
)
@click.option(
    "--all",
    "everything",
    is_flag=True,
    help="Print also the gap in time and by channel, the notes, and what the flight could not show.",
)
@prove_option
@click.option(
    "--why",
    is_flag=True,
    help="Print the evidence for the answer, and the statistics of the decision with their limits.",
)
@click.option(
    "--prior",
    metavar="SHARES",
    help="Prior probability of each kind of answer: none=40,parameters=20,effect=30,unknown=10.",
)
@json_option
def command(
    asked: LogsAsked,
    holdout: int | None,
    specification: str | None,
    out: Path | None,
    figure: Path | None,
    exports: tuple[str, ...],
    axis: "AxisAsked | None",
    everything: bool,
    proving: tuple[str, ...],
    why: bool,
    prior: str | None,
    as_json: bool,
) -> int:
    """Diagnose the sim-to-real gap: its place, the effect that causes it, and how much a correction reduces
    it.

    \b
    Example:
      advisor gap flight.tlog --aircraft my-aircraft.yaml
      advisor gap flight-1.tlog flight-2.tlog --holdout 3 --json
      advisor gap flight.tlog --maneuver +12:+24
      advisor gap flight.tlog --aircraft my-aircraft.yaml --export matlab:short-period.m
      advisor gap flight.tlog --simulator jsbsim:c172p
      advisor gap flight.tlog --aircraft my-aircraft.yaml --prove
      advisor gap flight.tlog --aircraft my-aircraft.yaml --axis lateral
      advisor gap flight.tlog --axis both
      advisor gap flight.tlog --aircraft my-aircraft.yaml --term "M:q*abs(q)"
    """
    if axis == "lateral":
        _refuse_holdout()
    aircraft = asked.read_aircraft()
    refuse_proving(proving)
    if not asked.logs:
        raise ConfigurationError("advisor gap needs at least one log.")
    if specification is not None:
        aircraft = replace(aircraft, simulator=specification)
    if out is not None:
        _refuse_out(out, asked.aircraft_file)
    refuse_figure(figure, [*asked.inputs, out])
    from advisor.gap.inference.prior import FIELD, field_prior

    # Options are refused before the logs are read.
    shares = FIELD if prior is None else field_prior(prior)
    orders = orders_of(exports, aircraft, [*asked.inputs, out], axis or "pitch")
    decided = [decided_on(log, asked.no_marks) for log in asked.logs]
    by_hand = [replace(before, marks=(*asked.marks, *before.marks)) for before in decided]
    flown = None
    if axis is None:
        flown = _axis_flown(asked, aircraft, by_hand)
        axis = flown.axis
        if axis == "lateral":
            _refuse_holdout()
        orders = orders_of(exports, aircraft, [*asked.inputs, out], axis)
    from advisor.cli.gap_asked import GapAsked

    gap = GapAsked(asked, aircraft, shares, out, figure, orders, proving, why, as_json)
    from advisor.cli.axis_gap import AxisGap, PitchGap, SideGap, answered

    asked_for: list[AxisGap[Any]] = []
    if axis != "lateral":
        asked_for.append(PitchGap(gap, by_hand, holdout, flown and flown.elevator))
    if axis != "pitch":
        asked_for.append(SideGap(gap, flown and flown.state))
    return answered(asked_for, everything)


def _axis_flown(asked: LogsAsked, aircraft: "Aircraft", by_hand: "Sequence[ByHand]") -> "AxisFlown":
    """Return the axes to diagnose and the campaign read from the logs. Say so if only roll and yaw are
    diagnosed.
    """
    from advisor.analysis.axis_flown import axis_flown

    with Stages() as tell:
        tell("reading", 0.0)
        flown = axis_flown(asked.logs, aircraft, asked.target_system, by_hand, asked.marks, asked.no_marks)
    if flown.axis == "lateral":
        click.echo(_LATERAL, err=True)
    return flown


def _refuse_out(out: Path, aircraft_file: Path | None) -> None:
    """Refuse an improved file that could not be written, or that would replace the aircraft file."""
    refuse_unwritable("--out", out)
    if aircraft_file is not None and out.resolve() == aircraft_file.resolve():
        raise ConfigurationError(f"--out: {out} is the aircraft file itself; name another file.")


def _refuse_holdout() -> None:
    """Refuse the option of another axis, instead of ignoring it."""
    if click.get_current_context().get_parameter_source("holdout") is ParameterSource.COMMANDLINE:
        raise ConfigurationError("--holdout applies only with --axis pitch: leave it out.")
