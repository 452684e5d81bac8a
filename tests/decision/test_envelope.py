"""What the data alone say against a manoeuvre."""

from types import SimpleNamespace

import pytest

from advisor.decision.envelope import too_quick


def stepped(*onsets_s, kind="3-2-1-1"):
    return SimpleNamespace(span=SimpleNamespace(kind=kind, steps=[(onset, 0.1) for onset in onsets_s]))


@pytest.mark.parametrize(("step_s", "is_too_short"), [(0.1, True), (0.2, False)])
def test_a_step_shorter_than_a_seventh_of_the_period_is_too_short(step_s, is_too_short):
    found = too_quick(stepped(10.0, 11.0, 11.0 + step_s), 1.0)
    assert [reason.code for reason in found] == (["steps"] if is_too_short else [])


def test_a_multisine_and_a_single_step_have_no_shortest_step():
    assert too_quick(stepped(10.0, 10.01, kind="multisine"), 1.0) == []
    assert too_quick(stepped(10.0), 1.0) == []
