"""Change of the outputs of a fit when parameters of servos or clocks change, at fixed derivatives.

A surface with another servo is a disturbance of its control, whose linear response is known. A late reading
is the fitted output at an earlier time.
"""

from collections.abc import Sequence

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.gap.axes.lateral.disturbance import STEP_S, answered
from advisor.gap.axes.lateral.fit import Fit
from advisor.gap.axes.lateral.setting import COMMAND, Flown, Setting, deflection
from advisor.model.axes.lateral import LATERAL


def changes_by(fit: Fit, flown: Flown, of: str, settings: Sequence[Setting]) -> FloatArray:
    """Return the change (settings, N) of the outputs by other servo parameters or by late stamps."""
    if of in LATERAL.inputs:
        parts = [_by_surface(fit, flown, m, of, settings) for m in range(len(flown))]
        return np.vstack(parts).T
    return np.array([_read_later(fit, of, setting) for setting in settings]).reshape(-1, len(fit.fitted))


def _by_surface(fit: Fit, flown: Flown, m: int, control: str, settings: Sequence[Setting]) -> FloatArray:
    """Return the change (n, settings) of one manoeuvre's outputs by other deflections of a control."""
    stamps = fit.assembly.t[fit.assembly.owner == m]
    t = np.arange(np.min(stamps), np.max(stamps) + STEP_S, STEP_S)
    moves = np.zeros((len(t), len(settings)))
    if control in flown.problem.records[m].inputs:
        now = fit.point.setting
        late = t - now[COMMAND][m]
        moves += np.column_stack([deflection(flown, m, control, one).at(late) for one in settings])
        moves -= deflection(flown, m, control, now).at(late)[:, None]
    return answered(fit, flown, m, control, t, moves)


def _read_later(fit: Fit, of: str, setting: Setting) -> FloatArray:
    """Return the change (N,) of the outputs when one output is read late."""
    late, now = (numbers.get((of, "skew_s"), np.zeros(1))[0] for numbers in (setting, fit.point.setting))
    change = np.zeros(len(fit.fitted))
    for rows in (named[of] for named in fit.assembly.rows):
        t, y = fit.assembly.t[rows], fit.fitted[rows]
        change[rows] = np.interp(t - late + now, t, y) - y
    return change
