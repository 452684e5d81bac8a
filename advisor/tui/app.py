"""The terminal application: one campaign, two screens."""

import gc
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import partial
from math import inf
from pathlib import Path, PurePath
from time import monotonic
from typing import Any, ClassVar

from textual.app import SystemCommand
from textual.binding import BindingType
from textual.css.stylesheet import Stylesheet
from textual.events import Event, Key
from textual.message import Message
from textual.screen import Screen
from textual.theme import Theme
from textual.worker import Worker, WorkerState

from advisor.aircraft.aircraft import Aircraft
from advisor.session.conducting import (
    Conducting,
    SessionReport,
    Tempo,
    View,
    view_before_first,
    view_sideways,
)
from advisor.tui import keys
from advisor.tui.actions import LINK_ACTIONS, REPLAY_ACTIONS, HandActions, LinkActions, ReplayActions
from advisor.tui.explaining import Explain, commands, explanation
from advisor.tui.panes.flight import WholeFlightPane
from advisor.tui.screens.engineer import EngineerScreen
from advisor.tui.screens.face import Face, ReplayBar
from advisor.tui.screens.pilot import PilotScreen
from advisor.tui.settings import Settings
from advisor.tui.sound import Sound, Voice
from advisor.tui.themes import NAMES, THEMES
from advisor.words.problems import UnusableInputError


class Sheet(Stylesheet):
    """Style sheet that parses each rule once while its variables are unchanged."""

    def __init__(self, variables: dict[str, str]) -> None:
        super().__init__(variables=variables)
        self._parsed_with = variables

    def set_variables(self, variables: dict[str, str]) -> None:
        """Set the variables of the style sheet. Only changed variables need new rules."""
        if variables != self._parsed_with:
            self._parsed_with = variables
            super().set_variables(variables)

    def reparse(self) -> None:
        """Parse the new parts of the style sheet."""
        self.parse()


class Sheets:
    """The style sheets of all themes."""

    def __init__(self, themes: Sequence[Theme]) -> None:
        self._sheets = {
            theme.name: Sheet({**theme.to_color_system().generate(), **theme.variables}) for theme in themes
        }

    def of(self, theme: str, now: Stylesheet) -> Sheet:
        """Return the sheet of a theme with all sources that the present sheet has read, in equal order."""
        sheet = self._sheets[theme]
        for place, source in now.source.items():
            sheet.add_source(source.content, place, source.is_defaults, source.tie_breaker, source.scope)
        return sheet

    def prepare(self, now: Stylesheet) -> bool:
        """Parse one incomplete sheet; return False if all sheets are complete."""
        lacking = (name for name, sheet in self._sheets.items() if sheet.source.keys() != now.source.keys())
        theme = next(lacking, None)
        if theme is not None:
            self.of(theme, now).parse()
        return theme is not None


_LOT = 5_000
"""Number of new objects after which garbage is collected; a collection takes one millisecond. Painting a
large screen makes five times as many objects.
"""
_LOTS = 5
"""Number of collections of new objects after which all objects are examined."""


class Garbage:
    """Runs garbage collections at times without a pending key, instead of Python's own.

    Python's own run while a key is being answered, and an examination of all objects takes 10 to 50 ms.
    """

    def begin(self) -> None:
        """Stop Python's own garbage collection. Objects that exist already are never examined."""
        gc.freeze()
        gc.disable()

    def end(self) -> None:
        """Start Python's own garbage collection again."""
        gc.enable()
        gc.unfreeze()

    def collect_if_due(self) -> None:
        """Collect garbage once enough new objects exist."""
        new, lots, _ = gc.get_count()
        if lots >= _LOTS:
            gc.collect()
        elif new >= _LOT:
            gc.collect(0)


_TWICE_WITHIN_S = 3.0
_AT_ONCE_S = 0.001
_BREATH_S, _QUIET_S = 0.02, 0.5
"""Delays after the answer to a key, and without any key, before work that would delay a key, s."""

_ANSWER_S = 0.03
"""Delay of reports after a key, s, so that the key's answer is painted before the reports' changes."""


