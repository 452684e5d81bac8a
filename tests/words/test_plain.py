"""Results as plain values: what JSON can hold, and None for what is undefined."""

import json
from dataclasses import dataclass
from math import inf, nan

import numpy as np

from advisor.words.plain import picked, plain


@dataclass(frozen=True)
class Inner:
    value: float
    names: tuple[str, ...] = ("a", "b")

    @property
    def double(self) -> float:
        return 2.0 * self.value


def test_an_undefined_number_becomes_none_at_any_depth():
    assert plain({"a": [nan, (inf, 1.5)], "b": Inner(nan)}) == {
        "a": [None, [None, 1.5]],
        "b": {"value": None, "names": ["a", "b"]},
    }


def test_numbers_of_numpy_can_be_written_as_json():
    values = {"x": np.array([[1.0, np.nan]]), "y": np.float64(2.5)}
    assert json.dumps(plain(values), allow_nan=False) == '{"x": [[1.0, null]], "y": 2.5}'


def test_a_property_is_picked_by_name_and_nothing_is_picked_from_none():
    assert picked(Inner(1.5), "value double") == {"value": 1.5, "double": 3.0}
    assert picked(None, "value") is None
