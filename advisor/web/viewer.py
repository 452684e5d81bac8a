"""The process of one page: the screens, painted for a browser.

python -m advisor.web.viewer

Keys and output go over the standard streams, as in Textual's web driver. The campaign runs in the server,
which is reached by a local socket.
"""

import os
import sys
import warnings
from collections.abc import Callable
from pathlib import Path, PurePath
from typing import Any, ClassVar

from textual.screen import Screen

from advisor.mavlink.link.keeping import Door
from advisor.process import interrupt
from advisor.tui import app as app_module
from advisor.tui.actions import LINK_ACTIONS
from advisor.tui.app import AdvisorApp
from advisor.tui.screens.engineer import EngineerScreen
from advisor.tui.screens.pilot import PilotScreen
from advisor.web.attached import AttachedConductor
from advisor.web.viewing import ADDRESS, KEY, Viewing

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
