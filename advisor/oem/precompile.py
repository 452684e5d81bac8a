"""Compile the estimator before the first flight, so that no pilot waits: ``python -m
advisor.oem.precompile``.

The compiled code is stored next to the modules (or in ``NUMBA_CACHE_DIR``). Every later start loads the
compiled code in a fraction of a second.
"""

from dataclasses import replace

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import Maneuver, Span
from advisor.flight.signals.record import Channel
from advisor.model.axes.lateral import LATERAL
from advisor.model.outputs import SHARED
from advisor.oem.axis.estimator import estimate_axis
from advisor.oem.driven_motion.estimate import driven, driven_without_alpha
from advisor.oem.estimator import estimate_jointly
from advisor.oem.instrument_fit import PITCH
from advisor.oem.prepare import Prepared, prepare
from advisor.oem.prior import about_zero
from advisor.oem.solution import Solution, solve


def warm() -> None:
    """Estimate a small flight in every way: alone, jointly, and with moving air."""
    maneuver = _flown()
    prepared = prepare([maneuver], Aircraft())
    solution = solve(prepared.problem) if isinstance(prepared, Prepared) else None
    if isinstance(solution, Solution):
        for estimate in (driven, driven_without_alpha):
            estimate(solution, PITCH, (), lambda *_: about_zero(np.zeros(len(SHARED))))
    estimate_jointly([maneuver, maneuver], Aircraft())
    estimate_axis(LATERAL, [_rolled(maneuver)], Aircraft())


def _rolled(maneuver: Maneuver) -> Maneuver:
    """Return a manoeuvre with an aileron doublet and arbitrary motion, which compiles the lateral kernels."""
    channels = maneuver.channels
    names = {
        "aileron": "elevator", "p": "q", "r": "q", "bank": "theta", "a_y": "a_z", "beta": "alpha",
        "rudder": "elevator",
    }  # fmt: skip
    side = {name: replace(channels[source], name=name) for name, source in names.items()}
    return replace(maneuver, channels={**channels, **side})


def _flown() -> Maneuver:
    """Return a four-channel doublet of an arbitrary aircraft, for which an estimate exists."""
    rng = np.random.default_rng(1)
    t = np.arange(0.0, 6.0, 0.05)
    u = np.where((t > 1.0) & (t < 2.0), 0.03, 0.0) - np.where((t > 2.0) & (t < 3.0), 0.03, 0.0)
    alpha, q, theta = np.zeros((3, len(t)))
    normal = -2.0 * alpha
    for i, h in enumerate(np.diff(t)):
        normal[i] = -2.0 * alpha[i] - 0.2 * u[i]
        alpha[i + 1] = alpha[i] + h * (normal[i] + q[i])
        q[i + 1] = q[i] + h * (-10.0 * alpha[i + 1] - 3.0 * q[i] - 12.0 * u[i])
        theta[i + 1] = theta[i] + h * q[i + 1]
    flown = {"alpha": alpha, "q": q, "theta": theta, "a_z": 20.0 * normal, "airspeed": np.full(len(t), 20.0)}
    channels = {
        name: Channel(name, t, y + 0.01 * np.max(np.abs(y)) * rng.standard_normal(len(t)))
        for name, y in flown.items()
    }
    span = Span(0.0, 1.0, 3.0, 6.0, "doublet", ((1.0, 0.03), (2.0, -0.03), (3.0, 0.0)), "end of log")
    return Maneuver(1, 0, span, {"elevator": Channel("elevator", t, u), **channels})


if __name__ == "__main__":
    warm()
