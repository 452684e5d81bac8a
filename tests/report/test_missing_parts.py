"""A section or a picture that a fault ends is a sentence in its place, and the rest of the page stands."""

from types import SimpleNamespace
from typing import Any, NoReturn

import pytest

from advisor.report.page import render
from advisor.report.page.blocks import Paragraph, Section
from advisor.report.page.drawing import picture

SOUND = Section("headline", "Headline", ())


def flight_picture(content: object) -> NoReturn:
    raise IndexError("stretch 600 of 600")


def test_a_section_that_fails_is_named_in_its_place_and_its_neighbours_stand(monkeypatch):
    content: Any = SimpleNamespace(state=SimpleNamespace(maneuvers=(), tested_sideways=None))
    monkeypatch.setattr(render, "_PARTS", (lambda _: SOUND, flight_picture, lambda _: SOUND))
    first, failed, last = render.sections(content)
    assert first is last is SOUND
    assert failed.title == "Flight picture"
    (said,) = failed.blocks
    assert isinstance(said, Paragraph)
    assert "page, flight picture (IndexError: stretch 600 of 600)" in said.text


def test_a_picture_that_fails_is_a_sentence_in_its_place() -> None:
    drawn = picture("fit <1>", 3.0, 2.0, flight_picture)()
    assert drawn.startswith('<p class="note">A fault of the advisor, not yours, ended this part: ')
    assert "picture fit &lt;1&gt; (IndexError: stretch 600 of 600)" in drawn


def test_a_fault_that_is_none_of_numbers_ends_the_page(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(content: object) -> NoReturn:
        raise TypeError("no number")

    content: Any = SimpleNamespace(state=SimpleNamespace(maneuvers=(), tested_sideways=None))
    monkeypatch.setattr(render, "_PARTS", (broken,))
    with pytest.raises(TypeError):
        render.sections(content)
