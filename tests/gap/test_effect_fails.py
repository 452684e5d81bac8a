"""A numerical fault inside the model of one effect leaves that effect out, and the answer names it."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from advisor.gap.axis.flight import AxisFlight
from advisor.gap.inference import pitch
from advisor.gap.inference.pitch import PitchFlight
from advisor.model.axes.lateral import LATERAL
from advisor.process.parts import FailedPart
from advisor.report.gap_document import gap_document
from tests.gap.axis.test_diagnosis import FOUND
from tests.gap.test_report_screen import diagnosis, printed

PLAY = FailedPart("pitch, effect actuator_backlash", "LinAlgError: Singular matrix")
SINGULAR = np.linalg.LinAlgError("Singular matrix")


@pytest.mark.parametrize("found", [diagnosis(failed=(PLAY,)), replace(FOUND, failed=(PLAY,))])
def test_the_document_and_the_screen_name_the_effect_that_failed_and_keep_the_answer(found) -> None:
    document = gap_document(found)
    assert document["usable"] is True
    assert document.get("lateral", document)["verdict"] == found.verdict
    assert [(one["code"], one["part"]) for one in document["problems"]] == [("internal", PLAY.part)]
    said = " ".join(" ".join(printed(found, 120)).replace("│", " ").split())
    assert "! A fault of the advisor, not yours, ended this part: pitch, effect actuator_backlash" in said


def test_an_effect_of_roll_and_yaw_whose_fit_fails_is_left_out() -> None:
    def fit(*_):
        raise SINGULAR

    case = SimpleNamespace(fit=fit, natural=(), begin=SimpleNamespace(setting={}), axis=LATERAL)
    effect = SimpleNamespace(places=(), columns=None, std=(), variant=SimpleNamespace(steps=(), bounds=()))
    flight = AxisFlight(case, None, [])
    start = SimpleNamespace(effect=effect, point=None, name="aileron_actuator_lag")
    plain = SimpleNamespace(free=())
    assert flight._added(start, plain, 0.3, plain, 1.0) is None
    assert [one.part for one in flight.parts.failed] == ["roll and yaw, effect aileron_actuator_lag"]


@pytest.mark.parametrize("fails", ["fit", "model"])
def test_an_effect_of_pitch_whose_fit_or_evidence_fails_is_left_out(monkeypatch, fails):
    def fit(problem, point, noise, *_, **__):
        if fails == "fit" and point == "transport_delay":
            raise SINGULAR
        return SimpleNamespace(cost=1.0, point=point, noise=noise)

    def model(self, problem, variant, made, plain, heat):
        if fails == "model" and variant is not None and variant.effect == "transport_delay":
            raise SINGULAR
        return variant.effect if variant else "plain"

    def quick(name):
        variant = SimpleNamespace(effect=name)
        return SimpleNamespace(variant=variant, name=name, point=name, noise=1.0, price=1.0, cost=1.0)

    looks = [quick("actuator_lag"), quick("transport_delay")]
    monkeypatch.setattr(pitch, "fit", fit)
    monkeypatch.setattr(pitch, "temperature", lambda *_: 1.0)
    monkeypatch.setattr(pitch, "Screen", lambda *_: SimpleNamespace(quick_fits=lambda table: table))
    monkeypatch.setattr(PitchFlight, "model_of", model)
    monkeypatch.setattr(PitchFlight, "_beside", lambda self, base: self.table)
    problem = SimpleNamespace(within=lambda _: None, is_stated=False)
    flight = PitchFlight(problem, SimpleNamespace(point="plain", noise=1.0), looks, [])
    assert flight.explained(None, 6)[1] == ["plain", "actuator_lag"]
    assert [one.part for one in flight.parts.failed] == ["pitch, effect transport_delay"]
