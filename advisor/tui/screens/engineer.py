"""The engineer's screen, with all numbers behind the pilot's word."""

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import replace
from io import StringIO

from rich.style import Style
from rich.text import Text
from textual.app import ComposeResult
from textual.containers import Container
from textual.events import Resize
from textual.geometry import Size
from textual.widgets import Static

from advisor.campaign.state import HandDecision, Verb
from advisor.session.conducting import View
from advisor.tui import keys
from advisor.tui.panes.channels import Channels, EventLogPane
from advisor.tui.panes.correlation import Correlation
from advisor.tui.panes.courses import Courses, Criterion
from advisor.tui.panes.fit import Fit
from advisor.tui.panes.flight import WholeFlightPane
from advisor.tui.panes.gap import GapPane
from advisor.tui.panes.last_verdict import VerdictPane
from advisor.tui.panes.live import Live
from advisor.tui.panes.maneuvers import Maneuvers
from advisor.tui.panes.pane import Pane, Redrawn
from advisor.tui.panes.parameters import ParametersPane, Qualities
from advisor.tui.panes.residuals import Residuals
from advisor.tui.screens.face import Alarm, Ask, Face, KeysLine, ReplayBar, StatusLine
from advisor.tui.taking import files_of, pane_name, save
from advisor.words.axes import AxisName

_SAY_S = 8.0
"""Time for which a sentence with a file path is shown, s. A path takes longer to read than a short message.
"""


class PaneActions(Face):
    """A screen whose keys act on the pane in front."""

    _view: View | None

    @abstractmethod
    def pane_in_front(self) -> Pane:
        """Return the pane with the focus, else the pane that was chosen last."""

    def action_copy(self) -> None:
        """Copy the pane to the clipboard of the terminal."""
        if self._view is None:
            return
        if self.app.is_web:
            self.say("the page cannot write the browser's clipboard; key s offers the pane as files", _SAY_S)
            return
        pane = self.pane_in_front()
        text = pane.text()
        self.app.copy_to_clipboard(text)
        what = f"{pane_name(pane, self._view)} copied, {text.count(chr(10))} lines."
        self.say(f"{what} If your terminal cannot copy (it lacks OSC 52), press s.", _SAY_S)

    def action_save(self) -> None:
        """Write the pane into files in the folder of the log, or offer the files to a browser."""
        if self._view is None:
            return
        pane = self.pane_in_front()
        if not self.app.is_web:
            self.say(save(pane, self._view), _SAY_S)
            return
        files = files_of(pane, self._view)
        for name, text in files.items():
            self.app.deliver_text(StringIO(text), save_filename=name)
        self.say(f"your browser is offered {' and '.join(files)}", _SAY_S)

    def action_next_output(self) -> None:
        """Bring the next output of the fit to the top."""
        self.query_one(Fit).next_output()

    def action_lay_over(self) -> None:
        """Lay the next channel over the whole flight, or ask for a manoeuvre to lay over the selected one."""
        pane = self.pane_in_front()
        if isinstance(pane, WholeFlightPane):
            pane.lay_over_next()
            return
        self.ask(
            "Number of the manoeuvre to lay over (0: none):",
            lambda answer: self._lay_over(int(answer)),
            integer=True,
        )

    def _lay_over(self, number: int) -> None:
        view = self._view
        judged = view.judged if view is not None else None
        if view is None or judged is None:
            self.say("There is no manoeuvre yet over which another could be laid.")
            return
        numbers = {j.maneuver.number for j in view.state.maneuvers}
        if number and (number not in numbers or number == judged.maneuver.number):
            self.say(f"Choose another manoeuvre than {judged.maneuver.number}, from {_listed(numbers)}.")
            return
        self.query_one(Fit).lay_over(number or None)
        self.show(view)


def _listed(numbers: set[int]) -> str:
    return f"{min(numbers)} to {max(numbers)}"


_BRACKETS = 2


