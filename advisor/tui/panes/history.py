"""How one parameter's estimate went from manoeuvre to manoeuvre."""

import numpy as np

from advisor.aircraft import PARAMETERS as NAMES
from advisor.oem.estimate import Estimate
from advisor.tui.plot.chart import Chart, Level, Series
from advisor.tui.view import View
from advisor.tui.words import PARAMETERS


def history_chart(view: View | None, name: str) -> Chart:
    """Each manoeuvre's value with a bar of ± 1.96 σ, the joint estimate and the prior as levels."""
    quantity, k = PARAMETERS[name], NAMES.index(name)
    points = [
        (judged.maneuver.number, judged.estimate)
        for judged in (view.state.maneuvers if view else ())
        if isinstance(judged.estimate, Estimate) and name not in judged.estimate.not_identifiable
    ]
    if view is None or not points:
        return Chart(quantity.label, "manoeuvre", why_empty="no manoeuvre has given an estimate of it yet.")
    numbers = np.array([number for number, _ in points], dtype=np.float64)
    value = np.array([e.theta[k] for _, e in points]) * quantity.factor
    half = 1.96 * np.array([e.std[k] for _, e in points]) * quantity.factor
    gap = np.full(len(numbers), np.nan)
    bars_x = np.column_stack([numbers, numbers, gap]).ravel()
    bars_y = np.column_stack([value - half, value + half, gap]).ravel()
    ticks_x = np.column_stack([numbers - 0.15, numbers + 0.15, gap]).ravel()
    ticks_y = np.column_stack([value, value, gap]).ravel()
    levels = []
    if view.state.model is not None and name not in view.state.model.not_identifiable:
        levels.append(Level("model", float(view.state.model.theta[k]) * quantity.factor, "fitted"))
    if name in view.aircraft.model:
        levels.append(Level("prior", view.aircraft.model[name] * quantity.factor, "prior"))
    return Chart(
        quantity.label,
        "manoeuvre",
        series=(
            Series("value ± 95 %", bars_x, bars_y, "measured"),
            Series("", ticks_x, ticks_y, "measured"),
        ),
        levels=tuple(levels),
        whole_x=True,
    )
