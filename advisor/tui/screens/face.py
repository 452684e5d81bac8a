"""The base class of both screens, their status line, and a question with a one-line answer."""

from collections.abc import Callable
from contextlib import suppress
from functools import partial
from math import isinf
from typing import ClassVar

from rich.style import Style
from rich.text import Text
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Horizontal
from textual.css.query import NoMatches
from textual.events import Click, Event, ScreenResume
from textual.message import Message
from textual.screen import Screen
from textual.timer import Timer
from textual.widget import Widget
from textual.widgets import Input, Label, Static

from advisor.campaign.state import HandDecision
from advisor.process.parts import Parts
from advisor.session.behind import spoken
from advisor.session.conducting import Playback, View
from advisor.tui.panes.pane import Lines, Part, Redrawn
from advisor.words.quantities import clock

_WIDTH = 24


class ReplayBar(Part, Lines):
    """State of the replay, its speed, its position in the log, and the vehicle's time there. A click on the
    bar moves the replay to that position."""

    class Sought(Message):
        """A position on the bar was clicked."""

        def __init__(self, position_s: float) -> None:
            super().__init__()
            self.position_s = position_s

    _begins = 0
    """Column at which the bar begins."""
    _duration_s = 0.0

    def show(self, view: View) -> None:
        """Write the line if the source is a replay."""
        tempo, playback = view.tempo, view.playback or Playback(0.0, 0.0)
        self.set_class(tempo is not None, "-playing")
        if tempo is None:
            return
        speed = "max" if isinf(tempo.speed) else f"{tempo.speed:g} ×"
        share = playback.position_s / playback.duration_s if playback.duration_s else 0.0
        place = "━" * round(share * _WIDTH) + "─" * (_WIDTH - round(share * _WIDTH))
        over = 0.0 < playback.duration_s <= playback.position_s
        state = "❚❚ paused" if tempo.paused else "■ at the end" if over else "► replay"
        jump = "  ►► jumping" if playback.hurrying else ""
        before = f"{state}  {speed}  "
        self._begins, self._duration_s = len(before), playback.duration_s
        self.write(f"{before}{place}  {100.0 * share:3.0f} %  at {_now(view)}{jump}")

    def on_click(self, event: Click) -> None:
        column = event.x - self.styles.padding.left - self._begins
        if 0 <= column < _WIDTH:
            self.post_message(self.Sought(column / _WIDTH * self._duration_s))


def _now(view: View) -> str:
    """Return the vehicle's time. The flight's and the power-on's numbers follow if there are several."""
    state = view.state
    flight = f"flight {state.flight + 1}, " if state.flight else ""
    power_on = f"power-on {state.boot + 1}, " if state.boot else ""
    return f"{flight}{power_on}{clock(state.now_s)}"


CONDITIONS = {
    "good": "✓ link good",
    "poor": "! link poor",
    "waiting": "… waiting",
    "lost": "✗ LINK LOST",
    "stale": "✗ NOT ANSWERING",
    "ended": "■ end of log",
}


class StatusLine(Part, Lines):
    """Condition of the link by symbol and word, recording, aircraft, vehicle, mode and source."""

    EITHER_AXIS = True

    def show(self, view: View) -> None:
        """Write the line. Write the line. Its colour follows the link's condition."""
        state = view.state
        vehicle = str(state.vehicle) if state.vehicle else "no vehicle yet"
        parts = [
            CONDITIONS[view.health.condition],
            f"✗ {spoken(view.health.behind_s)} BEHIND" if view.health.behind else "",
            view.health.recording,
            view.aircraft.name,
            vehicle,
            state.mode,
            view.title,
            "ROLL AND YAW" if view.elevator is not None else "",
        ]
        self.write("  ·  ".join(part for part in parts if part))
        for condition in CONDITIONS:
            self.set_class(condition == view.health.condition, f"-{condition}")
        self.set_class(bool(view.health.behind), "-behind")


_MARGINS = 2
"""Number of columns to the left and right of a message together."""


