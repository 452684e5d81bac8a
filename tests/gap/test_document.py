"""The JSON document of a diagnosis is what its schema says."""

from advisor.gap.document import gap_document
from tests.gap.test_report_screen import diagnosis
from tests.schemas import breaches


def test_the_schema_explains_every_key_of_the_diagnosis():
    assert breaches("gap", gap_document(diagnosis())) == []


def test_the_schema_holds_for_a_document_without_a_diagnosis():
    assert breaches("gap", gap_document(None)) == []


def test_a_document_without_a_diagnosis_has_the_same_keys():
    assert gap_document(None).keys() == gap_document(diagnosis()).keys()
