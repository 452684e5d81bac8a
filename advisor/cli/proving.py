"""``advisor gap --prove``: the improved simulator on manoeuvres that no fit has used."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from advisor.aircraft.aircraft import Aircraft
from advisor.cli.log_options import LogsAsked
from advisor.cli.options import decided_on
from advisor.cli.stages import Stages
from advisor.words.printable import printable
from advisor.words.problems import ConfigurationError, UnusableInputError

if TYPE_CHECKING:
    from advisor.analysis.side_gap import SideCompared
    from advisor.campaign.hand_decisions import ByHand
    from advisor.exports.models.proof import Proof
    from advisor.gap.inference.prior import FieldPrior

prove_option = click.option(
    "--prove",
    "proving",
    multiple=True,
    is_flag=False,
    flag_value="",
    metavar="[LOG]",
    help="Fly the improved simulator on manoeuvres that no fit has used: those of LOG, else the last third.",
)


def refuse_proving(proving: Sequence[str]) -> None:
    """Refuse a log that is not there, before any work.

    Raises
    ------
    ConfigurationError
        A log is missing.
    """
    missing = next((log for log in proving if log and not Path(log).is_file()), None)
    if missing is not None:
        raise ConfigurationError(f"--prove: there is no log {missing}; name another one, or none.")


def proof_of(
    proving: Sequence[str],
    asked: LogsAsked,
    by_hand: "Sequence[ByHand]",
    aircraft: Aircraft,
    prior: "FieldPrior",
) -> "Proof | None":
    """Return the proof that was asked for; None where none was, or where nothing can be proved, which is
    said."""
    if not proving:
        return None
    from advisor.analysis.gap import maneuvers_of
    from advisor.exports.models.proof import prove

    named = [Path(log) for log in proving if log]
    try:
        with Stages() as tell:
            tell("reading for the proof", 0.0)
            flown = maneuvers_of(asked.logs, aircraft, asked.target_system, by_hand)
            fresh = None
            if named:
                decided = [decided_on(log, asked.no_marks) for log in named]
                fresh = maneuvers_of(named, aircraft, asked.target_system, decided)
            return prove(flown, fresh, aircraft, asked.target_system, tell, prior)
    except UnusableInputError as error:
        click.echo(printable(str(error)), err=True)
        return None


def side_proof_of(
    proving: Sequence[str], asked: LogsAsked, compared: "SideCompared", prior: "FieldPrior"
) -> "Proof | None":
    """Return the proof of roll and yaw, as ``proof_of`` does."""
    if not proving:
        return None
    from advisor.analysis.side_gap import accepted_of
    from advisor.analysis.whole_flights import read_whole
    from advisor.exports.models.roll_and_yaw import prove_side

    named = [Path(log) for log in proving if log]
    try:
        with Stages() as tell:
            tell("flying for the proof", 0.0)
            fresh = None
            if named:
                read = read_whole(
                    named, compared.aircraft, asked.target_system, no_marks=asked.no_marks, axis="lateral"
                )
                fresh = accepted_of(read.state)
            return prove_side(compared, fresh, prior)
    except UnusableInputError as error:
        click.echo(printable(str(error)), err=True)
        return None


def document(proof: "Proof | None") -> dict[str, Any]:
    """Return the part ``proof`` of the document; empty without a proof."""
    from advisor.exports.models.proof import document as told

    return {} if proof is None else {"proof": told(proof)}


def print_proof(proof: "Proof | None", echo: Callable[[str], None] = click.echo) -> None:
    """Print a proof for people."""
    if proof is None:
        return
    from advisor.exports.models.proof import lines_of

    for line in lines_of(proof):
        echo(printable(line))
