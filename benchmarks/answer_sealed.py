"""Answer sealed cases of ``python -m sim blind`` with the diagnosis of ``advisor gap``, from the logs alone.

    python -m sim blind --cases 300 --seed S --out cases
    python -m benchmarks.answer_sealed cases answers.jsonl
    python -m sim commit cases answers.jsonl
    python -m sim reveal cases answers.jsonl --details

Each case is answered by a process of its own, forked from one that has read nothing, and is given a log and
an aircraft file and nothing else. An interrupted run goes on where it stopped.
"""

import json
import multiprocessing
import os
import sys
import time
from pathlib import Path
from typing import Any

PROCESSES = 2


def answer(case: Path) -> tuple[str, dict[str, Any], float]:
    """Return the case's name, the document of ``advisor gap --json`` (empty without one), CPU seconds."""
    from advisor.commands.options import read_aircraft
    from advisor.diagnosis import diagnose_logs
    from advisor.gap.document import gap_document
    from advisor.problems import UnusableInputError

    began = time.process_time()
    try:
        document = gap_document(diagnose_logs([case / "flight.tlog"], read_aircraft(case / "aircraft.yaml")))
    except UnusableInputError as error:
        print(f"{case.name}: {error.problem}", file=sys.stderr)
        document = {}
    return case.name, document, time.process_time() - began


def main() -> None:
    """Answer every case of a folder that has no answer yet."""
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    folder, answers = Path(sys.argv[1]), Path(sys.argv[2])
    answered = set()
    if answers.exists():
        answered = {json.loads(line)["case"] for line in answers.read_text(encoding="utf-8").splitlines()}
    cases = sorted(path for path in folder.iterdir() if path.is_dir() and path.name not in answered)
    # Imported before the fork, so that every process finds it ready.
    import advisor.diagnosis  # noqa: F401

    forked = multiprocessing.get_context("fork")
    with answers.open("a", encoding="utf-8") as out, forked.Pool(PROCESSES, maxtasksperchild=1) as pool:
        for number, (name, document, seconds) in enumerate(pool.imap_unordered(answer, cases), start=1):
            out.write(json.dumps({"case": name, "answer": document, "cpu_s": round(seconds, 2)}) + "\n")
            out.flush()
            print(f"{number}/{len(cases)} {name} {document.get('verdict', 'no answer')} {seconds:.1f} s")


if __name__ == "__main__":
    main()
