"""The one sentence for the crew says what was found, and no more than is known."""

import pytest

from advisor.gap.result import Where
from advisor.gap.verdict.text import sentence_of
from tests.gap.test_report_screen import diagnosis


@pytest.mark.parametrize(
    ("moment", "places"),
    [
        (1.0, "between the command and the surface or in the pitching moment"),
        (0.995, "between the command and the surface or in the pitching moment"),
        (0.9, "between the command and the surface"),
    ],
)
def test_two_places_that_are_as_likely_are_both_said(moment, places):
    where = Where("input", 0.9, (("input", 1.0), ("moment_equation", moment)))
    sentence = sentence_of("unknown", diagnosis().gap, where, (), None)
    assert sentence == f"Something {places} that no known effect explains."
