"""Whole diagnoses of flights whose cause is known, run by ``make study-gap``."""

import pytest

from tests.gap.studies import STUDIES, Study

pytestmark = pytest.mark.study


@pytest.mark.parametrize("study", STUDIES, ids=lambda study: study.fact)
def test_a_flight_whose_cause_is_known_is_diagnosed_as_the_table_says(study: Study) -> None:
    found = study.diagnosed()
    present = [cause.effect for cause in found.causes if cause.present]
    assert study.verdict in (None, found.verdict)
    assert study.block is None or found.where.block == study.block
    assert study.named in (None, present)
    assert study.first is None or found.causes[0].effect == study.first
    sizes = {name: found.causes[0].parameters[name].value for name in study.sizes}
    assert sizes == study.sizes
    assert all(any(words in text for text in (found.sentence, *found.notes)) for words in study.says)
    assert study.holds(found)
