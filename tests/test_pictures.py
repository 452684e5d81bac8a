"""The pictures in the documentation have the labels that the program draws today: none is old."""

import html
import re
from pathlib import Path

import pytest

from benchmarks.pages.screens import SIZES, picture
from tests.flights import SHIPPED

ASSETS = Path(__file__).parents[1] / "docs" / "assets"


def labels(svg: str) -> set[str]:
    """Return the names of panes, tabs and rows in a picture, which no moment of the flight changes."""
    texts = (
        html.unescape(text).replace("\N{NO-BREAK SPACE}", " ") for text in re.findall(r">([^<]+)</text>", svg)
    )
    return {text for text in texts if re.fullmatch(r"\[?[\da-z] [A-Z][a-z ]+\]?|[a-z]+(?: [a-z]+)*", text)}


def test_the_labels_of_a_picture_are_its_tabs_and_its_rows():
    drawn = "<text>y&#160;Roll&#160;and&#160;yaw</text><text>how&#160;far</text><text>flown 3 s</text>"
    assert labels(drawn) == {"y Roll and yaw", "how far"}


@pytest.mark.study
@pytest.mark.parametrize("face", SIZES)
async def test_a_picture_of_a_screen_has_the_labels_of_the_running_program(face):
    kept = labels((ASSETS / f"{face}.svg").read_text(encoding="utf-8"))
    assert labels(await picture(SHIPPED / "bundled-demo.tlog", None, face, 3, "dark")) == kept, (
        "make pictures"
    )
