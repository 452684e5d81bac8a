"""Styles are parsed once in a process of tests, instead of at each start of the application."""

import pytest
from textual.css.stylesheet import Stylesheet

_parse_rules = Stylesheet._parse_rules
_PARSED: dict[object, list[object]] = {}


def _parsed_once(sheet: Stylesheet, css: str, read_from: object, *how: object, **so: object) -> list[object]:
    """The rules of a text with the variables of its sheet. A sheet changes none of them."""
    variables = frozenset(sheet._variables.items())
    key = (variables, css, read_from, how, tuple(sorted(so.items())))
    if key not in _PARSED:
        _PARSED[key] = _parse_rules(sheet, css, read_from, *how, **so)
    return _PARSED[key]


@pytest.fixture(autouse=True)
def parsed_once(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Keep what a start has parsed for the next one, unless the test counts what is parsed."""
    if "parsed" not in request.fixturenames:
        monkeypatch.setattr(Stylesheet, "_parse_rules", _parsed_once)
