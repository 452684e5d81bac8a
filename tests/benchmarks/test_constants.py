"""The kind of a constant stands in the first word of its docstring."""

import ast

from benchmarks.pages.constants import DECIDES, DESCRIBES, rows_in

SOURCE = '''
_STEP = 0.1
_STEPS = 5
"""Numerical: length of a step, s, and most steps."""

_LEAST = 3.0
"""Least size, rad: smaller ones are not named."""

_SPREAD = 0.2
"""Prior: standard deviation of an offset, m/s²."""
_EFFECT = Variant("lag", 0.1)
_BARE = 1
'''


def kinds_of(source):
    return {name: row.kind for row in rows_in(ast.parse(source)) for name, _ in row.values}


def test_a_constant_without_a_stated_kind_decides():
    assert kinds_of(SOURCE) == {
        "_STEP": "Numerical",
        "_STEPS": "Numerical",
        "_LEAST": DECIDES,
        "_SPREAD": "Prior",
        "_EFFECT": DESCRIBES,
        "_BARE": DECIDES,
    }


def test_a_stated_kind_is_no_part_of_the_meaning():
    assert next(rows_in(ast.parse(SOURCE))).meaning == "Length of a step, s, and most steps."
