"""Rules of the check for advice that contradicts itself."""

import pytest

from benchmarks.remedies import contradictions


def verdict(*texts):
    """Return a verdict of the JSON document with these reasons."""
    return {"sentence": "REPEAT", "reasons": [{"text": text} for text in texts], "cautions": []}


def test_a_verdict_with_one_remedy_is_sound():
    assert list(contradictions(verdict("bank 60 deg; fly it wings level", "q is known to 40 %"))) == []


@pytest.mark.parametrize(
    ("texts", "rule"),
    [
        (("too fast; use less stick", "unknown; use about 1.4 times the stick"), "smaller and larger"),
        (("bank 60 deg; fly it wings level", "slow; let it come faster"), "2 remedies"),
        (("too gentle, pitch rate 1.3e+02 deg/s",), "an exponent"),
    ],
)
def test_advice_that_contradicts_itself_is_named(texts, rule):
    assert any(said.startswith(rule) for said in contradictions(verdict(*texts)))
