import numpy as np
import pytest

from advisor.process.parts import FAULTS, FailedPart, Parts, attempt


def failing(fault: BaseException):
    def work():
        raise fault

    return work


@pytest.mark.parametrize(
    "fault",
    [
        np.linalg.LinAlgError("x"),
        ZeroDivisionError("x"),
        IndexError("x"),
        FloatingPointError("x"),
        OverflowError("x"),
    ],
    ids=lambda fault: type(fault).__name__,
)
def test_a_numerical_fault_is_a_value_with_its_part_and_its_traceback(fault):
    made = attempt("roll and yaw", failing(fault))
    assert isinstance(made, FailedPart)
    assert made.reason == f"{type(fault).__name__}: x"
    assert "in work" in made.trace
    assert made.entry["code"] == "internal"
    assert made.entry["part"] == "roll and yaw"
    assert "roll and yaw" in made.entry["text"]


def test_another_fault_is_not_hidden():
    with pytest.raises(TypeError):
        attempt("part", failing(TypeError("x")))
    assert ValueError not in FAULTS


def test_the_traceback_is_told_on_request_only(monkeypatch):
    made = attempt("part", failing(IndexError("x")))
    monkeypatch.delenv("ADVISOR_TRACEBACK", raising=False)
    assert "Traceback" not in made.sentence
    monkeypatch.setenv("ADVISOR_TRACEBACK", "1")
    assert "Traceback" in made.sentence


def test_a_part_that_is_made_again_has_not_failed_and_is_told_once():
    told: list[FailedPart] = []
    parts = Parts(told.append)
    for _ in range(2):
        assert parts.make("a", failing(IndexError("x")), lambda failed: failed.part) == "a"
    assert [one.part for one in parts.failed] == ["a"]
    assert len(told) == 1
    assert parts.make("a", lambda: "made", lambda failed: "") == "made"
    assert parts.failed == ()
