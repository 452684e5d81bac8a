"""Colour themes: for a dark room, for a cockpit in the sun, high contrast, and safe for the colour-blind."""

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


def _variables(
    measured: str, fitted: str, residual: str, elevator: str, limit: str, prior: str
) -> dict[str, str]:
    names = ("measured", "fitted", "residual", "input", "limit", "prior")
    inks = zip(names, (measured, fitted, residual, elevator, limit, prior), strict=True)
    return _IN_EVERY_THEME | {f"ink-{name}": colour for name, colour in inks}


THEMES = (
    Theme(
        name="dark",
        primary="#5aa9e6",
        secondary="#3c6e91",
        accent="#f2c14e",
        success="#57cc99",
        warning="#f2a65a",
        error="#ef6461",
        foreground="#e6e6e6",
        background="#10151b",
        surface="#161d25",
        panel="#1f2933",
        variables=_variables("#7fb8e6", "#f2c14e", "#c79bf2", "#57cc99", "#ef6461", "#b0b8c0"),
    ),
    Theme(
        name="light",
        primary="#004a8f",
        secondary="#5b7c99",
        accent="#8a4b00",
        success="#006b3c",
        warning="#8a4b00",
        error="#b00020",
        foreground="#000000",
        background="#ffffff",
        surface="#ffffff",
        panel="#e4e8ec",
        dark=False,
        text_alpha=1.0,
        variables=_variables("#0057b8", "#b34700", "#6a1b9a", "#00695c", "#b00020", "#444444"),
    ),
    Theme(
        name="high contrast",
        primary="#ffffff",
        secondary="#ffffff",
        accent="#ffff00",
        success="#00ff00",
        warning="#ffff00",
        error="#ff5555",
        foreground="#ffffff",
        background="#000000",
        surface="#000000",
        panel="#000000",
        text_alpha=1.0,
        variables=_variables("#00ffff", "#ffff00", "#ff88ff", "#00ff00", "#ff5555", "#ffffff"),
    ),
    # Okabe and Ito's palette, distinguishable with any of the common colour vision deficiencies.
    Theme(
        name="colour-blind safe",
        primary="#56b4e9",
        secondary="#0072b2",
        accent="#f0e442",
        success="#56b4e9",
        warning="#e69f00",
        error="#d55e00",
        foreground="#f2f2f2",
        background="#101010",
        surface="#181818",
        panel="#262626",
        variables=_variables("#56b4e9", "#e69f00", "#cc79a7", "#009e73", "#d55e00", "#f2f2f2"),
    ),
)

NAMES = tuple(theme.name for theme in THEMES)
