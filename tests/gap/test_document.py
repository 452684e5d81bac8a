"""The JSON document of a diagnosis is what its schema says."""

from dataclasses import replace

import pytest

from advisor.report.gap_document import gap_document
from tests.gap.test_report_screen import EVIDENCE, diagnosis
from tests.schemas import breaches


def test_the_schema_explains_every_key_of_the_diagnosis():
    assert breaches("gap", gap_document(diagnosis())) == []


def test_the_schema_holds_for_a_document_without_a_diagnosis():
    assert breaches("gap", gap_document(None)) == []


def test_a_document_without_a_diagnosis_has_the_same_keys():
    assert gap_document(None).keys() == gap_document(diagnosis()).keys()


@pytest.mark.parametrize(("probability", "decided"), [(0.6, True), (0.59, False)])
def test_an_answer_is_decided_from_a_probability_of_six_tenths(probability: float, decided: bool):
    first, second, _ = EVIDENCE
    evidence = (replace(first, probability=probability), replace(second, probability=1.0 - probability))
    assert gap_document(diagnosis(evidence=evidence))["decided"] is decided


def test_a_single_manoeuvre_decides_nothing():
    assert gap_document(diagnosis(evidence=()))["decided"] is False
