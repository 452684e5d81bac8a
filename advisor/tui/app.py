"""The terminal application: one source, one campaign, two screens."""

import sys
from collections.abc import Callable, Iterable
from dataclasses import replace
from math import inf
from time import monotonic
from typing import Any, ClassVar

from textual.app import App, SystemCommand
from textual.binding import BindingType
from textual.message import Message
from textual.screen import Screen
from textual.worker import Worker, WorkerState

from advisor.aircraft import Aircraft
from advisor.problems import UnusableInputError
from advisor.tui import keys, replay_actions
from advisor.tui.campaign_like import CampaignLike
from advisor.tui.conductor import Conductor, Report
from advisor.tui.explaining import explanation, keys_at_hand
from advisor.tui.hand import HandDecision
from advisor.tui.screens.engineer import EngineerScreen
from advisor.tui.screens.face import Face
from advisor.tui.screens.pilot import PilotScreen
from advisor.tui.settings import Settings
from advisor.tui.source import Playable, Source
from advisor.tui.themes import NAMES, THEMES
from advisor.tui.view import view_before_first

_TWICE_WITHIN_S = 3.0
_GIVE_WAY_S = 0.001


class AdvisorApp(replay_actions.ReplayActions, App[None]):
    """Shows what a campaign says of a source, until the user leaves.

    Parameters
    ----------
    source : Source
        A link, a log or a demonstration.
    make_campaign : callable
        Makes an empty `advisor.campaign.Campaign`; called in the working thread.
    aircraft : Aircraft
        The aircraft file: name, prior model, stop criterion.
    settings : Settings, optional
        Theme, first screen, keys.
    """

    TITLE = "inflight advisor"
    CSS_PATH = "styles/app.tcss"
    BINDINGS: ClassVar[list[BindingType]] = [*keys.EVERYWHERE, *keys.REPLAY, *keys.SELDOM]
    MODES: ClassVar[dict[str, str | Callable[[], Screen[Any]]]] = {
        "pilot": PilotScreen,
        "engineer": EngineerScreen,
    }

    class Told(Message):
        """The conductor has something new."""

        def __init__(self, report: Report) -> None:
            super().__init__()
            self.report = report

    def __init__(
        self,
        source: Source,
        make_campaign: Callable[[], CampaignLike],
        aircraft: Aircraft,
        settings: Settings | None = None,
    ) -> None:
        super().__init__()
        self.settings = settings or Settings()
        self.source = source
        self.view = view_before_first(aircraft, source)
        self.conductor = Conductor(source, make_campaign, lambda report: self.post_message(self.Told(report)))
        self.failure: BaseException | None = None
        """What the caller must answer for: why the thread broke off, or why the input could not be used."""
        self._leaving_s = -inf
        for theme in THEMES:
            self.register_theme(theme)
        self.theme = self.settings.theme
        self.set_keymap(dict(self.settings.keys))

    async def on_mount(self) -> None:
        """Paint first, then let the working thread import and compute."""
        # The estimates' thread must give way sooner than the interpreter's 5 ms, lest keys wait for it.
        sys.setswitchinterval(_GIVE_WAY_S)
        await self.action_face(self.settings.screen)
        self.call_after_refresh(self.run_worker, self.conductor.run, thread=True, exit_on_error=False)

    def on_unmount(self) -> None:
        """Let the working thread end."""
        self.conductor.stop()

    def on_advisor_app_told(self, event: Told) -> None:
        """Show the newest report."""
        report = event.report
        self.view = replace(
            self.view,
            state=report.state,
            health=report.health,
            playback=report.playback,
            log=report.log,
            problems=report.problems,
        )
        if report.health.condition == "ended" and report.problems:
            problem = report.problems[0]
            self.failure = UnusableInputError(problem.code, problem.text, problem.fix)
        self._show()

    def on_worker_state_changed(self, event: Worker.StateChanged) -> None:
        """Leave when the input turns out to be unusable; the caller says why."""
        if event.state is WorkerState.ERROR:
            self.failure = event.worker.error
            self.exit()

    def on_face_decided(self, event: Face.Decided) -> None:
        """Hand a decision to the campaign."""
        self.conductor.decide(event.decision)

    def _show(self) -> None:
        for screen in self.screen_stack:
            if isinstance(screen, Face):
                screen.show(self.view)

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Offer the replay's actions only in a replay."""
        return action not in replay_actions.ACTIONS or isinstance(self.source, Playable)

    def get_system_commands(self, screen: Screen[object]) -> Iterable[SystemCommand]:
        """Every action that has a key, after Textual's own commands."""
        yield from super().get_system_commands(screen)
        for key in keys_at_hand(self):
            yield SystemCommand(key.does, f"key: {key.shown}", key.run)

    async def action_face(self, name: str) -> None:
        """Switch to the pilot's or the engineer's screen."""
        await self.switch_mode(name)
        self._show()

    def action_next_theme(self) -> None:
        """Switch to the next theme."""
        here = NAMES.index(self.theme) if self.theme in NAMES else -1
        self.theme = NAMES[(here + 1) % len(NAMES)]
        self.notify(f"theme: {self.theme}", timeout=2)

    def action_explain(self) -> None:
        """Help for what has the focus."""
        # Reading Markdown takes longer to import than the first screen to paint.
        from advisor.tui.screens.explain import Explain

        self.push_screen(Explain(explanation(self)))

    def action_mark(self) -> None:
        """Mark this moment in the event log."""
        if isinstance(self.screen, Face):
            self.screen.ask("Mark this moment as:", self._mark)

    def _mark(self, text: str) -> None:
        self.conductor.decide(HandDecision("mark", text))

    def action_leave(self) -> None:
        """Quit; on a live link only when asked twice."""
        over = isinstance(self.source, Playable) or self.view.health.condition == "ended"
        if over or monotonic() - self._leaving_s < _TWICE_WITHIN_S:
            self.exit()
            return
        self._leaving_s = monotonic()
        self.notify("The link is live. Press the key once more to stop advising.", timeout=_TWICE_WITHIN_S)
