"""The stop criterion against its limit, and the expected number of further manoeuvres."""

from advisor.decision.verdict import FlightTestVerdict
from advisor.session.view import View
from advisor.tui.panes.hanging import HangingLines
from advisor.tui.panes.last_verdict import symbol_and_word
from advisor.tui.panes.part import Part
from advisor.words.digits import distinct_texts, percent

_LAST_SHOWN = 16


def bar(value: float, limit: float, width: int) -> str:
    """Return a bar from 0 to twice the limit, with the limit marked in its middle. A longer bar ends in an
    arrow."""
    middle = width // 2
    filled = min(round(value / (2.0 * limit) * width), width)
    cells = ["█" if k < filled else "·" for k in range(width)]
    cells[middle] = "┃"
    if value > 2.0 * limit:
        cells[-1] = "►"
    return "".join(cells)


class Gauge(Part, HangingLines):
    """Criterion, manoeuvres so far, and the expected number of further ones."""

    def show(self, view: View) -> None:
        """Write the two lines."""
        self.write_rows((("criterion   ", _criterion(view)), ("manoeuvres  ", _flown(view))))


def _criterion(view: View) -> str:
    verdict = view.state.flight_test
    value, limit = verdict.criterion_percent, verdict.limit_percent
    if value is None:
        least = 1 if verdict.rule == "information" else view.aircraft.campaign.window
        good = "a good manoeuvre" if least == 1 else f"{least} good manoeuvres"
        return f"none yet: it takes {good} (limit {percent(limit)})"
    side = "below" if value < limit else "above"
    now, most = distinct_texts(value, limit)
    return f"{now:>4} %  {bar(value, limit, 24)}  {side} the limit {most} %"


def _flown(view: View) -> str:
    maneuvers = view.state.maneuvers
    if not maneuvers:
        return "none flown yet"
    accepted = sum(j.verdict.accepted and j.excluded_because is None for j in maneuvers)
    marks = " ".join(symbol_and_word(j)[0] for j in maneuvers[-_LAST_SHOWN:])
    return f"{marks}   {accepted} good of {len(maneuvers)}{_remaining(view.state.flight_test)}"


def _remaining(verdict: FlightTestVerdict) -> str:
    if verdict.decision == "stop" or verdict.next is None or not verdict.next.foretold:
        return ""
    return f"; {verdict.next.foretold}"
