"""Hold the diagnosis to its verdicts on a corpus of flights whose keys are open.

    python -m benchmarks.corpus            # exit code 1 where more verdicts flip than are allowed
    python -m benchmarks.corpus --write    # the verdicts of today become the expected ones

Flights are drawn from their seeds into ``build/corpus``. ``benchmarks/corpus.json`` has what is expected of
each: the verdict, and the first cause or the block. Whoever changed the diagnosis looks at the verdicts that
flip, and stores them with ``--write`` where they are right.
"""

import json
import sys
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from advisor.cli.running import runner_of
from benchmarks.sealed.answer import answer
from benchmarks.second_generator.cases import cases as second
from benchmarks.third_generator.files import cases as third
from sim.blind.draw import GROUPS
from sim.blind.generate import draw
from sim.sealed.cases import SealedCase, key_beside, write_set

EXPECTED = Path(__file__).with_suffix(".json")
FOLDER = Path("build") / "corpus"
ALLOWED = 0.02
"""Share of the verdicts that may flip: an optimiser's last digits decide that many (other processors)."""

Verdict = list[str | None]
"""The verdict, and the first cause or the block."""


SETS: Mapping[str, Callable[[], Iterator[SealedCase]]] = {
    "own": lambda: draw(60, 530271946, GROUPS, natural_share=0.0),
    "second": lambda: second(60, 360127, natural_share=0.0),
    "third": lambda: third(40, 4545, natural_share=0.0),
}
"""Each with the draw of its flights, from a seed whose key is open. The flights have no natural nuisances."""


def verdict_of(document: Mapping[str, Any]) -> Verdict:
    """What is compared of a document of ``advisor gap --json``; empty where the log cannot serve."""
    if not document:
        return []
    verdict = document["verdict"]
    if verdict == "effect":
        return [verdict, document["causes"][0]["effect"]]
    return [verdict, document["where"]["block"] if verdict == "unknown" else None]


def answered() -> Iterator[tuple[str, Verdict]]:
    """Every flight of the corpus, drawn where it is not there yet, with its verdict."""
    cases = []
    for name, drawn in SETS.items():
        folder = FOLDER / name
        if not key_beside(folder).exists():
            write_set(folder, drawn())
        cases += sorted(path for path in folder.iterdir() if path.is_dir())
    for case, result in runner_of(None, None)(answer, cases):
        if isinstance(result, Exception):
            raise result
        document, _ = result
        yield f"{case.parent.name}/{case.name}", verdict_of(document)


def flips_in(found: Mapping[str, Verdict], expected: Mapping[str, Verdict]) -> list[str]:
    """A line for each flight whose verdict is not the expected one."""
    return [
        f"{case}: {expected.get(case)} became {verdict}"
        for case, verdict in found.items()
        if expected.get(case) != verdict
    ]


def main() -> int:
    """Exit code 1 where more verdicts flip than are allowed."""
    found: dict[str, Verdict] = {}
    for case, verdict in answered():
        found[case] = verdict
        print(f"{len(found)} {case} {verdict}", file=sys.stderr)
    if "--write" in sys.argv[1:]:
        EXPECTED.write_text(json.dumps(found, indent=0, sort_keys=True) + "\n", encoding="utf-8")
        return 0
    flips = flips_in(found, json.loads(EXPECTED.read_text(encoding="utf-8")))
    print(*flips, f"{len(flips)} of {len(found)} verdicts flipped; {ALLOWED:.0%} may.", sep="\n")
    return int(len(flips) > ALLOWED * len(found))


if __name__ == "__main__":
    sys.exit(main())
