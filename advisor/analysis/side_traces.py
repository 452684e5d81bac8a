"""Roll and yaw as curves: measured, of the simulator as given, and of the model with the findings."""

from collections.abc import Sequence

import numpy as np

from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.gap.axes.lateral.comparison import SideGap
from advisor.gap.result import Trace


def side_traces(found: SideGap, flown: Sequence[Maneuver], compared: Sequence[Maneuver]) -> tuple[Trace, ...]:
    """Return the curves of every output and manoeuvre; empty without a diagnosis.

    Parameters
    ----------
    flown
        Manoeuvres as logged.
    compared
        The same manoeuvres as the diagnosis has them: less what a user's simulator does beyond its surrogate.
    """
    if found.diagnosis is None or not found.diagnosis.fits:
        return ()
    given, answer = found.diagnosis.fits
    laid, traces = given.assembly, []
    for logged, without, named in zip(flown, compared, laid.rows, strict=True):
        for name, rows in named.items():
            lost = logged.channels[name].y - without.channels[name].y
            by = np.interp(laid.t[rows], logged.channels[name].t, lost)
            curves = (x[rows] + by for x in (laid.z, given.fitted, answer.fitted))
            traces.append(Trace(logged.number, name, laid.t[rows], *curves))
    return tuple(traces)
