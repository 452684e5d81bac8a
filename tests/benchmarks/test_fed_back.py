"""The improved file fed back: which flights are drawn, and when an improved file leaves no cause."""

from dataclasses import replace

import pytest

from benchmarks import fed_back
from benchmarks.fed_back import FedBack
from benchmarks.gate_flights import GATE, gate_flights
from sim.sealed.cases import SealedCase
from tests.gap.test_report_screen import diagnosis


@pytest.mark.parametrize(("verdict", "closed"), [("none", True), ("parameters", True), ("effect", False)])
def test_nothing_but_numbers_may_be_left_after_the_improved_file(verdict: str, closed: bool) -> None:
    assert FedBack(diagnosis(), replace(diagnosis(), verdict=verdict)).is_closed is closed


def test_an_answer_without_an_improved_file_is_not_closed() -> None:
    told = FedBack(diagnosis(), None)
    assert not told.is_closed
    assert str(told).endswith("no file")


def test_flights_without_a_cause_are_not_fed_back(monkeypatch: pytest.MonkeyPatch) -> None:
    kinds = ("none", "one", "outside", "parameters", "none", "two", "one")
    lag = {"actuator_lag": {}}
    cases = [SealedCase(kind, {"kind": kind, "effects": lag}, b"", {}) for kind in kinds]
    monkeypatch.setattr(fed_back, "DRAWS", {"own": lambda *_: iter(cases)})
    assert [case.name for _, case in fed_back.drawn("own", 3, 11)] == ["one", "parameters", "two"]


def test_flights_in_moving_air_are_not_fed_back(monkeypatch: pytest.MonkeyPatch) -> None:
    airs = ({"gust": {}}, {"gust": {}, "icing": {}})
    cases = [SealedCase(str(len(air)), {"kind": "one", "effects": air}, b"", {}) for air in airs]
    monkeypatch.setattr(fed_back, "DRAWS", {"own": lambda *_: iter(cases)})
    assert [case.name for _, case in fed_back.drawn("own", 3, 11)] == ["2"]


@pytest.mark.skipif(not GATE.is_dir(), reason="the gate's flights lie beside a checkout only")
def test_the_gate_has_flights_of_both_axes() -> None:
    assert {flown.axis for flown in gate_flights()} == {"pitch", "lateral"}
