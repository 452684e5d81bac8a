"""Development cases, what is true of them, and what of an answer is compared."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.second_generator.score import Table, score_case
from sim.blind.score import is_right, judge


@dataclass(frozen=True)
class Corpus:
    """Folders of drawn cases."""

    folders: tuple[Path, ...]

    def cases(self) -> list[Path]:
        """Folders of all cases."""
        return [p for folder in self.folders for p in sorted(folder.iterdir()) if p.is_dir()]

    def keys(self) -> dict[str, dict[str, Any]]:
        """What is true of each case, by set and number, as ``mixed/0001``."""
        found = {}
        for folder in self.folders:
            key = json.loads(folder.with_name(f"{folder.name}.key.json").read_text(encoding="utf-8"))
            truths = key["cases"] if "cases" in key else key["key"]
            found |= {f"{folder.name}/{number}": truth for number, truth in truths.items()}
        return found


def compact(document: Mapping[str, Any]) -> dict[str, Any]:
    """What of a document the scores read."""
    causes = [{"effect": c["effect"], "in_model": c["in_model"]} for c in document["causes"]]
    steps = [{"effect": step["effect"]} for step in document["waterfall"]]
    where = {"block": document["where"]["block"]}
    return {"verdict": document["verdict"], "causes": causes, "waterfall": steps, "where": where}


def said(answer: Mapping[str, Any]) -> tuple[Any, ...]:
    """Verdict, the first cause that is present or the block, and all causes that are."""
    if "failed" in answer:
        return ("failed",)
    present = [c["effect"] for c in answer["causes"] if c["in_model"]]
    first = present[0] if answer["verdict"] == "effect" and present else answer["where"]["block"]
    return answer["verdict"], first, tuple(sorted(present))


def right(truth: Mapping[str, Any], answer: Mapping[str, Any]) -> bool:
    """Whether an answer is right by the rules of the generator that drew the case."""
    if "failed" in answer:
        return False
    if "class" in truth:
        return score_case(Table(), "", dict(truth), dict(answer))
    return is_right(judge({"": truth}, {"": answer})[0])
