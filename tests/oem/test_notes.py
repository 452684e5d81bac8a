"""What a user must know of the values of an estimate."""

from types import SimpleNamespace

import numpy as np
import pytest

from advisor.aircraft.reference import PARAMETERS
from advisor.oem.notes import _edges, _ridge


@pytest.mark.parametrize(
    ("added", "said"), [(0, ""), (2, "The times of 1 elevator steps"), (6, "The times of 3")]
)
def test_the_number_of_estimated_steps_is_said(added, said):
    def of(stamps):
        record = SimpleNamespace(elevator=SimpleNamespace(t=np.arange(float(stamps))))
        return SimpleNamespace(problem=SimpleNamespace(records=[record]))

    found = _edges(of(10 + added), of(10))
    assert found.startswith(said)
    assert bool(found) == bool(said)


@pytest.mark.parametrize(("other_s", "said"), [(0.14, True), (0.082, False)])
def test_two_lags_are_named_only_where_their_numbers_differ(other_s: float, said: bool) -> None:
    best = np.zeros(len(PARAMETERS) + 1)
    best[-1] = 0.08
    there = np.full(len(PARAMETERS) + 1, 9.0)
    alike = np.array([[0.08, *best], [other_s, *there]])
    solution = SimpleNamespace(
        problem=SimpleNamespace(fixed={}), scattered=np.eye(len(PARAMETERS)),
        profile=SimpleNamespace(best=best, place=0, alike=alike),
    )  # fmt: skip
    assert ("explain the record alike" in _ridge(solution)) is said
