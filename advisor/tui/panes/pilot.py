"""Panes of the pilot's screen: the word of advice, the next input, the progress, and notes."""

from collections.abc import Iterator

from advisor.campaign.state import CampaignState
from advisor.decision.verdict import FlightTestVerdict
from advisor.decision.verdict import NextInput as Advised
from advisor.session.conducting import View
from advisor.tui.advice import advise, without_word
from advisor.tui.block_letters import block_letters
from advisor.tui.panes.last_verdict import symbol_and_word
from advisor.tui.panes.pane import HangingLines, Labelled, Lines, Part, Redrawn
from advisor.tui.stick_drawing import drawn

TONES = ("good", "warn", "bad", "quiet")


class BigWord(Part, Redrawn, Lines):
    """The pilot's word of advice in block letters."""

    EITHER_AXIS = True

    def __init__(self) -> None:
        super().__init__()
        self.word = ""

    def show(self, view: View) -> None:
        """Write the word of advice in the colour of its urgency."""
        advice = advise(view)
        if advice.word == self.word:
            return
        self.word = advice.word
        for tone in TONES:
            self.set_class(tone == advice.tone, f"-{tone}")
        self._redraw()

    def _redraw(self) -> None:
        if self.word and self.size.width:
            self.write(block_letters(self.word, self.size.width, self.size.height))


class Why(Part, Lines):
    """The sentence of advice under the pilot's word."""

    EITHER_AXIS = True

    def show(self, view: View) -> None:
        """Write the sentence of the advice. The age of an old word comes before the sentence."""
        advice = advise(view)
        age = f"({advice.age.removesuffix('.')})  " if advice.age else ""
        self.write(f"{age}{without_word(advice.sentence)}")


class NextInput(Part, Redrawn, Lines):
    """The advised input in words above its drawing. On a low terminal the drawing is one line next to the
    words."""

    EITHER_AXIS = True

    def __init__(self) -> None:
        super().__init__()
        self._advised: Advised | None = None

    def show(self, view: View) -> None:
        """Draw the input that is advised now. If both axes are tested, the input belongs to the axis that
        lacks most information.
        """
        self._advised = view.plan.next if view.plan is not None else view.state.flight_test.next
        self._redraw()

    def _redraw(self) -> None:
        if self._advised is not None and self.size.width:
            self.write(drawn(self._advised, self.size.width, large=self.screen.has_class("-large")))


_LAST_SHOWN = 16
_BAR = 20


def bar(share: float, width: int) -> str:
    """Return a bar that is filled to a fraction, 0 to 1."""
    filled = min(max(round(share * width), 0), width)
    return "█" * filled + "·" * (width - filled)


class Gauge(Part, HangingLines):
    """The progress bar of the flight test, and the number of manoeuvres so far."""

    EITHER_AXIS = True

    def show(self, view: View) -> None:
        """Write the two lines of progress."""
        self.write_rows((("how far     ", how_far(view)), ("manoeuvres  ", _flown(view))))


def how_far(view: View) -> str:
    """Return the progress bar, and how many more manoeuvres are expected."""
    verdict, flown = view.state.flight_test, len(view.state.maneuvers)
    if verdict.decision == "stop":
        return f"{bar(1.0, _BAR)}  complete"
    remaining = verdict.next.remaining if verdict.next is not None else None
    accepted = sum(j.verdict.accepted and j.excluded_because is None for j in view.state.maneuvers)
    if remaining is None and accepted:
        return f"{bar(0.0, _BAR)}  {accepted} accepted so far"
    if remaining is None:
        return f"{bar(0.0, _BAR)}  known after the first accepted manoeuvre"
    if remaining.median is None:
        return f"{bar(0.0, _BAR)}  no end in sight"
    return f"{bar(flown / (flown + remaining.median), _BAR)}  {remaining.spoken}"


def _flown(view: View) -> str:
    maneuvers = view.state.maneuvers
    if not maneuvers:
        return "none flown yet"
    accepted = sum(j.verdict.accepted and j.excluded_because is None for j in maneuvers)
    marks = " ".join(symbol_and_word(j)[0] for j in maneuvers[-_LAST_SHOWN:])
    return f"{marks}   {accepted} accepted of {len(maneuvers)}"


def flying_in_words(view: View) -> str:
    """Return a line on the manoeuvre in flight."""
    if view.health.behind:
        return f"not known: {view.health.behind}"
    if view.health.condition == "ended":
        return "nothing: the log has ended"
    marked_s = view.state.marking_since_s
    if marked_s is not None:
        return f"marked by hand for {view.state.now_s - marked_s:.0f} s"
    if view.state.flying is None:
        return "the last manoeuvre is being judged" if view.state.judging else "between manoeuvres"
    return f"{view.state.progress}{_of_the_stick(view.state)}"


def _of_the_stick(state: CampaignState) -> str:
    """Return what the stick does now in a manoeuvre; empty while the input goes on."""
    if state.arriving is not None and state.arriving.is_enough:
        return "; ENOUGH: let go"
    if state.flying is None or not state.flying.span.input_is_over:
        return ""
    return "; recover" if state.is_recorded else "; hold the stick still"


class CrewNotes(Part, HangingLines):
    """The manoeuvre in flight, a fault of the link, and the number of warnings."""

    EITHER_AXIS = True

    def show(self, view: View) -> None:
        """Write one line for each note. Warnings come last, each with its symbol."""
        self.write_rows(_rows(view))


def _other_axis(view: View) -> Iterator[Labelled]:
    """Yield the word of the hidden axis's verdict, if that axis has a manoeuvre."""
    lateral = view.state.lateral
    if view.elevator is not None and view.elevator.state.maneuvers:
        yield "elevator    ", _word(view.elevator.state.flight_test)
    elif view.elevator is None and lateral is not None and lateral.maneuvers:
        yield "roll, yaw   ", f"{_word(lateral.flight_test)}; key r shows roll and yaw"


def _word(verdict: FlightTestVerdict) -> str:
    """Return the first words of a verdict, which the screen of its axis shows in large letters."""
    return verdict.sentence.partition(":")[0]


def _rows(view: View) -> Iterator[Labelled]:
    if view.elevator is None:
        yield "in the air  ", flying_in_words(view)
    else:
        yield "axis        ", "roll and yaw; key r shows the elevator's axis"
    yield from _other_axis(view)
    if view.health.condition in ("poor", "lost"):
        yield "link        ", view.health.sentence
    corrected = [finding for finding in view.state.instruments if finding.contradicts and finding.used]
    count = len(view.state.flight_test.warnings) + len(corrected)
    if count:
        yield "! ", f"{count} warning{'s' if count > 1 else ''} for the engineer: key e, panes 6 and 7"
