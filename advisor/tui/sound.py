"""A bell and a spoken word for each verdict, so that a pilot need not look."""

import shutil
from collections.abc import Callable
from subprocess import DEVNULL, Popen

from advisor.session.conducting import View
from advisor.tui.advice import advise
from advisor.tui.panes.last_verdict import for_the_pilot

_PROGRAMS = ("spd-say", "espeak-ng", "espeak", "say")
"""Programs that speak their argument, from Linux's speech dispatcher, from eSpeak, and from macOS."""


class Voice:
    """Speaks with the system's own program; silent without such a program."""

    def __init__(self) -> None:
        self._program = next(filter(None, map(shutil.which, _PROGRAMS)), None)
        self._speaking: Popen[bytes] | None = None

    def __call__(self, text: str) -> None:
        """Speak a text. The call returns at once. A text that is still spoken is not interrupted."""
        if self._program is None or (self._speaking is not None and self._speaking.poll() is None):
            return
        self._speaking = Popen([self._program, text], stdin=DEVNULL, stdout=DEVNULL, stderr=DEVNULL)


class Sound:
    """Rings and speaks when a manoeuvre is judged, or when the pilot's word changes.

    A replay that is faster than real time stays silent.
    """

    def __init__(self, ring: Callable[[], object], speak: Callable[[str], object]) -> None:
        self._ring, self._speak = ring, speak
        self.on = True
        self._last: tuple[bool, int, str, str] | None = None

    def hear(self, view: View) -> None:
        """Compare the present state with the last state, and ring and speak after a change."""
        now = view.elevator is None, len(view.state.maneuvers), advise(view).word, _hindered(view)
        last, self._last = self._last, now
        if last is None or last[0] != now[0] or last == now or not self.on or _hurries(view):
            return
        self._ring()
        self._speak(_spoken(view, more=now[1] > last[1]))


def _hindered(view: View) -> str:
    """Return why the last word may be old; empty if the word is new."""
    if view.health.condition == "lost":
        return "no link"
    return "behind" if view.health.behind else ""


def _hurries(view: View) -> bool:
    hurrying = view.playback is not None and view.playback.hurrying
    return hurrying or (view.tempo is not None and view.tempo.speed > 1.0)


def _spoken(view: View, *, more: bool) -> str:
    """Return the new verdict, if there is one, and the word: ``Manoeuvre 3 good. Continue.``"""
    behind = view.health.behind.replace(" s ", " seconds ").replace(" min ", " minutes ")
    lost = "no link" if view.health.condition == "lost" else ""
    word = f"{(lost or behind or advise(view).word).capitalize()}."
    if not more:
        return word
    newest = view.state.maneuvers[-1]
    _, verdict, _ = for_the_pilot(newest, view.state.flight_test.decision == "stop")
    heard = "rejected" if verdict == "REPEAT" else verdict.lower()
    return f"Manoeuvre {newest.maneuver.number} {heard}. {word}"
