"""Answer sealed cases of any generator with the diagnosis of ``advisor gap``, from the logs alone.

    python -m sim blind --cases 300 --seed S --out cases
    python -m benchmarks.sealed.answer cases answers.jsonl --workers 8
    python -m sim commit cases answers.jsonl
    python -m sim reveal cases answers.jsonl --details

A process is given the log and the aircraft file of a case and nothing else. An interrupted run goes on where
it stopped. With ``--scheduler tcp://host:8786`` the workers of a Dask cluster answer; they see the cases
under the same absolute path.
"""

import json
import sys
import time
from pathlib import Path
from typing import Any

import click

from advisor.cli.running import Progress, runner_of, running_options


def answer(case: Path, axis: str = "pitch") -> tuple[dict[str, Any], float]:
    """Return the document of ``advisor gap --json`` (empty without one), and the CPU time in s."""
    from advisor.analysis.axis_flown import compare_side_flown
    from advisor.analysis.gap import compare_logs
    from advisor.analysis.whole_flights import read_whole
    from advisor.cli.options import read_aircraft
    from advisor.report.gap_document import axis_document, gap_document
    from advisor.words.problems import UnusableInputError
    from sim.sealed.cases import AIRCRAFT, LOG

    began = time.process_time()
    aircraft = read_aircraft(case / AIRCRAFT)
    try:
        if axis == "pitch":
            document = gap_document(compare_logs([case / LOG], aircraft).diagnosis)
        else:
            state = read_whole([case / LOG], aircraft, axis="lateral").state
            document = axis_document(compare_side_flown(state, aircraft).diagnosis)
    except UnusableInputError as error:
        print(f"{case.name}: {error.problem}", file=sys.stderr)
        document = {}
    return document, time.process_time() - began


@click.command
@click.argument("folder", type=click.Path(path_type=Path, exists=True, file_okay=False))
@click.argument("answers", type=click.Path(path_type=Path, dir_okay=False))
@running_options
def main(folder: Path, answers: Path, workers: int | None, scheduler: str | None) -> None:
    """Answer every case of FOLDER that has no answer in ANSWERS yet."""
    answered = set()
    if answers.exists():
        answered = {json.loads(line)["case"] for line in answers.read_text(encoding="utf-8").splitlines()}
    cases = sorted(
        path for path in folder.absolute().iterdir() if path.is_dir() and path.name not in answered
    )
    run, progress = runner_of(workers, scheduler), Progress(len(cases), "cases")
    with answers.open("a", encoding="utf-8") as out:
        for case, result in run(answer, cases):
            if isinstance(result, Exception):
                raise result
            document, seconds = result
            line = {"case": case.name, "answer": document, "cpu_s": round(seconds, 2)}
            out.write(json.dumps(line) + "\n")
            out.flush()
            print(f"{case.name} {document.get('verdict', 'no answer')} {seconds:.1f} s")
            progress.advance()


if __name__ == "__main__":
    main()