class KeysLine(Redrawn, Static):
    """Keys and their actions, in the order of importance. A click on an action presses its key.

    The line is one text. Textual's footer would mount a widget for every key whenever the focus moves. A
    message replaces the keys and needs no new layout. Textual's toasts would appear one repaint later.
    """

    def __init__(self) -> None:
        super().__init__()
        self._keys: list[tuple[str, str, str]] = []
        self._said = ""
        self._until: Timer | None = None

    def on_mount(self) -> None:
        self.screen.bindings_updated_signal.subscribe(self, self._follow)

    def has_room_for(self, text: str) -> bool:
        """Return whether a text fits on the line without being cut."""
        return len(text) + _MARGINS <= self.size.width

    def say(self, text: str, seconds: float) -> None:
        """Show a message instead of the keys. A message that is still shown is replaced."""
        if self._until is not None:
            self._until.stop()
        self._until = self.set_timer(seconds, self._said_enough)
        self._said = text
        self._redraw()

    def _said_enough(self) -> None:
        self._said = ""
        self._redraw()

    def _follow(self, screen: Screen[object]) -> None:
        first: dict[str, Binding] = {}
        for active in screen.active_bindings.values():
            if active.binding.show and active.enabled:
                first.setdefault(active.binding.action, active.binding)
        keys = [(b.key, self.app.get_key_display(b), b.description) for b in first.values()]
        if keys != self._keys:
            self._keys = keys
            self._redraw()

    def _redraw(self) -> None:
        line = Text(f" {self._said} " if self._said else "", Style(reverse=True), no_wrap=True)
        for key, display, does in self._keys if not self._said else ():
            if line.cell_len + len(display) + len(does) + 2 > self.size.width:
                break
            press = {"@click": f"app.simulate_key('{key}')"}
            line.append(f" {display}", Style(bold=True, meta=press))
            line.append(f" {does}", Style(meta=press))
        self.update(line, layout=False)


class Alarm(Part, Lines):
    """One line that is visible only while data are being lost, for example because the disk is full."""

    def show(self, view: View) -> None:
        """Write the warning, and show the line while there is a warning."""
        self.write(f"✗ {view.health.alarm}" if view.health.alarm else "")
        self.set_class(bool(view.health.alarm), "-on")


class Ask(Horizontal):
    """Asks for a reason, a note or a number. The Escape key leaves everything unchanged.

    The question is a line and not a dialog, so that the subject of the question stays visible.
    """

    BINDINGS: ClassVar[list[BindingType]] = [Binding("escape", "leave", "Leave it")]

    def __init__(self) -> None:
        super().__init__()
        self._answered: Callable[[str], object] = lambda answer: None
        self._focused_before: Widget | None = None

    def compose(self) -> ComposeResult:
        """Yield the question and the answer, side by side."""
        yield Label(markup=False)
        yield Input(compact=True)

    def put(self, question: str, answered: Callable[[str], object], *, integer: bool = False) -> None:
        """Show a question and take the focus. A question that is still open is replaced.

        Parameters
        ----------
        integer : bool
            Whether the answer must be a whole number.
        """
        if not self.has_class("-open"):
            self._focused_before = self.screen.focused
        self._answered = answered
        self.query_one(Label).update(question)
        answer = self.query_one(Input)
        answer.type = "integer" if integer else "text"
        answer.value = ""
        self.add_class("-open")
        answer.focus()

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Send the answer to the function that waits for it."""
        event.stop()
        answer = event.value.strip()
        if answer and (event.validation_result is None or event.validation_result.is_valid):
            self.action_leave()
            self._answered(answer)

    def action_leave(self) -> None:
        """Close the question, and return the keys to the screen."""
        self.screen.set_focus(self._focused_before)
        self.remove_class("-open")


class Face(Screen[None]):
    """A screen that receives every new `View`."""

    AUTO_FOCUS = ""

    class Decided(Message):
        """A crew member has excluded, included or noted on a manoeuvre."""

        def __init__(self, decision: HandDecision) -> None:
            super().__init__()
            self.decision = decision

    def __init__(self) -> None:
        super().__init__()
        self._parts = Parts(lambda failed: self.notify(str(failed.problem), severity="error", markup=False))

    async def on_event(self, event: Event) -> None:
        """Resume a screen without new styles. The switch of screens already applies a theme that changed
        meanwhile.
        """
        if isinstance(event, ScreenResume):
            event.refresh_styles = False
        await super().on_event(event)

    def ask(self, question: str, answered: Callable[[str], object], *, integer: bool = False) -> None:
        """Ask for one line of text at the foot of the screen."""
        self.query_one(Ask).put(question, answered, integer=integer)

    def say(self, text: str, seconds: float = 3.0) -> None:
        """Show a text on the last line, for a while. A text without room there appears above the line."""
        line = self.query_one(KeysLine)
        if line.has_room_for(text):
            line.say(text, seconds)
        else:
            self.notify(text, timeout=seconds, markup=False)

    def show(self, view: View) -> None:
        """Show the state of a new moment in every visible part."""
        # A report may still arrive while the screen is taken down, its innermost widgets first.
        with suppress(NoMatches):
            for node in self.walk_children():
                if isinstance(node, Part) and node.wants_showing:
                    shown = view if node.EITHER_AXIS else view.elevator or view
                    name = f"pane {node.id or type(node).__name__}"
                    self._parts.make(name, partial(node.show, shown), lambda failed: None)
