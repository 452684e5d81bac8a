"""Pane of the sim-to-real gap of the flight so far: answer, plots of the manoeuvre with the largest gap, next
steps.
"""

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from time import monotonic
from typing import Any

import numpy as np
from textual.app import ComposeResult
from textual.containers import VerticalScroll
from textual.events import Resize

from advisor.process.parts import Parts
from advisor.report.facts.reasons import weighed
from advisor.report.facts.sizes import WORSE
from advisor.session.conducting import View
from advisor.session.diagnosis import Document, GapTask, diagnose_elsewhere
from advisor.tui.panes.pane import HangingLines, Labelled, Pane
from advisor.tui.plot.chart import Chart, Series
from advisor.tui.plot.painting import Plot
from advisor.words.quantities import channel

_SHOWN = ("alpha", "q", "a_z", "theta")
_SHOWN_SIDEWAYS = ("p", "r", "bank", "a_y")
"""Channels of roll and yaw, which replace the channels of pitch while roll and yaw are shown."""
_ROWS_FOR_ONE = 6
_TEXT_SHARE = 0.45
"""Largest fraction of the pane's height for the text."""
_ASKING = "The diagnosis of {count} manoeuvres runs for {seconds:.0f} s; each manoeuvre takes some seconds."
_NO_LOG = "Nothing is recorded here, so there is no log to diagnose: run advisor gap on the log afterwards."
_TOO_EARLY = "No manoeuvre has been flown yet, so there is nothing to compare with the simulator."


