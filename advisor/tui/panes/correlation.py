"""Correlation of the errors of the eight parameters."""

import numpy as np
from rich.style import Style
from rich.text import Text
from textual.app import ComposeResult
from textual.containers import VerticalScroll
from textual.widgets import Static

from advisor.aircraft.reference import PARAMETERS as NAMES
from advisor.oem.correlation import HIGH_CORRELATION, correlation_matrix
from advisor.oem.estimate import Estimate
from advisor.process.arrays import FloatArray
from advisor.session.conducting import View
from advisor.tui.panes.pane import Pane, Redrawn, TableRows
from advisor.words.quantities import PARAMETERS, signed

_LABEL = 5
_WIDE_CELL, _NARROW_CELL = 6, 5
"""Columns for ``−0.97`` and for ``−.97``, including the space before them."""
_STRONG = Style(reverse=True)


class Correlation(Redrawn, Pane):
    """Correlation matrix, with the joint estimate above the diagonal and the selected manoeuvre below the
    diagonal.
    """

    OF_ELEVATOR = True
    TITLE = "0 Correlation"
    SHORT = "0Cor"
    OF_SELECTED = True
    can_focus = False
    HELP = f"""\
# Correlation

The correlation between the errors of two parameters, from the covariance that allows for coloured
residuals. Above the diagonal stands the joint estimate over the accepted manoeuvres, below the diagonal
the selected manoeuvre alone. *-*: the parameter has no error that is known.

A pair above {HIGH_CORRELATION} is shown reversed and listed below: the input moved both alike, and one can
grow at the cost of the other. An input with other frequencies tells them apart.
"""

    _joint: Estimate | None = None
    _single: Estimate | None = None
    _number: int | None = None

    def compose(self) -> ComposeResult:
        """Lay out a text that scrolls."""
        with VerticalScroll():
            yield Static("No manoeuvre has ended yet.", id="matrix")

    def show(self, view: View) -> None:
        """Write the correlation matrix after an estimate has changed."""
        judged = view.judged
        if judged is None:
            return
        single = judged.estimate if isinstance(judged.estimate, Estimate) else None
        number = judged.maneuver.number
        if self._joint is view.state.model and self._single is single and self._number == number:
            return
        self._joint, self._single, self._number = view.state.model, single, number
        self.subtitle(f"manoeuvre {number}")
        self._redraw()

    def rows(self) -> TableRows | None:
        """Return one row for each pair of parameters and each estimate."""
        if self._number is None:
            return None
        rows: list[tuple[object, ...]] = []
        for of, estimate in (("joint", self._joint), (f"manoeuvre {self._number}", self._single)):
            if estimate is not None:
                r = correlation_matrix(estimate.covariance)
                rows += [
                    (of, NAMES[i], NAMES[j], float(r[i, j]))
                    for i in range(len(NAMES))
                    for j in range(i + 1, len(NAMES))
                ]
        return TableRows(("estimate", "parameter", "with", "correlation"), tuple(rows))

    def _redraw(self) -> None:
        """Write the correlations; a narrow pane shows them without the zero before the decimal point."""
        if self._number is None:
            return
        below = f"manoeuvre {self._number}{'' if self._single else ', which has no estimate'}"
        above = "joint estimate" if self._joint is not None else "no joint estimate yet"
        page = Text(f"above the diagonal: {above}; below: {below}\n")
        joint, single = (_matrix(estimate) for estimate in (self._joint, self._single))
        _append_matrix(page, np.triu(joint, 1) + np.tril(single, -1), self.size.width)
        for of, r in (("joint", joint), (f"manoeuvre {self._number}", single)):
            for i, j in zip(*np.nonzero(np.triu(np.abs(r), 1) > HIGH_CORRELATION), strict=True):
                symbols = " and ".join(PARAMETERS[NAMES[k]].symbol for k in (i, j))
                page.append(f"{of}: {symbols} {signed(float(r[i, j]), 3)}\n")
        page.rstrip()
        self.query_one("#matrix", Static).update(page)


def _matrix(estimate: Estimate | None) -> FloatArray:
    """Return the correlations, shape (8, 8); all NaN without an estimate."""
    return np.full((8, 8), np.nan) if estimate is None else correlation_matrix(estimate.covariance)


def _append_matrix(page: Text, r: FloatArray, width: int) -> None:
    cell = _WIDE_CELL if width >= _LABEL + len(NAMES) * _WIDE_CELL else _NARROW_CELL
    symbols = [PARAMETERS[name].symbol for name in NAMES]
    page.append(" " * _LABEL + "".join(symbol.rjust(cell) for symbol in symbols) + "\n")
    for i, symbol in enumerate(symbols):
        page.append(symbol.ljust(_LABEL))
        for j in range(len(NAMES)):
            text = "1" if i == j else _value(float(r[i, j]), cell)
            strong = i != j and abs(r[i, j]) > HIGH_CORRELATION
            page.append(" " * (cell - len(text)))
            page.append(text, _STRONG if strong else Style())
        page.append("\n")


def _value(r: float, cell: int) -> str:
    text = signed(r, 2)
    return text.replace("0.", ".") if cell == _NARROW_CELL else text
