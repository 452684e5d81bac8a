"""Progress of the flight test: manoeuvres flown, and the number expected in total."""

from advisor.session.view import View
from advisor.tui.panes.last_verdict import symbol_and_word
from advisor.tui.panes.lines import HangingLines, Part

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
    """Return the bar with the manoeuvres flown, and how many more are expected."""
    verdict, flown = view.state.flight_test, len(view.state.maneuvers)
    if verdict.decision == "stop":
        return f"{bar(1.0, _BAR)}  complete"
    remaining = verdict.next.remaining if verdict.next is not None else None
    accepted = sum(j.verdict.accepted and j.excluded_because is None for j in view.state.maneuvers)
    if remaining is None and accepted:
        return f"{bar(0.0, _BAR)}  {accepted} accepted so far"
    if remaining is None:
        return f"{bar(0.0, _BAR)}  known after the first good manoeuvre"
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
