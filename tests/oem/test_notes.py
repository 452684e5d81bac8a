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
    alike = np.zeros((2, len(PARAMETERS) + 2))
    alike[:, 0], alike[1, 1:] = (0.08, other_s), 9.0
    solution = SimpleNamespace(
        problem=SimpleNamespace(fixed={}), scattered=np.eye(len(PARAMETERS)), alike=alike
    )
    assert ("explain the record alike" in _ridge(solution)) is said
