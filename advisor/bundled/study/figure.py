"""Figure 5: the stop criterion against the number of manoeuvres, with the 25 % line."""

from collections.abc import Sequence
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path

import numpy as np

from advisor.aircraft.aircraft import Rule
from advisor.bundled.study.campaigns import ORDER, RuleOutcome
from advisor.process.atomic_file import write_atomically
from advisor.words.problems import ConfigurationError

LIMIT_PERCENT = 25.0
TICKS_PERCENT = (2, 5, 10, 25, 50, 100, 200)


@dataclass(frozen=True, slots=True)
class Curve:
    """Criterion of one stopping rule at one noise level over all campaigns."""

    rule: Rule
    noise_percent: float
    quantiles: tuple[tuple[float, float, float] | None, ...]
    """Quantiles 10 %, 50 %, 90 % over the campaigns with a value, for each manoeuvre. None if no campaign has
    a value."""


def curve(rule: Rule, noise_percent: float, outcomes: Sequence[RuleOutcome]) -> Curve:
    """Return the criterion's history, as if every campaign continued to its end."""
    quantiles: list[tuple[float, float, float] | None] = []
    for i in range(len(ORDER)):
        values = [
            v for o in outcomes if i < len(o.history_percent) and (v := o.history_percent[i]) is not None
        ]
        low, middle, high = np.quantile(values, [0.1, 0.5, 0.9]) if values else (0.0, 0.0, 0.0)
        quantiles.append((float(low), float(middle), float(high)) if values else None)
    return Curve(rule, noise_percent, tuple(quantiles))


def refuse_undrawable(path: Path) -> None:
    """Refuse a figure that could not be drawn later, before any campaign is flown.

    Raises
    ------
    ConfigurationError
        matplotlib is not installed, or does not support the file ending.
    """
    try:
        from matplotlib.backend_bases import FigureCanvasBase
    except ImportError as error:
        raise ConfigurationError(
            "--figure needs matplotlib: pip install 'inflight-advisor[report]'."
        ) from error
    endings = FigureCanvasBase.get_supported_filetypes()
    if path.suffix and path.suffix[1:].lower() not in endings:
        raise ConfigurationError(f"--figure: no picture ends in {path.suffix}; name a .png or .svg file.")


def draw(curves: Sequence[Curve], path: Path) -> None:
    """Write the figure whole or not at all; the ending of ``path`` (.png, .svg) says how.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib.ticker import FixedLocator, FormatStrFormatter, NullLocator

    rules: list[Rule] = ["continuous", "separate"]
    figure = Figure(figsize=(9.0, 4.0), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(1, len(rules), sharey=True)
    for axis, rule in zip(axes, rules, strict=True):
        for marker, curve in zip("osD", (c for c in curves if c.rule == rule), strict=False):
            bands = [(i + 1, q) for i, q in enumerate(curve.quantiles) if q is not None]
            number = [i for i, _ in bands]
            (line,) = axis.plot(
                number, [q[1] for _, q in bands], marker=marker, label=f"noise {curve.noise_percent:g} %"
            )
            axis.fill_between(
                number, [q[0] for _, q in bands], [q[2] for _, q in bands], color=line.get_color(), alpha=0.15
            )
        axis.axhline(LIMIT_PERCENT, color="black", linestyle="--", linewidth=1.0, label="limit 25 %")
        axis.set(title=rule, xlabel="manoeuvres flown", yscale="log", xlim=(2.7, len(ORDER) + 0.3))
        axis.yaxis.set_major_locator(FixedLocator(TICKS_PERCENT))
        axis.yaxis.set_major_formatter(FormatStrFormatter("%g"))
        axis.yaxis.set_minor_locator(NullLocator())
        axis.grid(visible=True, alpha=0.2)
    axes[0].set_ylabel("criterion, Eq. (12), in %")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper center", ncols=4, fontsize=8)
    # Without a date the same study gives the same file.
    drawn, form = BytesIO(), path.suffix[1:].lower() or "png"
    figure.savefig(drawn, format=form, dpi=150, metadata={"Date": None} if form == "svg" else None)
    write_atomically(path, drawn.getvalue())


def in_terminal(curves: Sequence[Curve], rule: Rule, height: int = 13) -> list[str]:
    """Return the medians of one rule as lines of text, with a logarithmic axis of the criterion."""
    chosen = [c for c in curves if c.rule == rule]
    values = [q[1] for c in chosen for q in c.quantiles if q is not None]
    if not values:
        return [f"{rule}: no campaign has three accepted manoeuvres"]
    low, high = np.log(min(*values, LIMIT_PERCENT) * 0.8), np.log(max(*values, LIMIT_PERCENT) * 1.25)

    def line_of(percent: float) -> int:
        return round(float((high - np.log(percent)) / (high - low)) * (height - 1))

    width = 6
    grid = [[" "] * (width * len(ORDER) + 1) for _ in range(height)]
    grid[line_of(LIMIT_PERCENT)] = list("-" * (width * len(ORDER) + 1))
    for curve in chosen:
        symbol = f"{curve.noise_percent:g}"
        for i, q in enumerate(curve.quantiles):
            if q is not None:
                at = width * i + 2
                grid[line_of(q[1])][at : at + len(symbol)] = list(symbol)
    labels = {line_of(v): f"{v:6.3g}" for v in (np.exp(low) / 0.8, LIMIT_PERCENT, np.exp(high) / 1.25)}
    rows = [f"{labels.get(i, ''):>6} |{''.join(cells).rstrip()}" for i, cells in enumerate(grid)]
    numbers = "".join(f"{i:^{width}}" for i in range(1, len(ORDER) + 1))
    return [
        f"{rule}: criterion of Eq. (12) in %, median after each manoeuvre;",
        "  each mark is a noise level in %, --- the limit",
        *rows,
        f"{'':>6} +{'-' * (width * len(ORDER))}",
        f"{'':>8}{numbers}".rstrip() + "  manoeuvres flown",
    ]
