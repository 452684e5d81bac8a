"""The diagnosis on a terminal: verdict, block picture, waterfall, ranking, residuals before and after."""

from collections.abc import Sequence

import numpy as np
from rich.console import Console, ConsoleOptions, Group, RenderResult
from rich.panel import Panel
from rich.table import Table
from rich.text import Text

from advisor.flight.messages import FloatArray
from advisor.gap.result import Cause, Diagnosis
from advisor.gap.text import what

_UNITS = {
    "alpha": ("deg", 57.29578),
    "q": ("deg/s", 57.29578),
    "a_z": ("m/s²", 1.0),
    "theta": ("deg", 57.29578),
}
_NAMES = {"alpha": "α", "q": "q", "a_z": "a_z", "theta": "θ"}
_VERDICTS = {
    "none": "NO GAP",
    "parameters": "WRONG NUMBERS",
    "effect": "CAUSE FOUND",
    "unknown": "UNKNOWN CAUSE",
}
_PICTURE = (
    (
        ("input", "command → surface"),
        ("moment_equation", "pitching moment"),
        ("pitch_rate_sensor", "pitch rate"),
    ),
    (("air", "air"), ("force_equation", "lift"), ("alpha_sensor", "angle of attack")),
    (("timing", "time stamps"), ("accelerometer", "accelerometer"), ("attitude_sensor", "attitude")),
)
_TICKS = "▁▂▃▄▅▆▇█"


class GapScreen:
    """Everything an engineer wants of a diagnosis, readable without colour."""

    def __init__(self, diagnosis: Diagnosis, improved: str | None = None) -> None:
        self.diagnosis, self.improved = diagnosis, improved

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """Yield the parts from the verdict to the notes."""
        d = self.diagnosis
        yield Panel(Text(d.sentence), title=_VERDICTS[d.verdict], title_align="left")
        yield _numbers(d)
        yield Panel(_picture(d), title="where", title_align="left")
        if d.waterfall:
            yield Panel(_waterfall(d), title="gap after adding, one after another", title_align="left")
        if d.causes:
            yield _ranking(d.causes)
        yield Panel(_residuals(d, options.max_width - 30), title="error before and after", title_align="left")
        yield _fidelity(d)
        for note in (
            d.kinematics.sentence,
            d.gap.floor_note and f"Noise floor {d.gap.floor_note}.",
            *d.notes,
        ):
            yield Text(f"· {note}")
        if d.cannot_see:
            seen = "; ".join(
                f"{u.effect.replace('_', ' ')} ({u.because}: {u.would_need})" for u in d.cannot_see
            )
            yield Text(f"· This flight could not show: {seen}.")
        if self.improved is not None:
            yield Text(
                f"· The improved simulator is {self.improved}; python -m sim flies it with --aircraft."
            )


def _numbers(d: Diagnosis) -> Text:
    parts = [f"gap {d.gap.before:.3g} → {d.gap.after:.3g} times the noise floor's power"]
    if d.shrink is not None:
        low, high = d.shrink.ci95_percent
        held = ", ".join(map(str, d.shrink.holdout))
        parts.append(
            f"{d.shrink.percent:.1f} % less [{low:.0f}, {high:.0f}] on manoeuvres {held}, kept out of the fit"
        )
    return Text("; ".join(parts))


def _picture(d: Diagnosis) -> Table:
    """The simulator as blocks; the guilty one between arrows."""
    table = Table.grid(expand=True, padding=(0, 1))
    guilty = d.where.block if d.verdict in ("effect", "unknown") else ""
    scores = dict(d.where.ranking)
    for row in _PICTURE:
        cells = []
        for block, label in row:
            score = scores.get(block)
            share = f" {100 * score:.0f} %" if score is not None else ""
            cells.append(
                Text(f"▶ {label.upper()}{share} ◀", style="bold reverse") if block == guilty
                else Text(f"[{label}]{share}", style="dim" if score is None else "")
            )  # fmt: skip
        table.add_row(*cells)
    return table


def _waterfall(d: Diagnosis) -> Text:
    text = Text()
    largest = max([d.gap.before, *(after for _, after in d.waterfall)], default=1.0) or 1.0
    for name, value in (("as it is", d.gap.before), *d.waterfall):
        bar = "█" * max(round(40 * float(np.log1p(value) / np.log1p(largest))), 0)
        text.append(f"{name.replace('_', ' '):26s}{value:10.3g} {bar}\n")
    text.rstrip()
    return text


def _ranking(causes: Sequence[Cause]) -> Table:
    table = Table(title="causes", title_justify="left", expand=True)
    for column in ("cause", "probability", "size", "gap after", "not told from"):
        table.add_column(column, justify="right" if column in ("probability", "gap after") else "left")
    for c in causes:
        sizes = ", ".join(f"{k} {v.value:.4g} ± {v.std:.1g}" for k, v in c.parameters.items())
        ties = ", ".join(t.replace("_", " ") for t in c.cannot_be_told_from)
        if ties and c.tell_apart_by:
            ties += f" — {c.tell_apart_by}"
        mark = "● " if c.present else "  "
        table.add_row(f"{mark}{what(c)}", f"{100 * c.probability:.0f} %", sizes, f"{c.gap_after:.3g}", ties)
    return table


def _residuals(d: Diagnosis, width: int) -> Group:
    """RMS error along the worst manoeuvre, before and after, on one scale per channel."""
    if not d.traces:
        return Group(Text("no traces"))
    worst = max(d.gap.by_maneuver, key=lambda row: row[1])[0]
    lines = []
    for trace in (t for t in d.traces if t.number == worst):
        unit, factor = _UNITS[trace.channel]
        before, after = factor * (trace.measured - trace.before), factor * (trace.measured - trace.after)
        top = max(float(np.max(np.abs(before))), float(np.max(np.abs(after))), 1e-12)
        lines.append(
            Text(f"{_NAMES[trace.channel]:>4s} before {_bars(before, top, width)}  peak {top:.2g} {unit}")
        )
        lines.append(Text(f"     after  {_bars(after, top, width)}  manoeuvre {worst}"))
    return Group(*lines)


def _bars(error: FloatArray, top: float, width: int) -> str:
    parts = np.array_split(np.abs(error), max(min(width, len(error)), 1))
    return "".join(_TICKS[min(int(8 * float(np.max(p)) / top), 7)] for p in parts)


def _fidelity(d: Diagnosis) -> Table:
    table = Table(title="fidelity on manoeuvres kept out, before → after", title_justify="left", expand=True)
    for column in (
        "channel",
        "gap",
        "Theil (< 0.25)",
        "bias/variance/covariance",
        "R²",
        "inside ±1.5°, ±2°/s, ±0.1 g",
    ):
        table.add_column(column)
    for channel, (before, after) in d.yardsticks.items():
        inside = "" if after.within_tolerance is None or before.within_tolerance is None else (
            f"{100 * before.within_tolerance:.0f} → {100 * after.within_tolerance:.0f} %"
        )  # fmt: skip
        table.add_row(
            _NAMES[channel], f"{d.gap.by_channel[channel]:.3g} → {d.gap.by_channel_after[channel]:.3g}",
            f"{before.theil:.3f} → {after.theil:.3f}",
            f"{after.bias:.2f}/{after.variance:.2f}/{after.covariance:.2f}",
            f"{before.r2:.4f} → {after.r2:.4f}", inside,
        )  # fmt: skip
    return table
