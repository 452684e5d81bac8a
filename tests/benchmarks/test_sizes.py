"""The bounds on the size of the house: a count above its bound is red, and so is a bound above its count."""

import json

import pytest

from benchmarks import sizes


@pytest.mark.parametrize(("bound", "red"), [(99, 1), (100, 0), (101, 1)], ids=["above", "at", "forgotten"])
def test_the_bound_of_lines_is_their_count(monkeypatch, tmp_path, bound, red):
    monkeypatch.setattr(sizes, "BOUNDS", tmp_path / "sizes.json")
    monkeypatch.setattr(sizes, "counted", lambda: {"lines of advisor": 100})
    sizes.BOUNDS.write_text(json.dumps({"lines of advisor": bound}))
    assert sizes.main([]) == red
    sizes.main(["--lower"])
    assert json.loads(sizes.BOUNDS.read_text()) == {"lines of advisor": min(bound, 100)}
