"""Which keys work now, and the help for what has the focus."""

from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

from rich.text import Text
from textual.app import App

from advisor.tui.help_page import help_page
from advisor.tui.keys import ACTIONS


@dataclass(frozen=True, slots=True)
class KeyAtHand:
    """One key that works where the focus is."""

    shown: str
    does: str
    name: str
    """As settings call the action."""
    run: Callable[[], Awaitable[Any]]


def keys_at_hand(app: App[None]) -> list[KeyAtHand]:
    """The keys of the table in `advisor.tui.keys` that are active."""
    return [
        KeyAtHand(
            app.get_key_display(active.binding),
            active.binding.description,
            active.binding.id or "",
            partial(app.run_action, active.binding.action, active.node),
        )
        for active in app.screen.active_bindings.values()
        if active.binding.id in ACTIONS and active.enabled
    ]


def explanation(app: App[None]) -> Text:
    """What the focused pane shows, what the screen is for, and the keys."""
    around = (app.focused or app.screen).ancestors_with_self
    page = help_page("\n\n".join([*(node.HELP for node in around if node.HELP), "# Keys"]))
    rows = [("key", "does", "name in settings"), *((k.shown, k.does, k.name) for k in keys_at_hand(app))]
    widths = [max(len(row[column]) for row in rows) + 2 for column in range(3)]
    for row in rows:
        page.append(
            "".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() + "\n"
        )
    return page
