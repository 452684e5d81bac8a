"""Run the ablation, or write its table."""

import argparse
import os
import random
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from benchmarks.ablation import instrument
from benchmarks.ablation.again import again
from benchmarks.ablation.corpus import Corpus, compact
from benchmarks.ablation.forks import Forks
from benchmarks.ablation.table import table
from benchmarks.ablation.tally import Tally

_ORDER = 0
"""Seed of the order of cases: every part of a run is a sample of all sets."""


def answer(case: Path) -> dict[str, Any]:
    """What the diagnosis says of a case, from log and aircraft file."""
    from advisor.analysis.gap import diagnose_logs
    from advisor.cli.options import read_aircraft
    from advisor.gap.document import gap_document
    from advisor.words.problems import UnusableInputError

    try:
        found = gap_document(diagnose_logs([case / "flight.tlog"], read_aircraft(case / "aircraft.yaml")))
    except UnusableInputError as error:
        return {"failed": error.problem.code}
    return compact(found)


def run(corpus: Corpus, raw: Path, only: Sequence[str], limits: bool, processes: int) -> None:
    """Answer every case that ``raw`` has no answer of, with all rules and without each that speaks."""
    instrument.install(limits)
    import advisor.analysis.gap  # noqa: F401
    import advisor.gap.verdict.answer as numbers

    # What is said of effects that cannot be seen takes a fifth of the time and no part in a verdict.
    numbers.unseen_effects = lambda *_: ()  # type: ignore[assignment]
    tally = Tally(corpus.keys(), only)
    tally.read(raw)
    cases = [case for case in corpus.cases() if f"{case.parent.name}/{case.name}" not in tally.answers]
    random.Random(_ORDER).shuffle(cases)
    running = 0
    for number, case in enumerate(cases, start=1):
        if running == processes:
            os.wait()
            running -= 1
            tally.read(raw)
        if os.fork() == 0:
            name = f"{case.parent.name}/{case.name}"
            instrument.forks = Forks(name, tally.is_closed, raw)
            instrument.forks.run(lambda case=case: answer(case))
        running += 1
        print(f"{number}/{len(cases)} {case.parent.name}/{case.name}", flush=True)
    for _ in range(running):
        os.wait()


def main() -> None:
    """Read the command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.ablation")
    parser.add_argument("what", choices=("run", "table", "again"))
    parser.add_argument("raw", type=Path)
    parser.add_argument("folders", type=Path, nargs="+")
    parser.add_argument("--only", nargs="*", default=[""], help="modules whose rules are taken out")
    parser.add_argument("--limits", action="store_true", help="comparisons with constants, too")
    parser.add_argument("--processes", type=int, default=1)
    parser.add_argument("--deleted", nargs="*", default=[""], help="rules that this tree has no more")
    parser.add_argument("--note", default="", help="date, commit and seeds, for the table")
    parser.add_argument("--write", type=Path, help="file for the table")
    options = parser.parse_args()
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    corpus = Corpus(tuple(options.folders))
    if options.what == "run":
        run(corpus, options.raw, options.only, options.limits, options.processes)
        return
    if options.what == "again":
        import advisor.analysis.gap  # noqa: F401

        for line in again(corpus, options.raw, options.write, options.deleted, answer):
            print(line, flush=True)
        return
    text = table(corpus, options.raw, options.note)
    print(text)
    if options.write:
        options.write.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
