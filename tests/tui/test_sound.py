"""A bell and a voice that tell a verdict to a pilot who does not look."""

from dataclasses import replace

import pytest

from advisor.mavlink.link.health import LinkStatistics
from advisor.session.conducting import LinkHealth, Tempo, View
from advisor.tui.sound import Sound
from tests.tui import flights
from tests.tui.stage import stage
from tests.tui.stand_ins import HandFedSource


def moment(flown: int, tempo: Tempo | None = None) -> View:
    health = LinkHealth("good", "412 messages/s.")
    return View(flights.state(flown), health, None, flights.AIRCRAFT, "a link", tempo)


def heard(*moments: View, on: bool = True) -> list[str]:
    """Everything that is heard over these moments; a bell is ``*``."""
    said: list[str] = []
    sound = Sound(lambda: said.append("*"), said.append)
    sound.on = on
    for one in moments:
        sound.hear(one)
    return said


def test_a_verdict_rings_and_is_spoken_with_the_word():
    assert heard(moment(5), moment(6)) == ["*", "Manoeuvre 6 good. Continue."]
    assert heard(moment(6), moment(7)) == ["*", "Manoeuvre 7 good. Test complete."]


def test_what_stands_already_is_not_told_again():
    assert heard(moment(5), moment(5)) == []


def test_a_rejected_manoeuvre_is_called_so_before_the_word_repeat():
    bad = replace(moment(6), state=flights.state(6, bad=(6,)))
    assert heard(moment(5), bad) == ["*", "Manoeuvre 6 rejected. Repeat."]


def test_seconds_are_spoken_as_a_word():
    link = LinkStatistics(newest_s=20.0)
    late = LinkHealth("good", "412 messages/s.", read_to_s=8.0, link=link)
    assert heard(moment(5), replace(moment(5), health=late)) == ["*", "This computer is 12 seconds behind."]


def test_a_lost_link_is_told_by_its_word():
    lost = replace(moment(5), health=LinkHealth("lost", "Nothing heard for 4 s."))
    assert heard(moment(5), lost) == ["*", "No link."]


@pytest.mark.parametrize(("on", "speed"), [(False, 1.0), (True, 8.0)])
def test_sound_that_is_off_and_a_fast_replay_are_silent(on: bool, speed: float):
    assert heard(moment(5, Tempo(speed=speed)), moment(6, Tempo(speed=speed)), on=on) == []


async def test_a_key_turns_the_sound_off_and_on():
    source = HandFedSource()
    async with stage(flights.state(5), flights.state(6), flights.state(7), source=source) as here:
        rung: list[str] = []
        here.app._sound._ring = lambda: rung.append("*")
        await here.press("k")
        source.deliver()
        await here.until(lambda: len(here.app.view.state.maneuvers) == 6)
        assert rung == []
        await here.press("k")
        source.deliver()
        await here.until(lambda: rung == ["*"])
