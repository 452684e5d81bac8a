"""Every sentence that a flight's faces say, with its time, and the faults of the story that they tell."""

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import inf
from pathlib import Path

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis.marks_file import LogSeries
from advisor.campaign.campaign import Campaign
from advisor.campaign.state import CampaignState
from advisor.report.text import AnalysisText, follow
from advisor.session.conducting import LinkHealth, View
from advisor.tui.advice import advise
from tests.printed import printed_lines, taken

GOOD = LinkHealth("good", "400 messages/s.")
_WORDS_OF_VERDICT = re.compile(r"^\s*(\d+)\s.*?\s([✓✗]) ")
_FORECAST = re.compile(r"about (\d+) more(?:, (?:9 times in 10 )?at most (\d+))?")
_LAG = re.compile(r"lag (?:is|of) (\d\.\d+)|lag_s: (\d\.\d+)")


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


def story_of(aircraft: Aircraft, *logs: Path) -> Story:
    """Replay logs as one campaign, and collect the lines of text and the words of the pilot's screen.

    The analysis at the end is a third face.
    """
    names = [log.name for log in logs]
    campaign = Campaign(aircraft, names=names, lateral=True)
    found: list[Said] = []

    def batches() -> Iterator[Sequence[object]]:
        for columns in LogSeries(list(logs), aircraft.columns).batches():
            yield columns
            state = campaign.state
            advice = advise(View(state, GOOD, None, aircraft, names[state.flight]))
            if not found or (advice.word, advice.sentence) != _newest(found, "pilot"):
                found.append(Said(state.now_s, "pilot", f"{advice.word}: {advice.sentence}"))

    say: Callable[[str], object] = lambda text: found.append(Said(campaign.state.now_s, "text", text))  # noqa: E731
    state = follow(batches(), campaign, say, of_log=True)  # type: ignore[arg-type]
    found += [
        Said(state.now_s, "analyze", line) for line in printed_lines(AnalysisText(state, names, aircraft))
    ]
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
    yield from _forecasts(story)
    yield from _two_values(story)
    yield from _at_odds(story)


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


def _forecasts(story: Story) -> Iterator[str]:
    """Yield forecasts that vanish, or that rise without a reason, for each axis."""
    axis, before = "", dict[str, float]()
    for one in story.said:
        if one.face != "text":
            continue
        if _WORDS_OF_VERDICT.match(one.text):
            axis = "roll and yaw" if "(roll and yaw)" in one.text else "pitch"
        if re.search(r"TEST COMPLETE|(?:is|are) complete", one.text):
            before.pop(axis, None)
        if not one.text.lstrip().startswith("next: "):
            continue
        told = _FORECAST.search(one.text)
        if told is None and axis in before and "Both" not in one.text:
            yield f"{one.at_s:.0f} s: the forecast of {axis} vanishes: {one.text}"
        if told is None:
            continue
        # A forecast without a largest number has an open band.
        most = int(told[2]) if told[2] else inf
        if axis in before and most > max(before[axis] - 1, 1) and not one.text.endswith(")"):
            yield f"{one.at_s:.0f} s: the forecast of {axis} rises without a reason: {one.text}"
        before[axis] = most


def _two_values(story: Story) -> Iterator[str]:
    """Yield a servo's lag that the analysis at the end states twice, with different values."""
    lines = [one.text for one in story.said if one.face == "analyze" and "elevator" in one.text.lower()]
    lines += [one.text for one in story.said if one.face == "analyze" and "The servo" in one.text]
    told = {first or second for line in set(lines) for first, second in _LAG.findall(line)}
    if len(told) > 1:
        yield f"the servo's lag has {len(told)} values: {', '.join(sorted(told))}"


def _at_odds(story: Story) -> Iterator[str]:
    """Yield an open test that asks for nothing, and a decision on an axis that nobody tested."""
    analyzed = [one.text for one in story.said if one.face == "analyze"]
    for decision, following in pairwise(analyzed):
        is_open = "CONTINUE" in decision or "open it again" in decision
        if is_open and "no further manoeuvre" in following:
            yield f"an open test asks for nothing: {decision}"
    if story.state.tested_sideways is not None:
        yield from (
            f"nobody tests the elevator: {one}" for one in analyzed if re.match(r"[▶■].*elevator", one)
        )


def _commands(story: Story) -> Iterator[str]:
    """Yield printed commands that the program does not take."""
    for one in story.said:
        for line in re.findall(r"^\s*(advisor .*)$", one.text, re.MULTILINE):
            try:
                taken(line)
            except Exception as error:
                yield f"{one.at_s:.0f} s: {line}: {error}"
