"""Which keys work now, and the help for what has the focus."""

from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

from textual.app import App

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


def explanation(app: App[None]) -> str:
    """Markdown: what the focused pane shows, what the screen is for, and the keys."""
    around = (app.focused or app.screen).ancestors_with_self
    pages = [node.HELP for node in around if node.HELP]
    rows = "\n".join(f"| `{key.shown}` | {key.does} | {key.name} |" for key in keys_at_hand(app))
    return "\n".join([*pages, "# Keys", "", "| key | does | name in settings |", "|---|---|---|", rows, ""])
