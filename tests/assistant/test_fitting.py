"""An answer to an assistant is at most 20 kB and names what it leaves out."""

import json

import pytest

from advisor.assistant.folders import RefusedError
from advisor.assistant.server import part_of, written

LARGE = {
    "verdict": "effect",
    "model": {"M_alpha": {"value": -4.912345678901, "ci95": [-5.0, -4.8]}},
    "maneuvers": [{"number": k, "samples": list(range(500))} for k in range(40)],
}


def test_a_short_document_is_written_whole_and_without_indent() -> None:
    assert written({"a": [1, 2.5], "b": None}) == '{"a":[1,2.5],"b":null}'


def test_a_long_document_keeps_its_verdict_and_fits() -> None:
    told = written(LARGE)
    assert len(json.dumps(told, ensure_ascii=False).encode()) <= 19_800
    document = json.loads(told)
    assert document["verdict"] == "effect"
    assert document["model"]["M_alpha"]["value"] == -4.912346


def test_every_part_that_is_left_out_can_be_asked_for() -> None:
    document = json.loads(written(LARGE))
    *kept, last = document["maneuvers"][0]["samples"]
    assert kept == list(range(len(kept)))
    assert last == f"{500 - len(kept)} more; ask for part maneuvers.0.samples.{len(kept)} and so on"
    *shown, last = document["maneuvers"]
    assert [maneuver["number"] for maneuver in shown] == list(range(len(shown)))
    assert last == f"{40 - len(shown)} more; ask for part maneuvers.{len(shown)} and so on"
    assert json.loads(written(LARGE, "maneuvers.0.samples")) == list(range(500))


def test_a_part_that_is_too_long_is_shortened_as_well() -> None:
    assert len(json.dumps(written(LARGE, "maneuvers"), ensure_ascii=False).encode()) <= 19_800


def test_the_evidence_of_either_axis_is_answered_on_request_alone() -> None:
    document = {"evidence": [], "lateral": {"verdict": "none", "evidence": [1, 2, 3]}}
    assert json.loads(written(document, without=("evidence",))) == {
        "evidence": [],
        "lateral": {"verdict": "none", "evidence": "left out, 0.0 kB; ask for part lateral.evidence"},
    }
    assert json.loads(written(document, "lateral.evidence", ("evidence",))) == [1, 2, 3]


@pytest.mark.parametrize("path", ["nothing", "maneuvers.40", "verdict.x"])
def test_a_part_that_is_not_there_is_refused_by_its_name(path: str) -> None:
    with pytest.raises(RefusedError, match=f"There is no part {path}: "):
        part_of(LARGE, path)
