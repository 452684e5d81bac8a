"""The course of one parameter's estimate from manoeuvre to manoeuvre."""

from dataclasses import dataclass

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.report.result_rows import parameter_row
from advisor.session.view import View
from advisor.tui.plot.chart import Chart, Level, Series
from advisor.words.quantities import PARAMETERS

_MARGIN = 0.5
"""Manoeuvres to the left of the first and to the right of the last: no bar stands on the edge of a plot."""


@dataclass(frozen=True, slots=True)
class ParameterCourse:
    """One parameter over the manoeuvres, and the values to hold against it, in the unit for people."""

    parameter: str
    numbers: FloatArray
    """Shape (n,), numbers of the manoeuvres that tell the parameter."""
    value: FloatArray
    """Shape (n,)."""
    half: FloatArray
    """Shape (n,), half of each 95 % interval: 1.96 σ, corrected for coloured residuals."""
    model: float | None
    """The joint estimate; None while there is none, or where it does not tell the parameter."""
    prior: float | None
    """The aircraft file's value; None where it has none."""


def course(view: View | None, name: str) -> ParameterCourse:
    """Collect one parameter's estimates, manoeuvre by manoeuvre."""
    known = view.aircraft.model if view else {}
    rows = [
        (judged.maneuver.number, parameter_row(name, judged.estimate, known))
        for judged in (view.state.maneuvers if view else ())
    ]
    points = [(number, row) for number, row in rows if row.is_known]
    joint = parameter_row(name, view.state.model if view else None, known)
    return ParameterCourse(
        name,
        np.array([number for number, _ in points], dtype=np.float64),
        np.array([row.value for _, row in points], dtype=np.float64),
        np.array([row.half for _, row in points], dtype=np.float64),
        joint.value if joint.is_known else None,
        joint.prior,
    )


def history_chart(view: View | None, name: str) -> Chart:
    """Draw each manoeuvre's value with its 95 % interval, and the joint estimate and the prior as levels."""
    quantity, of = PARAMETERS[name], course(view, name)
    if len(of.numbers) == 0:
        return Chart(quantity.label, "manoeuvre", why_empty="no manoeuvre has given an estimate of it yet.")
    levels = []
    if of.model is not None:
        levels.append(Level("joint", of.model, "fitted", dashed=False))
    if of.prior is not None:
        levels.append(Level("simulator", of.prior, "prior"))
    values = Series("value ± 95 %", of.numbers, of.value, "measured", "intervals", of.half)
    return Chart(
        quantity.label,
        "manoeuvre",
        series=(values,),
        levels=tuple(levels),
        whole_x=True,
        x_range=(float(of.numbers[0]) - _MARGIN, float(of.numbers[-1]) + _MARGIN),
    )
