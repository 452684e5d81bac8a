"""One style sheet for each theme, parsed once.

Textual parses all styles anew whenever the theme changes, and again when the next kind of widget comes up.
"""

from collections.abc import Sequence

from textual.css.stylesheet import Stylesheet
from textual.theme import Theme


class Sheet(Stylesheet):
    """A style sheet that parses nothing twice as long as its variables stay the same."""

    def __init__(self, variables: dict[str, str]) -> None:
        super().__init__(variables=variables)
        self._parsed_with = variables

    def set_variables(self, variables: dict[str, str]) -> None:
        """Other variables need other rules; the same ones do not."""
        if variables != self._parsed_with:
            self._parsed_with = variables
            super().set_variables(variables)

    def reparse(self) -> None:
        """Parse what is new."""
        self.parse()


class Sheets:
    """The style sheets of all themes.

    Parameters
    ----------
    themes : sequence of Theme
        In the order in which they are prepared.
    """

    def __init__(self, themes: Sequence[Theme]) -> None:
        self._sheets = {theme.name: Sheet(_variables(theme)) for theme in themes}

    def of(self, theme: str, now: Stylesheet) -> Sheet:
        """A theme's sheet, with everything that the present one has read, in the same order."""
        sheet = self._sheets[theme]
        for place, source in now.source.items():
            sheet.add_source(source.content, place, source.is_defaults, source.tie_breaker, source.scope)
        return sheet

    def prepare(self, now: Stylesheet) -> bool:
        """Parse one sheet that lacks something; False: there is none."""
        lacking = (name for name, sheet in self._sheets.items() if sheet.source.keys() != now.source.keys())
        theme = next(lacking, None)
        if theme is not None:
            self.of(theme, now).parse()
        return theme is not None


def _variables(theme: Theme) -> dict[str, str]:
    """As `App.get_css_variables` has them for the theme in use."""
    return {**theme.to_color_system().generate(), **theme.variables}
