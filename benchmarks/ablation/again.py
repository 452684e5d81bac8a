"""Answers of another tree to the cases in which deleted rules spoke: all other answers are as they were."""

import json
import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.ablation.corpus import Corpus, right, said


@dataclass(frozen=True)
class Before:
    """What a run answered with all rules."""

    answers: dict[str, dict[str, Any]]
    spoke: dict[str, list[str]]


def before(raw: Path) -> Before:
    """Answers of a run, and which rules spoke in each."""
    lines = [json.loads(line) for line in raw.read_text(encoding="utf-8").splitlines()]
    whole = [line for line in lines if line["without"] is None]
    return Before({w["case"]: w["answer"] for w in whole}, {w["case"]: w["spoke"] for w in whole})


def again(
    corpus: Corpus, raw: Path, out: Path, deleted: Sequence[str], answer: Callable[[Path], dict[str, Any]]
) -> Iterator[str]:
    """Answer anew every case in which a deleted rule spoke; yield what changed.

    ``deleted`` are beginnings of rules' names.
    """
    was, keys = before(raw), corpus.keys()
    found = dict(_lines(out))
    affected = {name for name, rules in was.spoke.items() if any(r.startswith(tuple(deleted)) for r in rules)}
    for case in corpus.cases():
        name = f"{case.parent.name}/{case.name}"
        if name not in affected:
            continue
        if name not in found:
            if os.fork() == 0:
                with out.open("a", encoding="utf-8") as lines:
                    lines.write(json.dumps({"case": name, "answer": answer(case)}) + "\n")
                os._exit(0)
            os.wait()
            found = dict(_lines(out))
        now = found.get(name, {"failed": "no answer"})
        if said(now) != said(was.answers[name]):
            verdicts = (right(keys[name], was.answers[name]), right(keys[name], now))
            change = {(True, False): "WORSE", (False, True): "BETTER"}.get(verdicts, "")
            yield f"{name}: {said(was.answers[name])} -> {said(now)} {change}".rstrip()
    yield f"{len(affected)} of {len(was.answers)} cases affected"


def _lines(out: Path) -> Iterator[tuple[str, dict[str, Any]]]:
    if out.exists():
        for line in out.read_text(encoding="utf-8").splitlines():
            yield (found := json.loads(line))["case"], found["answer"]