class AdvisorApp(ReplayActions, LinkActions, HandActions):
    """Shows a campaign on a link, a log or a demonstration, until the user leaves.

    Parameters
    ----------
    conductor : Conducting
        Object that runs the campaign. It starts after the first paint, in a thread that only receives
        reports.
    tempo : Tempo, optional
        Start settings of a replay. None if the source is no replay.
    logs : sequence of Path
        Logs and recordings of each flight. Panes are saved next to them; without a log, panes are saved in
        the current folder.
    aircraft_file : Path, optional
        File of the aircraft, for the commands that the gap's pane names.
    """

    TITLE = "inflight advisor"
    # The screens' styles as well: read when a screen comes up, they would restyle the earlier screen.
    CSS_PATH: ClassVar[list[str | PurePath]] = [
        f"styles/{name}.tcss" for name in ("app", "pilot", "engineer", "explain")
    ]
    BINDINGS: ClassVar[list[BindingType]] = [*keys.EVERYWHERE, *keys.REPLAY, *keys.SELDOM]
    MODES: ClassVar[dict[str, str | Callable[[], Screen[Any]]]] = {
        "pilot": PilotScreen,
        "engineer": EngineerScreen,
    }

    class Told(Message):
        """The conductor has a new report."""

        def __init__(self, report: SessionReport) -> None:
            super().__init__()
            self.report = report

        def can_replace(self, message: Message) -> bool:
            """Let a newer report replace this one, so that reports do not pile up on a slow terminal."""
            return isinstance(message, type(self))

    def __init__(
        self,
        conductor: Conducting,
        aircraft: Aircraft,
        title: str,
        tempo: Tempo | None = None,
        settings: Settings | None = None,
        logs: Sequence[Path] = (),
        aircraft_file: Path | None = None,
    ) -> None:
        super().__init__()
        self.settings = settings or Settings()
        self.view = view_before_first(aircraft, title, tempo, tuple(logs), aircraft_file)
        self.conductor = conductor
        self.failure: BaseException | None = None
        """Error for the caller: the thread's failure, or the reason for which the source could not be
        used."""
        self._leaving_s = self._pressed_s = -inf
        self._report: SessionReport | None = None
        """Newest report that is not shown yet."""
        self._garbage = Garbage()
        self._sideways = False
        """Whether roll and yaw are shown instead of pitch."""
        self._axis_chosen = False
        """Whether the shown axis was chosen, by a key or by the first manoeuvre."""
        self._sheets = Sheets(THEMES)
        self._voice = Voice()
        self._sound = Sound(self.bell, self._speak)
        self._sound.on = self.settings.sound
        for theme in THEMES:
            self.register_theme(theme)
        self.theme = self.settings.theme
        self.stylesheet = self._sheets.of(self.theme, self.stylesheet)
        # The palette would offer Textual's own themes, which have no colours for plots.
        for name in set(self.available_themes) - set(NAMES):
            self.unregister_theme(name)
        self.set_keymap(dict(self.settings.keys))

    async def on_mount(self) -> None:
        """Paint first, then start the conductor."""
        await self.action_face(self.settings.screen)
        run = partial(self.conductor.run, lambda report: self.post_message(self.Told(report)))
        self.call_after_refresh(self.run_worker, run, thread=True, exit_on_error=False)
        self._garbage.begin()
        self.set_interval(_QUIET_S, self._tidy_if_quiet)

    def on_unmount(self) -> None:
        self.conductor.stop()
        self._garbage.end()

    async def on_event(self, event: Event) -> None:
        """Answer a key. Start the timers of garbage collection after a key, because the moment after the
        answer is the best time.
        """
        await super().on_event(event)
        if isinstance(event, Key):
            self._pressed_s = monotonic()
            self.call_after_refresh(self.set_timer, _BREATH_S, self._tidy)

    def _tidy_if_quiet(self) -> None:
        """Collect garbage when no key is being answered."""
        if monotonic() - self._pressed_s > _QUIET_S:
            self._tidy()

    def _tidy(self) -> None:
        """Prepare one style sheet, or collect garbage. Both would delay the answer to a key."""
        if not self._sheets.prepare(self.stylesheet):
            self._garbage.collect_if_due()

    def on_advisor_app_told(self, event: Told) -> None:
        """Show the newest report, after a key's answer if one is pending."""
        waiting, self._report = self._report is not None, event.report
        due_s = self._pressed_s + _ANSWER_S - monotonic()
        if due_s <= 0.0:
            self._show_report()
        elif not waiting:
            self.set_timer(due_s, self._show_report)

    def _show_report(self) -> None:
        report, self._report = self._report, None
        if report is None:
            return
        view = replace(
            self.view,
            state=report.state,
            health=report.health,
            playback=report.playback,
            log=report.log,
            problems=report.problems,
        )
        self._open_on_the_axis_flown(report)
        if report.health.condition == "ended" and report.problems:
            problem = report.problems[0]
            self.failure = UnusableInputError(problem.code, problem.text, problem.fix)
        self.show(view)

    def _open_on_the_axis_flown(self, report: SessionReport) -> None:
        """Show the axis of the first manoeuvre, unless a key has chosen an axis."""
        axes = report.state.axes.values()
        if self._axis_chosen or not any(axis.has_begun for axis in axes):
            return
        self._axis_chosen = True
        if report.state.tested_sideways is not None:
            self._sideways = True
            self.refresh_bindings()

    def on_worker_state_changed(self, event: Worker.StateChanged) -> None:
        """Leave when the source is found unusable. The caller prints the reason."""
        if event.state is WorkerState.ERROR:
            self.failure = event.worker.error
            self.exit()

    def on_replay_bar_sought(self, event: ReplayBar.Sought) -> None:
        """Go to the place on the bar that was clicked."""
        self.seek(event.position_s)

    def on_whole_flight_pane_sought(self, event: WholeFlightPane.Sought) -> None:
        """Go to the time that the user has clicked."""
        self.go_to(event.at_s)

    def on_face_decided(self, event: Face.Decided) -> None:
        """Send a decision to the campaign."""
        self.conductor.decide(event.decision)

    def show(self, view: View) -> None:
        """Show another moment on the screens."""
        self.view = view
        shown = view_sideways(view) if self._sideways else view
        self._sound.hear(shown)
        for screen in self.screen_stack:
            if isinstance(screen, Face):
                screen.show(shown)

    def say(self, text: str, seconds: float = 3.0) -> None:
        """Show a text on the last line of the screen for a while, or next to an open dialog."""
        if isinstance(self.screen, Face):
            self.screen.say(text, seconds)
        else:
            self.notify(text, timeout=seconds, markup=False)

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Allow the replay's actions only in a replay, and the link's actions only on a link."""
        if self._sideways and action in ("jump", "jump_by"):
            return False
        only_elsewhere = LINK_ACTIONS if self.view.tempo is not None else REPLAY_ACTIONS
        return action not in only_elsewhere

    def get_system_commands(self, screen: Screen[object]) -> Iterable[SystemCommand]:
        """Yield Textual's own commands that no action of the advisor replaces, then the advisor's actions."""
        mine = commands(self, screen)
        names = {command.title for command in mine}
        yield from (own for own in super().get_system_commands(screen) if own.title not in names)
        yield from mine

    async def action_face(self, name: str) -> None:
        """Switch to the pilot's or the engineer's screen."""
        await self.switch_mode(name)
        self.show(self.view)

    def action_other_axis(self) -> None:
        """Show roll and yaw instead of the elevator's axis, or the elevator's axis again."""
        self._axis_chosen = True
        self._sideways = not self._sideways
        self.show(self.view)
        self.refresh_bindings()
        self.say("axis: roll and yaw" if self._sideways else "axis: elevator")

    def delay_update(self, delay: float = _AT_ONCE_S) -> None:
        """Paint the screen immediately. Textual would hide transitions for 50 ms, and mounted screens have
        none."""
        super().delay_update(_AT_ONCE_S)

    def refresh_css(self, animate: bool = True) -> None:
        """Apply the theme's style sheet to all widgets."""
        self.stylesheet = self._sheets.of(self.theme, self.stylesheet)
        super().refresh_css(animate)

    def action_next_theme(self) -> None:
        here = NAMES.index(self.theme) if self.theme in NAMES else -1
        theme = NAMES[(here + 1) % len(NAMES)]
        self.theme = theme
        self.say(f"theme: {theme}")

    def _speak(self, text: str) -> None:
        """Speak a text, except for a viewer in a browser, whose voice would sound at the server."""
        if not self.is_web:
            self._voice(text)

    def action_sound(self) -> None:
        """Turn bell and voice off or on."""
        self._sound.on = not self._sound.on
        self.say(f"bell and voice: {'on' if self._sound.on else 'off'}")

    def action_explain(self) -> None:
        """Show the help on the focused pane."""
        self.push_screen(Explain(explanation(self)))

    async def action_quit(self) -> None:
        """Quit as `action_leave` does. Textual's own ctrl+q and palette would leave a live link at once."""
        self.action_leave()

    def action_help_quit(self) -> None:
        """Quit by ctrl+c. Textual's own action only explains how to quit."""
        self.action_leave()

    def action_leave(self) -> None:
        """Quit the application. On a live link, a second request is needed."""
        over = self.view.tempo is not None or self.view.health.condition == "ended"
        if over or monotonic() - self._leaving_s < _TWICE_WITHIN_S:
            self.exit()
            return
        self._leaving_s = monotonic()
        is_lost = self.view.health.condition == "lost"
        link = "The link is lost and may come back" if is_lost else "The link is live"
        self.say(f"{link}. Press the key once more to stop advising.", _TWICE_WITHIN_S)
