"""Colour themes: for a dark room, for a cockpit in the sun, high contrast, and safe for the colour-blind."""

from typing import Any

from textual.theme import Theme

_SCROLLBAR, _SCROLLBAR_BACKGROUND = "#808080", "#80808033"
_IN_EVERY_THEME = {
    "scrollbar": _SCROLLBAR,
    "scrollbar-hover": _SCROLLBAR,
    "scrollbar-active": _SCROLLBAR,
    "scrollbar-background": _SCROLLBAR_BACKGROUND,
    "scrollbar-background-hover": _SCROLLBAR_BACKGROUND,
    "scrollbar-background-active": _SCROLLBAR_BACKGROUND,
    "scrollbar-corner-color": _SCROLLBAR_BACKGROUND,
    "link-background-hover": _SCROLLBAR,
}
"""Scroll bar colours of every theme: grey stands out from light and from dark. Textual gives these colours to
every widget, with or without a scroll bar. A colour that changes with the theme refreshes the whole content
of each widget, which would take most of the time of a change."""


_ROLES = [
    "primary",
    "secondary",
    "accent",
    "success",
    "warning",
    "error",
    "foreground",
    "background",
    "surface",
    "panel",
]
_INKS = ["measured", "fitted", "residual", "input", "limit", "prior"]


def _theme(name: str, roles: str, inks: str, *, dark: bool = True, text_alpha: float = 0.95) -> Theme:
    """Return a theme from colours in the order of ``_ROLES`` and of ``_INKS``."""
    variables = {f"ink-{ink}": colour for ink, colour in zip(_INKS, inks.split(), strict=True)}
    colours: dict[str, Any] = dict(zip(_ROLES, roles.split(), strict=True))
    return Theme(name, dark=dark, text_alpha=text_alpha, variables=_IN_EVERY_THEME | variables, **colours)


THEMES = (
    _theme(
        "dark",
        "#5aa9e6 #3c6e91 #f2c14e #57cc99 #f2a65a #ef6461 #e6e6e6 #10151b #161d25 #1f2933",
        "#7fb8e6 #f2c14e #c79bf2 #57cc99 #ef6461 #b0b8c0",
    ),
    _theme(
        "light",
        "#004a8f #5b7c99 #8a4b00 #006b3c #8a4b00 #b00020 #000000 #ffffff #ffffff #e4e8ec",
        "#0057b8 #b34700 #6a1b9a #00695c #b00020 #444444",
        dark=False,
        text_alpha=1.0,
    ),
    _theme(
        "high contrast",
        "#ffffff #ffffff #ffff00 #00ff00 #ffff00 #ff5555 #ffffff #000000 #000000 #000000",
        "#00ffff #ffff00 #ff88ff #00ff00 #ff5555 #ffffff",
        text_alpha=1.0,
    ),
    # Okabe and Ito's palette, distinguishable with any of the common colour vision deficiencies.
    _theme(
        "colour-blind safe",
        "#56b4e9 #0072b2 #f0e442 #56b4e9 #e69f00 #d55e00 #f2f2f2 #101010 #181818 #262626",
        "#56b4e9 #e69f00 #cc79a7 #009e73 #d55e00 #f2f2f2",
    ),
)

NAMES = tuple(theme.name for theme in THEMES)
