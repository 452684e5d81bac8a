"""Counts of a running ablation: what each rule's absence did, and when enough is known of a rule."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.ablation.corpus import right, said

_NEEDED = 2
"""Least excess of verdicts that a deletion makes wrong over those it makes right, for a rule to stay."""
_TRIED, _OFTEN = 10, 0.2
"""Answers without a rule that are enough where it speaks in so many cases: a run without all rules that seem
needless confirms them together."""


@dataclass
class Count:
    """One rule."""

    spoke: int = 0
    """Cases in which it did."""
    tried: int = 0
    """Cases that were answered without it."""
    flips: int = 0
    worse: int = 0
    """Right answers that are wrong without the rule."""
    better: int = 0

    def per_thousand(self, answered: int) -> float:
        """Flips among a thousand cases, where not all in which the rule spoke were answered without it."""
        return 1000.0 * self.flips / max(self.tried, 1) * self.spoke / max(answered, 1)


class Tally:
    """Answers by case, and counts by rule."""

    def __init__(self, keys: Mapping[str, Mapping[str, Any]], only: Sequence[str] = ("",)) -> None:
        self.keys, self.only = keys, tuple(only)
        self.answers: dict[str, dict[str, Any]] = {}
        self.counts: dict[str, Count] = {}
        self.flipped: dict[str, list[str]] = {}
        self._pending: dict[str, list[dict[str, Any]]] = {}
        self._read = 0

    def read(self, raw: Path) -> None:
        """Count the lines of a file that were written since."""
        if not raw.exists():
            return
        with raw.open(encoding="utf-8") as lines:
            lines.seek(self._read)
            while (line := lines.readline()).endswith("\n"):
                self._read = lines.tell()
                self._count(json.loads(line))

    def _count(self, line: dict[str, Any]) -> None:
        """Children write before their parent: a case is counted when its whole answer is there.

        A case of another folder is not.
        """
        if line["case"] not in self.keys:
            return
        waiting = self._pending.setdefault(line["case"], [])
        if line["without"] is not None:
            waiting.append(line)
            return
        case, whole = line["case"], line["answer"]
        self.answers[case] = whole
        del self._pending[case]
        for rule in line["spoke"]:
            self.counts.setdefault(rule, Count()).spoke += 1
        was = right(self.keys[case], whole)
        for other in waiting:
            count = self.counts[other["without"]]
            count.tried += 1
            if said(other["answer"]) != said(whole):
                count.flips += 1
                now = right(self.keys[case], other["answer"])
                count.worse += was and not now
                count.better += now and not was
                change = f"{case}: {said(whole)} -> {said(other['answer'])}"
                self.flipped.setdefault(other["without"], []).append(change)

    def is_closed(self, rule: str) -> bool:
        """Whether a rule need not be tried again."""
        if not rule.startswith(self.only) or self._is_the_rare_answer(rule):
            return True
        count = self.counts.get(rule, Count())
        often = count.spoke > _OFTEN * max(len(self.answers), 1)
        return count.worse - count.better >= _NEEDED or (often and count.tried >= _TRIED)

    def _is_the_rare_answer(self, rule: str) -> bool:
        """Whether a rule would be forced to the answer that it gives less often; yes, before it speaks."""
        forced, _, answer = rule.rpartition(" = ")
        if not forced:
            return False
        here, there = (
            self.counts.get(f"{forced} = {way}", Count()).spoke
            for way in (answer == "True", answer != "True")
        )
        return here > there if here != there else answer == "True"