class GapPane(Pane):
    """Pane with the diagnosis of the flight so far. Choosing the pane starts the diagnosis."""

    TITLE = "d Gap"
    SHORT = "dGap"
    HELP = """\
# Gap

Why the aircraft does not fly like its simulator. Choosing the pane starts the diagnosis of the flight so
far, in a process of its own; choosing it again after further manoeuvres starts it again.

The text has the answer with its probability and limits, the derivatives that differ with their 95 %
intervals, the next steps, and the reasons against the strongest rival. Scroll for more.

The plots show the manoeuvre with the largest gap: measured (dots), the simulator before, and with the
findings.
"""

    def compose(self) -> ComposeResult:
        """Lay out the text above one plot for each channel."""
        with VerticalScroll():
            yield HangingLines(_TOO_EARLY, id="gap-text")
        for name in _SHOWN:
            yield Plot(_empty(name), id=f"gap-{name}")

    _asked: tuple[int, ...] | None = None
    """Axis and manoeuvres of the newest requested diagnosis."""
    _since_s: float | None = None
    """Start time of the running diagnosis; None while no diagnosis runs."""
    _view: View | None = None

    def on_mount(self) -> None:
        """Start a timer that shows every second how long a diagnosis has been running."""
        self.set_interval(1.0, self._tick)

    def show(self, view: View) -> None:
        """Keep the present state for the next diagnosis. The pane changes only when a diagnosis ends."""
        self._view = view

    def ask(self, view: View) -> None:
        """Start the diagnosis, unless one of all manoeuvres so far exists."""
        numbers = tuple(judged.maneuver.number for judged in view.state.maneuvers)
        sideways = view.elevator is not None
        asked = (sideways, *numbers)
        if not numbers or not view.logs:
            self._say([("", _NO_LOG if numbers else _TOO_EARLY)])
        elif asked != self._asked:
            self._asked, self._since_s = asked, monotonic()
            for name, plot in self._plots(sideways=sideways):
                plot.chart = _empty(name)
            self._tick()
            task = GapTask(tuple(view.logs), view.aircraft, view.aircraft_file, sideways)
            self.run_worker(partial(self._work, task), thread=True, exclusive=True, exit_on_error=False)

    def _work(self, task: GapTask) -> None:
        document = diagnose_elsewhere(task)
        self.app.call_from_thread(self._told, document)

    def _tick(self) -> None:
        """Show how long the diagnosis has been running."""
        if self._since_s is not None and self._asked is not None:
            seconds = monotonic() - self._since_s
            self._say([("", _ASKING.format(count=len(self._asked) - 1, seconds=seconds))])

    def _told(self, document: Document) -> None:
        """Show a diagnosis. If the text or the picture fails, the other is still shown."""
        self._since_s = None
        rows: list[Labelled] = []
        parts = Parts(lambda failed: rows.append(("✗ ", str(failed.problem))))
        parts.make("text of the gap", lambda: rows.extend(answer_rows(document)), lambda failed: None)
        parts.make("picture of the gap", partial(self._draw, document), lambda failed: None)
        self._say(rows)

    def _draw(self, document: Document) -> None:
        """Draw the manoeuvre with the largest gap, if its curves exist."""
        part = document.get("lateral") or document
        if part["gap"] is None or not part["traces"]:
            return
        worst = max(part["gap"]["by_maneuver"], key=lambda m: m["before"])["number"]
        self.subtitle(f"manoeuvre {worst}, the largest gap")
        mine = {t["channel"]: t for t in part["traces"] if t["number"] == worst}
        for name, plot in self._plots(sideways=part is not document):
            plot.chart = _chart(name, mine[name]) if name in mine else _empty(name)

    def _plots(self, *, sideways: bool) -> Iterator[tuple[str, Plot]]:
        for place, name in zip(_SHOWN, _SHOWN_SIDEWAYS if sideways else _SHOWN, strict=True):
            yield name, self.query_one(f"#gap-{place}", Plot)

    def _say(self, rows: Sequence[Labelled]) -> None:
        self.query_one("#gap-text", HangingLines).write_rows(rows)

    def on_resize(self, event: Resize) -> None:
        """Show as many channels as have room."""
        room = (1.0 - _TEXT_SHARE) * event.size.height
        count = max(1, int(room) // _ROWS_FOR_ONE)
        for k, name in enumerate(_SHOWN):
            self.query_one(f"#gap-{name}").display = k < count


def answer_rows(document: Document) -> Iterator[Labelled]:
    """Yield rows: the answer, its certainty and limits, the differences, the reduction of the gap, the next
    steps and the reasons.
    """
    part = document.get("lateral") or document
    if part["sentence"] is None:
        yield from (("✗ ", f"{problem['text']} {problem['fix']}") for problem in document["problems"])
        return
    axis = "" if part is document else "Roll and yaw. "
    yield "", f"{axis}{part['title']}: {part['sentence']}"
    if part["how_sure"]:
        yield "", part["how_sure"]
    yield from (("! ", limit) for limit in part["limits"])
    yield from (("  ", change["text"]) for change in part["parameters_changed"])
    size, shrink = part["gap"], part["shrink"]
    yield from (("", entry["text"]) for entry in (size, shrink) if entry is not None)
    if size is not None and size["grown"]:
        yield f"{WORSE} ", size["grown"]
    for number, step in enumerate(part["next"], start=1):
        yield f"{number}. ", " ".join(filter(None, (step["text"], step["command"])))
    if part["why"]:
        yield "", part["why_heading"]
        reasons = weighed((reason["nats"], reason["text"]) for reason in part["why"])
        yield from ((f"{nats:>6}  ", said) for nats, said in reasons)


def _empty(name: str) -> Chart:
    return Chart(channel(name).label, "t [s]", why_empty="no diagnosis yet.")


def _chart(name: str, trace: Mapping[str, Any]) -> Chart:
    quantity = channel(name)
    t = np.asarray(trace["t"])
    measured, before, after = (
        quantity.factor * np.asarray(trace[curve]) for curve in ("measured", "before", "after")
    )
    return Chart(
        quantity.label,
        "t [s]",
        series=(
            Series("measured", t - t[0], measured, "measured", "points"),
            Series("before", t - t[0], before, "residual"),
            Series("after", t - t[0], after, "fitted"),
        ),
    )
