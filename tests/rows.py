"""Tests of one form as rows of one table, each with a sentence of its own."""

from collections.abc import Callable
from inspect import signature
from typing import Any

import pytest


def row(sentence: str, *values: object) -> Callable[..., Any]:
    """Add a case to the test below: the values are its first arguments, the sentence is the case's name."""

    def added(test: Any) -> Any:
        if not hasattr(test, "rows"):
            test.rows = []
            test = pytest.mark.parametrize(list(signature(test).parameters)[: len(values)], test.rows)(test)
        test.rows.insert(0, pytest.param(*values, id=sentence))
        return test

    return added
