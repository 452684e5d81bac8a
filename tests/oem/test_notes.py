"""What a user must know of the values of an estimate."""

from types import SimpleNamespace

import numpy as np
import pytest

from advisor.oem.notes import _edges


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
