"""One style sheet for each theme, parsed once.

Textual parses all styles again whenever the theme changes, and when a new kind of widget appears.
"""

from collections.abc import Sequence

from textual.css.stylesheet import Stylesheet
from textual.theme import Theme


class Sheet(Stylesheet):
    """Style sheet that parses each rule once while its variables are unchanged."""

    def __init__(self, variables: dict[str, str]) -> None:
        super().__init__(variables=variables)
        self._parsed_with = variables

    def set_variables(self, variables: dict[str, str]) -> None:
        """Set the variables of the style sheet. Only changed variables need new rules."""
        if variables != self._parsed_with:
            self._parsed_with = variables
            super().set_variables(variables)

    def reparse(self) -> None:
        """Parse the new parts of the style sheet."""
        self.parse()


class Sheets:
    """The style sheets of all themes."""

    def __init__(self, themes: Sequence[Theme]) -> None:
        self._sheets = {
            theme.name: Sheet({**theme.to_color_system().generate(), **theme.variables}) for theme in themes
        }

    def of(self, theme: str, now: Stylesheet) -> Sheet:
        """Return the sheet of a theme with all sources that the present sheet has read, in equal order."""
        sheet = self._sheets[theme]
        for place, source in now.source.items():
            sheet.add_source(source.content, place, source.is_defaults, source.tie_breaker, source.scope)
        return sheet

    def prepare(self, now: Stylesheet) -> bool:
        """Parse one incomplete sheet; return False if all sheets are complete."""
        lacking = (name for name, sheet in self._sheets.items() if sheet.source.keys() != now.source.keys())
        theme = next(lacking, None)
        if theme is not None:
            self.of(theme, now).parse()
        return theme is not None