class PaneTabs(Redrawn, Static):
    """Numbered names of the panes on one line, with the visible pane in brackets. A click chooses a pane."""

    def __init__(self, titles: Sequence[str], short: Sequence[str]) -> None:
        super().__init__()
        self._titles, self._short = titles, short
        self._chosen = 0

    def choose(self, number: int) -> None:
        self._chosen = number
        self._redraw()

    def _redraw(self) -> None:
        room = self.size.width - _BRACKETS
        titles = self._titles if len(" ".join(self._titles)) <= room else self._short
        line = Text()
        for k, title in enumerate(titles, 1):
            press = Style(meta={"@click": f"screen.choose({k})"})
            line.append(f"[{title}]" if k == self._chosen else title, press)
            line.append(" " if k < len(titles) else "")
        self.update(line, layout=False)


# In the order of their numbers.
PANES: tuple[type[Pane], ...] = (
    Maneuvers, VerdictPane, ParametersPane, Fit, Live, Criterion, Channels, EventLogPane, Residuals,
    Correlation, Courses, Qualities, WholeFlightPane, GapPane,
)  # fmt: skip
_COLUMNS: dict[str, tuple[type[Pane], ...]] = {
    "left": (Maneuvers, VerdictPane, ParametersPane),
    "middle": (Fit, Residuals, Correlation, Courses, Qualities, WholeFlightPane, GapPane),
    "right": (Live, Criterion, Channels, EventLogPane),
}
_LAYOUTS = {"-wide": (160, 42), "-medium": (110, 30), "-narrow": (0, 0)}
"""Style class of each layout, with the least columns and rows of the terminal, the largest layout first."""
_LOW = 7
"""Number of rows of the manoeuvre table above a single pane."""
_LOW_TABLE = 38
"""Height of a terminal, in rows, below which the parameter table shows four of its eight rows at once."""


