"""Every key of the JSON document stands in its page."""

import re
from pathlib import Path

from advisor.gap.document import gap_document
from tests.gap.test_report_screen import diagnosis

PAGE = Path(__file__).parents[2] / "docs" / "json.md"
NAMES_OF_THINGS = {"alpha", "q", "a_z", "theta", "delay_s", "M_alpha2", "M_alpha3", "M_delta2", "plateau"}


def keys_in(value: object) -> set[str]:
    """All keys of a document; names of channels, phases and parameters are values."""
    if isinstance(value, dict):
        inside = (keys_in(v) for v in value.values())
        return {k for k in value if " " not in k and k not in NAMES_OF_THINGS}.union(*inside)
    return set().union(*map(keys_in, value)) if isinstance(value, list) else set()


def test_every_key_of_the_diagnosis_is_explained():
    page = PAGE.read_text(encoding="utf-8")
    section = page.split("\n## ")[0] + page.split("`advisor.gap/1`")[1].split("\n## ")[0]
    explained = set(re.findall(r"[A-Za-z_0-9]+", section))
    assert keys_in(gap_document(diagnosis())) - explained == {"schema"}


def test_a_document_without_a_diagnosis_has_the_same_keys():
    assert gap_document(None).keys() == gap_document(diagnosis()).keys()
