"""Keys that work now, and the help for the focused pane with its page."""

import re
from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, ClassVar

from rich.style import Style
from rich.text import Text
from textual.app import App, ComposeResult, SystemCommand
from textual.binding import Binding, BindingType
from textual.containers import VerticalScroll
from textual.screen import ModalScreen, Screen
from textual.widgets import Static

from advisor.tui.keys import ACTIONS, ENGINEER


@dataclass(frozen=True, slots=True)
class KeyAtHand:
    """One key that works with the present focus."""

    shown: str
    does: str
    name: str
    """Name of the key's action in the settings."""
    run: Callable[[], Awaitable[Any]]


def keys_at_hand(app: App[None], screen: Screen[Any] | None = None) -> list[KeyAtHand]:
    """Return the keys of the table in `advisor.tui.keys` that are active on a screen. Without a screen,
    return those of the screen in front.
    """
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
    """Return every action of the advisor for the palette: the active ones, then the engineer's.

    The palette of the pilot's screen offers the engineer's actions too. Such an action first switches to the
    engineer's screen.
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


_BLOCKS = re.compile(r"\n\s*\n|\n(?=- )")
_MARKED = re.compile(r"\*\*(?P<bold>.+?)\*\*|\*(?P<italic>.+?)\*|`(?P<code>.+?)`")
_STYLES = {"bold": Style(bold=True), "italic": Style(italic=True), "code": Style(bold=True)}
_HEADING = Style(bold=True, underline=True)


def help_page(text: str) -> Text:
    """Return a help text in simple Markdown as one text that wraps to any width.

    Textual's own Markdown mounts a widget for every paragraph and cell, which takes 0.3 s for a page.
    """
    page = Text()
    for block in _BLOCKS.split(text.strip()):
        line = " ".join(block.split())
        if line.startswith("# "):
            page.append(f"{line[2:]}\n\n", _HEADING)
        elif line.startswith("- "):
            page.append("• ")
            _append_marked(page, f"{line[2:]}\n")
        else:
            _append_marked(page, f"{line}\n\n")
    return page


def _append_marked(page: Text, line: str) -> None:
    end = 0
    for mark in _MARKED.finditer(line):
        page.append(line[end : mark.start()])
        kind = str(mark.lastgroup)
        page.append(mark[kind], _STYLES[kind])
        end = mark.end()
    page.append(line[end:])


class Explain(ModalScreen[None]):
    """Shows a text. Page of help, which each of the keys escape, q and ? closes."""

    BINDINGS: ClassVar[list[BindingType]] = [Binding("escape,q,question_mark", "dismiss", "Close")]

    def __init__(self, page: Text) -> None:
        super().__init__()
        self._page = page

    def compose(self) -> ComposeResult:
        """Yield the text in a scrolling container."""
        with VerticalScroll(id="help"):
            yield Static(self._page)
