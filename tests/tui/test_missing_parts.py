"""A pane that a fault ends is named once, and the other panes go on."""

from typing import NoReturn

from advisor.session.conducting import View
from advisor.tui.panes.pilot import BigWord
from tests.tui import flights
from tests.tui.stage import stage


async def test_a_pane_that_fails_again_and_again_is_named_once_and_the_others_are_painted(monkeypatch):
    painted = list[View]()

    def fail(pane: BigWord, view: View) -> NoReturn:
        painted.append(view)
        raise ZeroDivisionError("period of zero")

    monkeypatch.setattr(BigWord, "show", fail)
    async with stage(flights.state(0)) as here:
        await here.until(lambda: len(painted) >= 3)
        told = [note.message for note in here.app._notifications]
        assert here.words("Why").strip()
    (sentence,) = [note for note in told if "ended this part" in note]
    assert "pane BigWord (ZeroDivisionError: period of zero)" in sentence
