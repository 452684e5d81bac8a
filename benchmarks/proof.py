"""Is the gap gone on manoeuvres that no fit has used, once the simulator is improved?

    python -m benchmarks.proof FLIGHT.tlog ...

Each log has its aircraft file next to it, with the ending ``.yaml``. Printed are the gap of the kept
manoeuvres before and after the improvement, the first answer, and the answer to the improved simulator.
"""

from collections.abc import Sequence
from pathlib import Path

import click

from advisor.analysis.gap import compare_flown, named_simulator
from advisor.analysis.gap_flights import maneuvers_of
from advisor.cli.options import decided_on, read_aircraft
from advisor.exports.models.axes.prove_pitch import prove
from advisor.exports.models.proof import Proof
from advisor.words.problems import UnusableInputError


@click.command
@click.argument("logs", nargs=-1, required=True, type=click.Path(exists=True, path_type=Path))
def main(logs: Sequence[Path]) -> None:
    """Prove the improvement of every log, and count the second answers."""
    proofs: list[Proof] = []
    for log in logs:
        aircraft = read_aircraft(log.with_suffix(".yaml"))
        try:
            flown = maneuvers_of([log], aircraft, None, [decided_on(log, False)])
            whole = compare_flown(flown, aircraft, named_simulator(aircraft))
            found = prove(flown, None, aircraft, whole=whole)
        except UnusableInputError as error:
            click.echo(f"{log.stem:28} {error.problem.code}")
            continue
        proofs.append(found)
        taken = f", taken back: {', '.join(found.taken_back)}" if found.taken_back else ""
        answers = f"{found.first} -> {found.second}{taken}"
        click.echo(f"{log.stem:28} {found.before:10.2f} -> {found.after:8.2f}   {answers}")
    closed = sum(proof.is_closed for proof in proofs)
    less = sum(proof.after < proof.before for proof in proofs)
    click.echo(f"none or numbers after {closed} of {len(proofs)} improvements; a smaller gap after {less}")


if __name__ == "__main__":
    main()
