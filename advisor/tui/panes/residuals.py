"""Pane that tests whether the residuals of the selected manoeuvre are white noise."""

from dataclasses import dataclass

import numpy as np
from textual.app import ComposeResult

from advisor.oem.estimate import ChannelFit, Estimate
from advisor.process.arrays import FloatArray
from advisor.session.conducting import View
from advisor.tui.panes.fit import OUTPUTS, fits_of
from advisor.tui.panes.pane import Pane, TableRows
from advisor.tui.plot.chart import Chart, Level, Series
from advisor.tui.plot.painting import Plot
from advisor.words.quantities import NORMAL_95, channel

_LAGS_SHARE = 4
"""Length of the record divided by the longest lag of the autocorrelation: 4 (Box and Jenkins). At a longer
lag too few products are averaged.
"""


def autocorrelation(residual: FloatArray, lags: int) -> FloatArray:
    """Return the autocorrelation of a residual at whole numbers of samples.

    The estimate is biased: r_k = Σ v_i v_{i+k} / Σ v_i². Here v is the residual less its mean.
    Source: Box, Jenkins and Reinsel, *Time Series Analysis*, section 2.1. Samples are treated as evenly
    spaced.

    Parameters
    ----------
    residual
        Shape (n,), any unit; samples that are not finite are left out.
    lags
        The largest lag in samples, at least 0.

    Returns
    -------
    ndarray
        Shape (m + 1,), r_0 to r_m with m = min(lags, n - 1); r_0 is 1. All values are 0 for a constant
        residual.
    """
    finite = residual[np.isfinite(residual)]
    if len(finite) == 0:
        return np.zeros(1)
    v = finite - np.mean(finite)
    most = min(lags, len(v) - 1)
    power = float(v @ v)
    if power <= 0.0:
        return np.zeros(most + 1)
    return np.array([float(v[k:] @ v[: len(v) - k]) for k in range(most + 1)]) / power


def white_noise_bound(samples: int) -> float:
    """Return the half-width of the 95 % band of the autocorrelation of white noise: 1.96/√N.

    Parameters
    ----------
    samples
        Number N of samples, at least 1.
    """
    return float(NORMAL_95 / np.sqrt(samples))


@dataclass(frozen=True, slots=True)
class Whiteness:
    """The autocorrelation of one residual against that of white noise."""

    lag_s: FloatArray
    """Shape (m,), lags of the autocorrelation, s, rising; the first is one sample."""
    r: FloatArray
    """Shape (m,), autocorrelation at each lag."""
    bound: float
    """Half-width of the band that holds the autocorrelation of white noise at 95 % of the lags."""

    @classmethod
    def of(cls, fit: ChannelFit) -> "Whiteness":
        """Compute the autocorrelation of a fit's residual."""
        r = autocorrelation(fit.residual, len(fit.t) // _LAGS_SHARE)[1:]
        apart_s = float(np.median(np.diff(fit.t))) if len(fit.t) > 1 else 0.0
        return cls(np.arange(1.0, len(r) + 1.0) * apart_s, r, white_noise_bound(len(fit.t)))

    @property
    def outside(self) -> int:
        """Number of lags with an autocorrelation outside the bound. White noise has one such lag
        in twenty.
        """
        return int(np.count_nonzero(np.abs(self.r) > self.bound))


class Residuals(Pane):
    """Autocorrelation of each output's residual with the 95 % bounds of white noise."""

    OF_ELEVATOR = True
    TITLE = "9 Residuals"
    SHORT = "9Res"
    OF_SELECTED = True
    HELP = """\
# Residuals

The autocorrelation *r* of each output's residual in the selected manoeuvre, from one sample to a quarter
of the record. White noise stays between the dashed lines, ±1.96/√N for N samples, at 95 of 100 lags. The
first line of each plot counts the lags outside.

A slow decay means that something unknown drives the aircraft: moving air, or an effect that the model
lacks. A wave means a mode that the model misses. Intervals allow for coloured residuals already.
"""

    def compose(self) -> ComposeResult:
        """Lay out one plot for each output."""
        for name in OUTPUTS:
            yield Plot(_nothing(name, "no manoeuvre has ended yet."), id=f"white-{name}")

    def on_mount(self) -> None:
        """Begin with one plot that shows a sentence."""
        self._fits: dict[str, ChannelFit] = {}
        self._only_with_fit()

    def show(self, view: View) -> None:
        """Draw the selected manoeuvre after the selection has changed."""
        judged = view.judged
        if judged is None or not self.changed(judged):
            return
        self._fits = fits_of(judged)
        why = "" if isinstance(judged.estimate, Estimate) else judged.estimate.text
        for name in OUTPUTS:
            fit = self._fits.get(name)
            chart = _chart(name, Whiteness.of(fit)) if fit is not None else _nothing(name, why)
            self.query_one(f"#white-{name}", Plot).chart = chart
        self.subtitle(f"manoeuvre {judged.maneuver.number}  ╌╌ 95 % if white: ±1.96/√N")
        self._only_with_fit()

    def _only_with_fit(self) -> None:
        """Hide plots of channels without a fit. If no channel has a fit, show the reason in one plot."""
        shown = self._fits or OUTPUTS[:1]
        for name in OUTPUTS:
            self.query_one(f"#white-{name}").display = name in shown

    def rows(self) -> TableRows | None:
        if not self._fits:
            return None
        rows = []
        for name, fit in self._fits.items():
            white = Whiteness.of(fit)
            pairs = zip(white.lag_s.tolist(), white.r.tolist(), strict=True)
            rows += [(name, lag_s, r, white.bound) for lag_s, r in pairs]
        return TableRows(("output", "lag_s", "autocorrelation", "white_noise_bound_95_percent"), tuple(rows))


def _nothing(name: str, why: str) -> Chart:
    return Chart(f"r of {channel(name).symbol} [-]", "lag [s]", why_empty=why)


def _chart(name: str, white: Whiteness) -> Chart:
    counted = f"{white.outside} of {len(white.r)} outside"
    return Chart(
        f"r of {channel(name).symbol} [-]",
        "lag [s]",
        series=(Series(counted, white.lag_s, white.r, "residual", "stems"),),
        levels=(Level(f"±{white.bound:.2f}", white.bound), Level("", -white.bound)),
        x_range=(0.0, float(white.lag_s[-1])) if np.any(white.lag_s > 0.0) else None,
    )
