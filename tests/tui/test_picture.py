"""Pictures look the same wherever they are seen: dots and blocks are shapes, no font is fetched."""

import re

import pytest

from advisor.tui.taking import drawn
from tests.tui import flights
from tests.tui.stage import stage


def run_of(text: str) -> str:
    place = f'x="12.2" y="18.5" textLength="{12.2 * len(text):.1f}"'
    return f'<text class="r1" {place} clip-path="url(#a)">{text}</text>'


def test_each_braille_dot_becomes_a_circle_in_its_place():
    circles = re.findall(r'<circle cx="([\d.]+)" cy="([\d.]+)"', drawn(run_of("⠁⢀")))
    assert [(float(x), float(y)) for x, y in circles] == [
        pytest.approx((12.2 * 1.25, 24.4 / 8.0), abs=0.06),
        pytest.approx((12.2 * 2.75, 24.4 * 7.0 / 8.0), abs=0.06),
    ]


def test_blocks_become_bars_without_gaps():
    bars = re.findall(r'<rect x="([\d.]+)" y="0.0" width="([\d.]+)"', drawn(run_of("██&#160;█")))
    assert bars == [("12.2", "24.4"), ("48.8", "12.2")]


def test_words_begin_where_they_stood():
    assert 'x="36.6"' in drawn(run_of("&#160;&#160;t&lt;s"))
    assert "t&lt;s" in drawn(run_of("&#160;&#160;t&lt;s"))


async def test_a_picture_of_the_application_fetches_nothing():
    async with stage(flights.state(3)) as here:
        svg = drawn(here.app.export_screenshot())
        assert "url(http" not in svg
        assert "<rect" in svg
        assert "█" not in svg
