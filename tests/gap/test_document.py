"""The JSON document of a diagnosis is what its schema says."""

import pytest

from advisor.gap.document import gap_document
from tests.gap.test_report_screen import EVIDENCE, diagnosis
from tests.schemas import breaches


def test_the_schema_explains_every_key_of_the_diagnosis():
    assert breaches("gap", gap_document(diagnosis())) == []


def test_the_schema_holds_for_a_document_without_a_diagnosis():
    assert breaches("gap", gap_document(None)) == []


def test_a_document_without_a_diagnosis_has_the_same_keys():
    assert gap_document(None).keys() == gap_document(diagnosis()).keys()


@pytest.mark.parametrize(("doubt", "decided"), [("", True), ("Not decided between A and B.", False)])
def test_an_answer_in_doubt_is_not_decided(doubt: str, decided: bool):
    found = diagnosis(answer=EVIDENCE[0].alternative, doubt=doubt)
    assert gap_document(found)["decided"] is decided


def test_a_single_manoeuvre_decides_nothing():
    assert gap_document(diagnosis(answer=None))["decided"] is False
