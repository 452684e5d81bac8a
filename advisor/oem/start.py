"""Where the search begins: the integrated equations as a linear regression.

Integrated from the first stamp, Eqs. (1)-(2) read

    α(t) = α(0) + Z_0·t + Z_α·∫α + (1 + Z_q)·∫q + Z_δe·∫δe

and likewise for q: linear in the parameters, the initial states among them, and with noise that
integration has averaged out (integral form of the equation-error method; Klein & Morelli, Ch. 5).
Each equation is regressed at the stamps of its own left side; the derivatives are common to all
manoeuvres, constants and initial states are each manoeuvre's own.
"""

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.flight.motion import integrated
from advisor.model.response import N_LOCAL, N_SHARED
from advisor.oem.problem import Problem, Record, Signal
from advisor.oem.surface import Servo


def start(problem: Problem, *, lift_from_alpha_only: bool = False) -> tuple[FloatArray, FloatArray]:
    """Shared (7,) and local (m, 7) parameters to begin with.

    Parameters
    ----------
    lift_from_alpha_only : regress Eq. (1) with Z_q = Z_δe = 0. These two are small and trade with
        Z_α; where the model does not quite hold (an angle of attack that is late, a servo unknown) the
        free regression can begin in the valley of another minimum.

    Always returns finite numbers; a record that teaches nothing yields a least-norm solution.
    """
    local = np.zeros((len(problem.records), N_LOCAL))
    shared = np.zeros(N_SHARED)
    for output, first in (("alpha", 0), ("q", 1)):
        moment = output == "q"
        stacks, sides, own = [], [], []
        for record in problem.records:
            side = _usable(record.outputs[output])
            common, constants = _regressors(record, problem, side.t, moment)
            known = np.zeros(len(side.t))
            if lift_from_alpha_only and not moment:
                common, known = common[:, :1], common[:, 1]
            gain = np.linalg.pinv(constants)
            stacks.append(common - constants @ (gain @ common))
            sides.append(side.y - known - constants @ (gain @ (side.y - known)))
            own.append((gain, common, side.y - known))
        found = np.linalg.lstsq(np.concatenate(stacks), np.concatenate(sides), rcond=1e-12)[0]
        if moment:
            shared[3:6] = found
        elif lift_from_alpha_only:
            shared[0] = found[0]
        else:
            shared[0:3] = found
            shared[1] -= 1.0
        for m, (gain, common, y) in enumerate(own):
            initial, constant = gain @ (y - common @ found)
            local[m, 2 + first], local[m, first] = initial, constant
    for m, record in enumerate(problem.records):
        if "theta" in record.outputs:
            local[m, 4] = _usable(record.outputs["theta"]).y[0]
    return shared, local


def _regressors(
    record: Record, problem: Problem, t: FloatArray, moment: bool
) -> tuple[FloatArray, FloatArray]:
    """Integrals of α, q, δe from the record's first stamp to ``t``: (n, 3); and of 1 and s: (n, 2)."""
    alpha, q = _usable(record.outputs["alpha"]), _usable(record.outputs["q"])
    surface = _surface(record, problem.servo)
    begin = min(signal.t[0] for signal in record.outputs.values())
    if record.airspeed is None or problem.reference_airspeed_m_s is None:
        ratio = Signal(t, np.ones(len(t)))
    else:
        ratio = Signal(record.airspeed.t, record.airspeed.y / problem.reference_airspeed_m_s)
    powers = (2, 1, 2, 2) if moment else (1, 0, 1, 1)
    columns = [
        _integral(Signal(x.t, x.y * ratio.at(x.t) ** power), begin, t)
        for x, power in zip((alpha, q, surface, Signal(t, np.ones(len(t)))), powers, strict=True)
    ]
    return np.column_stack(columns[:3]), np.column_stack([np.ones(len(t)), columns[3]])


def _surface(record: Record, servo: Servo) -> Signal:
    grid, pace = servo.grid(record.elevator.t)
    if servo.lag_s <= 0.0 or len(grid) < 2:
        return Signal(grid, record.elevator.y)
    t = np.union1d(grid, np.arange(grid[0], grid[-1], pace))
    return Signal(t, servo.move(record.elevator.t, record.elevator.y, t)[0])


def _integral(x: Signal, begin: float, t: FloatArray) -> FloatArray:
    """∫ x from ``begin`` to each of ``t``, the samples joined by lines."""
    total = integrated(x.t, x.y)

    def upto(times: FloatArray) -> FloatArray:
        i = np.clip(np.searchsorted(x.t, times, side="right") - 1, 0, len(x.t) - 1)
        return total[i] + (times - x.t[i]) * (x.y[i] + x.at(times)) / 2.0

    result: FloatArray = upto(t) - upto(np.array([begin]))
    return result


def _usable(signal: Signal) -> Signal:
    keep = np.isfinite(signal.y)
    return Signal(signal.t[keep], signal.y[keep])
