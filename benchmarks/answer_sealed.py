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


class _Parent(multiprocessing.context.ForkProcess):
    """A process of a pool that may have a child: a simulator lives in a process of its own."""

    @property
    def daemon(self) -> bool:
        """Never, for a daemon may have no child."""
        return False

    @daemon.setter
    def daemon(self, value: bool) -> None:
        """Ignore what the pool sets."""


class _Parents(multiprocessing.context.ForkContext):
    """Forked processes that may have children."""

    Process = _Parent


def answer(case: Path) -> tuple[str, dict[str, Any], float]:
    """Return the case's name, the document of ``advisor gap --json`` (empty without one), CPU seconds."""
    from advisor.commands.options import read_aircraft
    from advisor.diagnosis import compare_logs, named_simulator
    from advisor.gap.document import gap_document
    from advisor.problems import UnusableInputError

    began = time.process_time()
    aircraft = read_aircraft(case / "aircraft.yaml")
    simulator = named_simulator(aircraft)
    try:
        document = gap_document(compare_logs([case / "flight.tlog"], aircraft, simulator).diagnosis)
    except UnusableInputError as error:
        print(f"{case.name}: {error.problem}", file=sys.stderr)
        document = {}
    finally:
        if simulator is not None:
            simulator.close()
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

    with answers.open("a", encoding="utf-8") as out, _Parents().Pool(PROCESSES, maxtasksperchild=1) as pool:
        for number, (name, document, seconds) in enumerate(pool.imap_unordered(answer, cases), start=1):
            out.write(json.dumps({"case": name, "answer": document, "cpu_s": round(seconds, 2)}) + "\n")
            out.flush()
            print(f"{number}/{len(cases)} {name} {document.get('verdict', 'no answer')} {seconds:.1f} s")


if __name__ == "__main__":
    main()
