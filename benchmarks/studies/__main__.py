"""Studies beside the paper's, on the aircraft of ``advisor study``.

\b
    python -m benchmarks.studies paper --campaigns 500     # other readings of the paper's rules, two flaws
    python -m benchmarks.studies stops --campaigns 150     # does the rule information stop too early
    python -m benchmarks.studies advice --campaigns 100    # what following the advice saves
    python -m benchmarks.studies change --campaigns 400    # how soon a change of the aircraft is told
    python -m benchmarks.studies coverage --campaigns 60   # do intervals hold with faulty instruments

Equal seeds give equal studies, whatever ``--workers`` and ``--scheduler`` are.
"""

from collections.abc import Callable, Mapping
from typing import Any

import click

from advisor.bundled.study.run import Study
from advisor.cli.options import json_option
from advisor.cli.running import runner_of, running_options
from advisor.cli.study import campaign_options, fly, tell
from benchmarks.studies import reports
from benchmarks.studies.paper import paper

STUDIES: Mapping[str, Callable[[int, int], Study[Any, Any]]] = {
    "paper": paper,
    "stops": reports.early_stops,
    "advice": reports.advice,
    "change": reports.change,
    "coverage": reports.coverage,
}


@click.command(help=__doc__)
@click.argument("name", type=click.Choice(list(STUDIES)))
@campaign_options
@running_options
@json_option
def main(
    name: str, campaigns: int, seed: int, workers: int | None, scheduler: str | None, as_json: bool
) -> None:
    """Fly the study of this name, and print its report."""
    run = runner_of(workers, scheduler, guarded=False)
    tell(fly(STUDIES[name](campaigns, seed), run), as_json)


if __name__ == "__main__":
    main()
