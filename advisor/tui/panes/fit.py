"""Measured, fitted and residual, for every output of the selected manoeuvre."""

from textual.app import ComposeResult
from textual.events import Resize

from advisor.oem.estimate import ChannelFit, Estimate
from advisor.tui.panes.pane import Pane
from advisor.tui.plot.chart import Chart, Series
from advisor.tui.plot.widget import Plot
from advisor.tui.view import View
from advisor.tui.words import channel

OUTPUTS = ("alpha", "q", "a_z", "theta")
_ROWS_FOR_ONE = 14


class Fit(Pane):
    """Two plots an output: measured with fitted, and what is left between them."""

    TITLE = "4 Fit"
    HELP = """\
# Fit

For each output of the selected manoeuvre: what was measured (dots) and what the model says (line), below
it the residual (measured minus fitted). **o** brings the next output to the top when not all have room.
A residual without pattern is noise; one with a pattern is something the model does not know.
"""

    def compose(self) -> ComposeResult:
        """All plots; those without room are hidden."""
        for name in OUTPUTS:
            yield Plot(_no_fit(name, "no manoeuvre has ended yet."), id=f"fit-{name}", classes="fit")
            yield Plot(_no_fit(name, ""), id=f"residual-{name}", classes="residual")

    def on_mount(self) -> None:
        """Begin with the angle of attack."""
        super().on_mount()
        self._first = 0
        self._shown: object = None

    def show(self, view: View) -> None:
        """Draw the selected manoeuvre when it is another one."""
        judged = view.judged
        if judged is self._shown:
            return
        self._shown = judged
        fits = judged.estimate.fits[0] if judged and isinstance(judged.estimate, Estimate) else {}
        why = judged.estimate.text if judged and not isinstance(judged.estimate, Estimate) else ""
        start_s = judged.maneuver.span.start_s if judged else 0.0
        for name in OUTPUTS:
            fit = fits.get(name)
            missing = _no_fit(name, why or "not an output of this fit: the log has no such channel.")
            self.query_one(f"#fit-{name}", Plot).chart = _fit_chart(fit, start_s) if fit else missing
            self.query_one(f"#residual-{name}", Plot).chart = (
                _residual_chart(fit, start_s) if fit else missing
            )
        if judged:
            self.subtitle(f"manoeuvre {judged.maneuver.number}")
        self._make_room()

    def next_output(self) -> None:
        """Bring the next output to the top."""
        self._first = (self._first + 1) % len(OUTPUTS)
        self._make_room()

    def on_resize(self, event: Resize) -> None:
        """Show as many outputs as have room."""
        self._make_room()

    def _make_room(self) -> None:
        count = max(1, self.size.height // _ROWS_FOR_ONE)
        shown = {OUTPUTS[(self._first + k) % len(OUTPUTS)] for k in range(min(count, len(OUTPUTS)))}
        for name in OUTPUTS:
            fit, residual = self.query_one(f"#fit-{name}", Plot), self.query_one(f"#residual-{name}", Plot)
            fit.display = name in shown
            residual.display = name in shown and bool(residual.chart.series)
        self.border_title = self.TITLE if len(shown) == len(OUTPUTS) else f"{self.TITLE}  (o: next output)"


def _no_fit(name: str, why: str) -> Chart:
    return Chart(channel(name).label, "t [s]", why_empty=why)


def _fit_chart(fit: ChannelFit, start_s: float) -> Chart:
    quantity, t = channel(fit.name), fit.t - start_s
    return Chart(
        quantity.label,
        "t [s]",
        series=(
            Series("measured", t, fit.measured * quantity.factor, "measured", "points"),
            Series("fitted", t, fit.fitted * quantity.factor, "fitted"),
        ),
    )


def _residual_chart(fit: ChannelFit, start_s: float) -> Chart:
    quantity = channel(fit.name)
    residual = Series("residual", fit.t - start_s, fit.residual * quantity.factor, "residual")
    return Chart(quantity.label, "t [s]", series=(residual,))
