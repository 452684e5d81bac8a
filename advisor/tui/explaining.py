"""Keys that work now, and the help for the focused pane."""

from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

from rich.text import Text
from textual.app import App, SystemCommand
from textual.binding import Binding
from textual.screen import Screen

from advisor.tui.help_page import help_page
from advisor.tui.keys import ACTIONS, ENGINEER


@dataclass(frozen=True, slots=True)
class KeyAtHand:
    """One key that works at the present focus."""

    shown: str
    does: str
    name: str
    """Name of the action in the settings."""
    run: Callable[[], Awaitable[Any]]


def keys_at_hand(app: App[None], screen: Screen[Any] | None = None) -> list[KeyAtHand]:
    """Return the keys of the table in `advisor.tui.keys` that are active on a screen. None: on the newest
    screen."""
    return [
        KeyAtHand(
            app.get_key_display(active.binding),
            active.binding.description,
            active.binding.id or "",
            partial(app.run_action, active.binding.action, active.node),
        )
        for active in (screen or app.screen).active_bindings.values()
        if active.binding.id in ACTIONS and active.enabled
    ]


def commands(app: App[None], screen: Screen[Any]) -> list[SystemCommand]:
    """Return every action of the advisor for the palette: the active ones, then those of the engineer's
    screen.

    An action of the engineer's screen that is chosen elsewhere first shows that screen.
    """
    at_hand = keys_at_hand(app, screen)
    names = {key.name for key in at_hand}
    elsewhere = [b for b in ENGINEER if isinstance(b, Binding) and b.id not in names]
    return [
        *(SystemCommand(key.does, f"key: {key.shown}", key.run) for key in at_hand),
        *(
            SystemCommand(
                binding.description,
                f"engineer's screen, key: {app.get_key_display(binding)}",
                partial(_on_engineers_screen, app, binding.action),
            )
            for binding in elsewhere
        ),
    ]


async def _on_engineers_screen(app: App[None], action: str) -> None:
    await app.run_action("face('engineer')")
    await app.run_action(action, app.screen)


def explanation(app: App[None]) -> Text:
    """Return the help on the focused pane, the screen and the keys."""
    around = (app.focused or app.screen).ancestors_with_self
    page = help_page("\n\n".join([*(node.HELP for node in around if node.HELP), "# Keys"]))
    rows = [("key", "does", "name in settings"), *((k.shown, k.does, k.name) for k in keys_at_hand(app))]
    widths = [max(len(row[column]) for row in rows) + 2 for column in range(3)]
    for row in rows:
        page.append(
            "".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() + "\n"
        )
    return page
