"""The ablation takes one rule out at a time, and counts what that does to verdicts."""

import ast
import json
import os
from pathlib import Path

import pytest

from benchmarks.ablation.corpus import right, said
from benchmarks.ablation.forks import Forks
from benchmarks.ablation.instrument import rules_in
from benchmarks.ablation.table import sizes
from benchmarks.ablation.tally import Tally

NONE = {"verdict": "none", "causes": [], "waterfall": [], "where": {"block": "air"}}
UNKNOWN = NONE | {"verdict": "unknown"}
TRUTH = {
    "group": "none", "effects": {}, "blocks": [], "gap": 0.0, "hard": False, "background": [],
}  # fmt: skip


def test_a_rule_says_yes_or_no_or_finds_something_or_hands_back_what_came_in() -> None:
    tree = ast.parse(
        "def yes(a: int) -> bool: ...\ndef finding(a: int) -> str | None: ...\n"
        "def better(p: int, stages: list[Stage]) -> list[Stage]: ...\ndef size(a: float) -> float: ..."
    )
    assert [(name, kind) for name, _, kind in rules_in(tree)] == [
        ("yes", "bool"), ("finding", "None"), ("better", "stages"),
    ]  # fmt: skip


def test_a_case_is_answered_once_with_every_rule_and_once_without_each_that_spoke(tmp_path: Path) -> None:
    raw = tmp_path / "raw.jsonl"
    if os.fork() == 0:
        forks = Forks("set/1", lambda rule: rule == "closed", raw)

        def answer() -> dict[str, object]:
            forks.heard("closed", True, False)
            return {
                "found": [forks.heard("a", 1, None), forks.heard("b", 2, None), forks.heard("a", 1, None)]
            }

        forks.run(answer)
    os.wait()
    lines = [json.loads(line) for line in raw.read_text(encoding="utf-8").splitlines()]
    assert [(line["without"], line["answer"]["found"]) for line in lines] == [
        ("a", [None, 2, None]), ("b", [1, None, 1]), (None, [1, 2, 1]),
    ]  # fmt: skip
    assert lines[-1]["spoke"] == ["a", "b", "closed"]


def test_a_flip_is_counted_with_what_it_does_to_a_right_verdict(tmp_path: Path) -> None:
    raw = tmp_path / "raw.jsonl"
    lines = [
        {"case": "set/1", "without": "rule", "answer": UNKNOWN},
        {"case": "set/1", "without": None, "answer": NONE, "spoke": ["rule"]},
    ]
    raw.write_text("".join(json.dumps(line) + "\n" for line in lines), encoding="utf-8")
    tally = Tally({"set/1": TRUTH})
    tally.read(raw)
    count = tally.counts["rule"]
    assert (count.spoke, count.tried, count.flips, count.worse, count.better) == (1, 1, 1, 1, 0)
    assert count.per_thousand(len(tally.answers)) == pytest.approx(1000.0)


def test_an_answer_is_told_by_verdict_first_cause_or_block_and_all_that_is_present() -> None:
    causes = [{"effect": "gust", "in_model": True}, {"effect": "icing", "in_model": False}]
    assert said(NONE | {"verdict": "effect", "causes": causes}) == ("effect", "gust", ("gust",))
    assert said(UNKNOWN) == ("unknown", "air", ())


def test_a_diagnosis_that_fails_without_a_rule_is_not_right() -> None:
    assert right(TRUTH, NONE)
    assert not right(TRUTH, {"failed": "ValueError"})


def test_the_table_knows_the_private_names_that_go_with_a_rule() -> None:
    found = sizes()
    assert all(size.lines > 0 for size in found.values())
    assert max(size.constants for size in found.values()) > 2