class EngineerScreen(PaneActions):
    """Screen of fourteen panes.

    A wide terminal shows eight panes at once, a small terminal one pane next to or below the manoeuvres.
    """

    BINDINGS = keys.ENGINEER
    HELP = """\
# Engineer

**1** to **9**, **0** and **h** go to a pane, **tab** to the next; **?** explains the pane that has the
focus. On a small terminal one pane is shown with the manoeuvres. On a wide one all are, but fit,
residuals, correlation and history share one place.

**c** copies the pane that has the focus to the clipboard: its numbers as CSV, its words as text. **s**
saves them into a file next to the log or the recording, and its plots as a picture (SVG). A browser
is offered the files instead.

**r** shows roll and yaw, and the elevator again. A pane with *(elevator)* in its title stays. **x** and **n**
work on the manoeuvres that are shown.
"""

    def __init__(self) -> None:
        super().__init__()
        self._view: View | None = None
        self._chosen: type[Pane] = Fit
        self._beside: type[Pane] = Fit
        self._middle: type[Pane] = Fit

    def compose(self) -> ComposeResult:
        """Lay out the panes in three columns. The style sheet hides panes without room."""
        self._lay_out(self.app.size)
        yield StatusLine()
        yield Alarm()
        titles = [pane.TITLE.removesuffix(" and link") for pane in PANES]
        yield PaneTabs(titles, [pane.SHORT for pane in PANES])
        with Container(id="panes"):
            for column, panes in _COLUMNS.items():
                yield Container(*(pane() for pane in panes), id=column, classes="column")
        yield ReplayBar()
        yield Ask()
        yield KeysLine()

    def on_mount(self) -> None:
        """Begin with the fit next to the manoeuvres."""
        self.action_choose(PANES.index(Fit) + 1)
        self.query_one("Maneuvers DataTable").focus()

    def on_resize(self, event: Resize) -> None:
        """Choose the layout that the terminal has room for."""
        self._lay_out(event.size)
        self._arrange()
        self.call_after_refresh(self._refresh_panes)

    def _lay_out(self, size: Size) -> None:
        """Set the style class of the layout, only if it differs, because every change of classes restyles all
        panes.
        """
        layout = next(name for name, (w, h) in _LAYOUTS.items() if size.width >= w and size.height >= h)
        classes = self.classes - {*_LAYOUTS, "-low"} | {layout, *["-low"] * (size.height < _LOW_TABLE)}
        if classes != self.classes:
            self.set_classes(classes)

    def show(self, view: View) -> None:
        """Update the visible panes."""
        same_axis = self._view is not None and (self._view.elevator is None) == (view.elevator is None)
        selected = self._view.selected if self._view is not None and same_axis else None
        if not same_axis:
            for pane in self.query("Pane"):
                stays = view.elevator is not None and getattr(pane, "OF_ELEVATOR", False)
                pane.border_title = f"{getattr(pane, 'TITLE', '')}{' (elevator)' if stays else ''}"
        self._view = replace(view, selected=selected)
        self._refresh_panes()

    def _refresh_panes(self) -> None:
        if self._view is not None:
            super().show(self._view)

    def on_maneuvers_selected(self, event: Maneuvers.Selected) -> None:
        """Show another manoeuvre in every pane."""
        if self._view is not None:
            self._view = replace(self._view, selected=event.number)
            self._refresh_panes()

    def action_choose(self, number: int) -> None:
        """Show a pane and give it the focus."""
        kind = PANES[number - 1]
        if number > 1:
            self._chosen = kind
        if kind not in _COLUMNS["left"]:
            self._beside = kind
        if kind in _COLUMNS["middle"]:
            self._middle = kind
        self._arrange()
        chosen = self.query_one(kind.__name__)
        self.query_one(PaneTabs).choose(number)
        inner = chosen.query("DataTable, VerticalScroll")
        (inner.first() if inner else chosen).focus()
        if isinstance(chosen, GapPane) and self._view is not None:
            chosen.ask(self._view)
        self._refresh_panes()

    def _arrange(self) -> None:
        """Show the panes that have room. The code sets no style classes, because a change of classes restyles
        all widgets of a pane.
        """
        narrow = self.has_class("-narrow")
        shown = {Maneuvers, self._chosen} if narrow else {*_COLUMNS["left"], self._beside}
        if self.has_class("-wide"):
            shown = {*_COLUMNS["left"], self._middle, *_COLUMNS["right"]}
        for pane in self.query("Pane"):
            pane.display = type(pane) in shown
        for column in self.query(".column"):
            column.display = any(pane.display for pane in column.children)
        alone = narrow and self._chosen not in _COLUMNS["left"]
        self.query_one("#left").styles.height = _LOW if alone else "1fr"

    def pane_in_front(self) -> Pane:
        """Return the pane with the focus, else the pane chosen last."""
        around = self.focused.ancestors_with_self if self.focused else ()
        focused = next((node for node in around if isinstance(node, Pane)), None)
        return focused or self.query_one(self._chosen)

    def action_exclude(self) -> None:
        """Exclude the selected manoeuvre from every decision, or include it again; ask for the reason."""
        judged = self._view.judged if self._view else None
        if judged is None:
            self.say("There is no manoeuvre to exclude yet.")
            return
        verb: Verb = "exclude" if judged.excluded_because is None else "include"
        self._ask(verb, judged.maneuver.number, f"Why {verb} manoeuvre {judged.maneuver.number}?")

    def action_note(self) -> None:
        """Add a note to the selected manoeuvre."""
        judged = self._view.judged if self._view else None
        if judged is None:
            self.say("There is no manoeuvre yet that could take a note.")
            return
        self._ask("note", judged.maneuver.number, f"Note on manoeuvre {judged.maneuver.number}:")

    def _ask(self, verb: Verb, number: int, question: str) -> None:
        shown: AxisName = "pitch" if self._view is None or self._view.elevator is None else "lateral"
        self.ask(question, lambda text: self._decided(HandDecision(verb, text, number, shown)))

    def _decided(self, decision: HandDecision) -> None:
        """Send a decision to the campaign, and show a message. The table shows the decision after the
        verdicts are computed again.
        """
        self.post_message(self.Decided(decision))
        if decision.verb != "note":
            self.say(f"{decision.verb} manoeuvre {decision.number}: all verdicts are computed again")
