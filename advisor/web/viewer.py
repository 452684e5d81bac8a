"""The process of one page: the screens, painted for a browser.

python -m advisor.web.viewer

Keys and output go over the standard streams, as in Textual's web driver. The campaign runs in the server,
which is reached by a local socket.
"""

import os
import sys
import warnings
from collections.abc import Callable
from multiprocessing.connection import Connection
from pathlib import Path, PurePath
from threading import Event
from typing import Any, ClassVar

from textual.screen import Screen

from advisor.mavlink.link.kept_link import Door
from advisor.process import interrupt
from advisor.process.liveness import OLD_AFTER_S
from advisor.session.conducting import Changes, Conducting, SessionReport, Tell
from advisor.tui import app as app_module
from advisor.tui.actions import LINK_ACTIONS
from advisor.tui.app import AdvisorApp
from advisor.tui.screens.engineer import EngineerScreen
from advisor.tui.screens.pilot import PilotScreen
from advisor.web.showing import ADDRESS, KEY, Viewing

LOOK_EVERY_S = 0.1
"""Time after which a thread without messages tests whether to stop, s."""


class ServerGoneError(Exception):
    """The server has ended, and with it the campaign that the page shows."""


class AttachedConductor(Conducting):
    """A `Conducting` whose campaign runs in the server.

    Parameters
    ----------
    connection
        Connection to the server, after its first message `Viewing`.
    """

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self._stopped = Event()

    def run(self, tell: Tell) -> None:
        """Receive reports until `stop`.

        Raises
        ------
        ServerGoneError
            The server has ended.
        Exception
            The error that ended the campaign.
        """
        last: SessionReport | None = None
        silent_s = 0.0
        while not self._stopped.is_set():
            news = self._hear()
            silent_s = silent_s + LOOK_EVERY_S if news is None else 0.0
            match news:
                case None if silent_s >= OLD_AFTER_S and last and last.health.condition != "ended":
                    tell(last.grown_old("SERVER", silent_s))
                case SessionReport() as first:
                    tell(last := first)
                case Changes() as changes if last is not None:
                    tell(last := changes.applied_to(last))
                case BaseException() as failure:
                    raise failure

    def stop(self) -> None:
        """End ``run`` at the next possible moment."""
        self._stopped.set()

    def _hear(self) -> object:
        """Return the next message of the server; None if none came in time."""
        try:
            return self._connection.recv() if self._connection.poll(LOOK_EVERY_S) else None
        except (OSError, EOFError) as error:
            raise ServerGoneError("The server of this page has ended.") from error

    def ask(self, name: str, *arguments: object) -> None:
        """Send a request to the server."""
        try:
            self._connection.send((name, arguments))
        except OSError:
            return  # the server has gone, which ``run`` tells


_BY_HAND = frozenset({*LINK_ACTIONS, "mark", "begin_maneuver", "end_maneuver", "exclude", "note"})


class WatchingEngineerScreen(EngineerScreen):
    """The engineer's screen without the keys that decide by hand."""

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Disable every decision by hand."""
        return action not in _BY_HAND and super().check_action(action, parameters)


class ViewerApp(AdvisorApp):
    """The application in a page. The user can leave the page at any time, and the advisor continues."""

    # Textual looks for them beside this module.
    CSS_PATH: ClassVar[list[str | PurePath]] = [
        Path(app_module.__file__).parent / path for path in AdvisorApp.CSS_PATH
    ]

    def __init__(self, viewing: Viewing, conductor: AttachedConductor) -> None:
        super().__init__(conductor, viewing.aircraft, viewing.title, viewing.tempo, viewing.settings)
        self._watch_only = viewing.watch_only

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Enable decisions by hand only if the page may decide."""
        return not (self._watch_only and action in _BY_HAND) and super().check_action(action, parameters)

    def action_leave(self) -> None:
        """Close the page at once."""
        self.exit()


class WatchingApp(ViewerApp):
    """The application in a page that cannot decide by hand."""

    MODES: ClassVar[dict[str, str | Callable[[], Screen[Any]]]] = {
        "pilot": PilotScreen,
        "engineer": WatchingEngineerScreen,
    }


def main() -> None:
    """Show the screens until the page is closed or the server has ended."""
    interrupt.ignore()  # a signal is for the server, which then ends this process in order
    warnings.simplefilter("ignore")  # as in the server: warnings are for those who develop
    door = Door(os.environ.pop(ADDRESS), bytes.fromhex(os.environ.pop(KEY)))
    connection = door.open()
    viewing: Viewing = connection.recv()
    kind = WatchingApp if viewing.watch_only else ViewerApp
    app = kind(viewing, AttachedConductor(connection))
    app.run()
    if app.failure is not None:
        sys.exit(str(app.failure))


if __name__ == "__main__":
    main()
