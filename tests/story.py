"""Every sentence that a flight's faces say, with its time, and the faults of the story that they tell."""

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from advisor.aircraft.aircraft import Aircraft
from advisor.campaign.campaign import Campaign
from advisor.campaign.state import CampaignState
from advisor.mavlink.logs.whole import read_whole_log
from advisor.report.follow import follow
from advisor.session.source import LinkHealth
from advisor.session.view import View
from advisor.tui.advice import advise
from tests.printed import taken

GOOD = LinkHealth("good", "400 messages/s.")
_WORDS_OF_VERDICT = re.compile(r"^\s*(\d+)\s.*?\s([✓✗]) ")
_SAYS_WHY = re.compile(r"complete|denied|deny|open|no longer")
"""Words of a sentence that says why a complete test goes on."""


@dataclass(frozen=True)
class Said:
    """One sentence of one face."""

    at_s: float
    """Vehicle time, s since boot."""
    face: str
    text: str


@dataclass(frozen=True)
class Story:
    """Sentences of a flight, in their order, and the state at the flight's end."""

    said: Sequence[Said]
    state: CampaignState
    aircraft: Aircraft


def story_of(log: Path, aircraft: Aircraft) -> Story:
    """Replay a log, and collect the lines of text and the words of the pilot's screen."""
    campaign = Campaign(aircraft, lateral=True)
    found: list[Said] = []

    def batches() -> Iterator[Sequence[object]]:
        for columns in read_whole_log(log):
            yield columns
            state = campaign.state
            advice = advise(View(state, GOOD, None, aircraft, log.name))
            if not found or (advice.word, advice.sentence) != _newest(found, "pilot"):
                found.append(Said(state.now_s, "pilot", f"{advice.word}: {advice.sentence}"))

    say: Callable[[str], object] = lambda text: found.append(Said(campaign.state.now_s, "text", text))  # noqa: E731
    state = follow(batches(), campaign, say, of_log=True)  # type: ignore[arg-type]
    return Story(found, state, aircraft)


def _newest(found: Sequence[Said], face: str) -> tuple[str, str]:
    text = next((one.text for one in reversed(found) if one.face == face), "")
    word, _, sentence = text.partition(": ")
    return word, sentence


def faults(story: Story) -> Iterator[str]:
    """Yield a sentence for each fault of a story."""
    yield from _taken_back(story)
    yield from _not_there(story)
    yield from _commands(story)


def _taken_back(story: Story) -> Iterator[str]:
    """Yield verdicts and stops that end without a line of their own."""
    explained = {one.at_s for one in story.said if "CHANGED" in one.text or one.text.startswith("note: ")}
    verdicts: dict[tuple[str, bool], str] = {}
    complete = False
    for one in story.said:
        if one.face == "text" and (line := _WORDS_OF_VERDICT.match(one.text)):
            key = line[1], "(roll and yaw)" in one.text
            if verdicts.setdefault(key, line[2]) != line[2] and one.at_s not in explained:
                yield f"{one.at_s:.0f} s: verdict {key[0]} changes without a line: {one.text}"
        if one.face != "pilot":
            continue
        now = one.text.startswith("TEST COMPLETE")
        if (
            complete
            and not now
            and not re.match(r"(RECOVER|CONTINUE|REPEAT): .*(complete|denied|open)", one.text)
        ):
            yield f"{one.at_s:.0f} s: TEST COMPLETE is taken back: {one.text}"
        complete = now


def _not_there(story: Story) -> Iterator[str]:
    """Yield sentences that name a simulator, an axis or a manoeuvre that is not there."""
    state, aircraft = story.state, story.aircraft
    has_simulator = bool(aircraft.model) or aircraft.simulator is not None
    side = state.lateral
    flown = max([j.maneuver.number for j in (*state.maneuvers, *(side.maneuvers if side else ()))], default=0)
    tests_elevator = state.tested_sideways is None
    for one in story.said:
        if not has_simulator and "simulator" in one.text:
            yield f"{one.at_s:.0f} s: no simulator is there: {one.text}"
        if not tests_elevator and re.match(r"(RECOVER|REPEAT)\b.*elevator", one.text):
            yield f"{one.at_s:.0f} s: nobody tests the elevator: {one.text}"
        for number in map(int, re.findall(r"after manoeuvre (\d+)", one.text)):
            if number > flown:
                yield f"{one.at_s:.0f} s: there is no manoeuvre {number}: {one.text}"


def _commands(story: Story) -> Iterator[str]:
    """Yield printed commands that the program does not take."""
    for one in story.said:
        for line in re.findall(r"^\s*(advisor .*)$", one.text, re.MULTILINE):
            try:
                taken(line)
            except Exception as error:
                yield f"{one.at_s:.0f} s: {line}: {error}"
