"""Notes for a pilot: the manoeuvre in flight, a fault of the link, warnings for the engineer."""

from collections.abc import Iterator

from advisor.decision.verdict import FlightTestVerdict
from advisor.session.view import View
from advisor.tui.panes.lines import HangingLines, Labelled, Part


def flying_in_words(view: View) -> str:
    """Return a line on the manoeuvre in flight."""
    if view.health.behind:
        return f"not known: {view.health.behind}"
    if view.health.condition == "ended":
        return "nothing: the log has ended"
    marked_s = view.state.marking_since_s
    if marked_s is not None:
        return f"marked by hand for {view.state.now_s - marked_s:.0f} s"
    return "between manoeuvres" if view.state.flying is None else view.state.progress


class CrewNotes(Part, HangingLines):
    """The manoeuvre in flight, a fault of the link, and the number of warnings."""

    EITHER_AXIS = True

    def show(self, view: View) -> None:
        """Write one line each; warnings last, each with its sign."""
        self.write_rows(_rows(view))


def _other_axis(view: View) -> Iterator[Labelled]:
    """Yield the verdict's word of the axis that is not shown, after its first manoeuvre."""
    lateral = view.state.lateral
    if view.elevator is not None and view.elevator.state.maneuvers:
        yield "elevator    ", _word(view.elevator.state.flight_test)
    elif view.elevator is None and lateral is not None and lateral.maneuvers:
        yield "roll, yaw   ", f"{_word(lateral.flight_test)}; key r shows roll and yaw"


def _word(verdict: FlightTestVerdict) -> str:
    """Return a verdict's first words, which its axis shows in large letters."""
    return verdict.sentence.partition(":")[0]


def _rows(view: View) -> Iterator[Labelled]:
    if view.elevator is None:
        yield "in the air  ", flying_in_words(view)
    else:
        yield "axis        ", "roll and yaw; key r shows the elevator's"
    yield from _other_axis(view)
    if view.health.condition in ("poor", "lost"):
        yield "link        ", view.health.sentence
    corrected = [found for found in view.state.instruments if found.contradicts and found.used]
    count = len(view.state.flight_test.warnings) + len(corrected)
    if count:
        yield "! ", f"{count} warning{'s' if count > 1 else ''} for the engineer: key e, panes 6 and 7"
