"""``advisor gap --prove``: the improved simulator on manoeuvres that no fit has used."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from advisor.cli.running import Stages
from advisor.words.problems import ConfigurationError, UnusableInputError, printable

if TYPE_CHECKING:
    from advisor.exports.models.proof import Proof

prove_option = click.option(
    "--prove",
    "proving",
    multiple=True,
    is_flag=False,
    flag_value="",
    metavar="[LOG]",
    help="Fly the improved simulator on manoeuvres that no fit has used. Without LOG, "
    "these are the last third of the flight's manoeuvres.",
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
        raise ConfigurationError(f"--prove: cannot find the log {missing}; name another one, or none.")


def proof_of(
    proving: Sequence[str], prove: "Callable[[list[Path], Callable[[str, float], None]], Proof]"
) -> "Proof | None":
    """Return the proof; None if the user asked for none, or if nothing can be proved, whose reason is
    printed.

    Parameters
    ----------
    prove
        Function that proves on the given logs, or without logs on the last third of the flight. It reports
        its progress.
    """
    if not proving:
        return None
    try:
        with Stages() as tell:
            return prove([Path(log) for log in proving if log], tell)
    except UnusableInputError as error:
        click.echo(printable(str(error)), err=True)
        return None


def document(proof: "Proof | None") -> dict[str, Any]:
    """Return the part ``proof`` of the document; empty without a proof."""
    from advisor.exports.models.proof import document as told

    return {} if proof is None else {"proof": told(proof)}


def print_proof(proof: "Proof | None") -> None:
    """Print a proof for people."""
    if proof is None:
        return
    from advisor.exports.models.proof import lines_of

    for line in lines_of(proof):
        click.echo(printable(line))
