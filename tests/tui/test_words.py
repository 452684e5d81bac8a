"""Numbers as people read them, and letters at arm's length."""

import math
from typing import get_args

import pytest

from advisor.aircraft.reference import PARAMETERS as NAMES
from advisor.tui.advice import Word
from advisor.tui.block_letters import block_letters
from advisor.tui.panes.pilot import bar
from advisor.words.quantities import PARAMETERS, channel, with_half


def test_every_parameter_has_a_symbol_and_a_unit():
    assert set(PARAMETERS) == set(NAMES)


def test_the_interval_decides_how_many_digits_a_value_has():
    assert with_half(-48.3217, 2.097) == "−48.3 ± 2.1"
    assert with_half(-3.21987, 0.00804) == "−3.2199 ± 0.0080"


def test_people_read_degrees():
    assert channel("q").label == "q [deg/s]"
    assert PARAMETERS["Z_0"].factor * math.pi == 180.0


def test_a_channel_nobody_named_keeps_its_name():
    assert channel("flap").symbol == "flap"


@pytest.mark.parametrize("word", get_args(Word))
@pytest.mark.parametrize("size", [(76, 5), (116, 15), (196, 30), (20, 5)])
def test_every_word_fits_its_space(word: str, size: tuple[int, int]):
    lines = block_letters(word, *size).split("\n")
    assert len(lines) <= size[1]
    assert max(len(line) for line in lines) <= max(size[0], len(word))


@pytest.mark.parametrize("word", get_args(Word))
def test_eighty_columns_suffice_for_block_letters(word: str):
    assert "█" in block_letters(word, 76, 5)


@pytest.mark.parametrize(("share", "filled"), [(0.0, 0), (0.5, 12), (1.0, 24), (1.5, 24)])
def test_the_bar_is_filled_by_the_share_of_the_way_flown(share: float, filled: int):
    cells = bar(share, 24)
    assert len(cells) == 24
    assert cells.count("█") == filled
