"""Curves of roll and yaw: measured, of the simulator, and with the findings."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from advisor.analysis.axis_flown import side_traces
from advisor.gap.axis import diagnosis
from advisor.gap.result import Trace
from tests.gap.axis.test_diagnosis import FOUND

T = np.arange(4.0)
MEASURED = np.array([0.0, 0.1, 0.2, 0.1, 0.0, -0.1, -0.2, -0.1])
"""Roll rate of two manoeuvres, rad/s."""


def flown(number, by=0.0):
    return SimpleNamespace(number=number, channels={"p": SimpleNamespace(t=T, y=by + np.zeros(4))})


TRACES = (
    Trace(3, "p", T, MEASURED[:4], MEASURED[:4] - 0.1, MEASURED[:4] - 0.01),
    Trace(5, "p", T, MEASURED[4:], MEASURED[4:] - 0.2, MEASURED[4:]),
)
ANSWERED = replace(FOUND, traces=TRACES)


def test_each_manoeuvre_has_the_measured_curve_and_those_of_simulator_and_findings():
    flights = [flown(3), flown(5)]
    first, second = side_traces(TRACES, flights, flights)
    assert (first.number, second.number, second.channel) == (3, 5, "p")
    assert first.measured == pytest.approx(MEASURED[:4])
    assert second.measured - second.before == pytest.approx(np.full(4, 0.2))
    assert first.measured - first.after == pytest.approx(np.full(4, 0.01))


def test_what_a_user_s_simulator_does_beyond_its_surrogate_is_part_of_all_three_curves():
    logged, less = [flown(3, by=1.0), flown(5)], [flown(3), flown(5)]
    first, second = side_traces(TRACES, logged, less)
    assert first.measured == pytest.approx(1.0 + MEASURED[:4])
    assert first.measured - first.before == pytest.approx(np.full(4, 0.1))
    assert second.measured == pytest.approx(MEASURED[4:])


def test_a_diagnosis_has_the_curves_of_both_fits_in_every_manoeuvre():
    (first, _) = diagnosis._traces((3, 5), fit([0.1, 0.2]), fit([0.01, 0.0]))
    assert (first.number, first.channel) == (3, "p")
    assert first.measured - first.before == pytest.approx(np.full(4, 0.1))
    assert first.measured - first.after == pytest.approx(np.full(4, 0.01))


def fit(error):
    """Return a fit that is short of the measured roll rate by an error."""
    rows = ({"p": slice(0, 4)}, {"p": slice(4, 8)})
    laid = SimpleNamespace(t=np.tile(T, 2), z=MEASURED, rows=rows)
    return SimpleNamespace(assembly=laid, fitted=MEASURED - np.repeat(error, 4))
