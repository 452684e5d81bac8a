"""The same manoeuvre through independent codes: do the digits agree?

    python -m benchmarks.agreement

Ours; lmfit (its own least squares and errors, the model by scipy's ``lsim``, and the interval from its
profile of χ²); scipy's ``least_squares``; direct collocation solved by IPOPT.
"""

import lmfit
import numpy as np
from numpy.typing import NDArray
from scipy.signal import lsim

from advisor.aircraft.reference import PARAMETERS
from advisor.oem.solution import Solution, solve
from benchmarks.estimate import Data, by_least_squares, collocation, make, problem

NAMES = (*PARAMETERS, "alpha_0", "q_0")


def by_lmfit(
    data: Data, sigma: NDArray[np.float64]
) -> tuple[lmfit.Minimizer, lmfit.minimizer.MinimizerResult]:
    """Least squares at the noise found by us, begun at the regression."""

    def residual(values: lmfit.Parameters) -> NDArray[np.float64]:
        p = np.array([values[name].value for name in NAMES])
        a, b = [[p[1], 1 + p[2]], [p[5], p[6]]], [[p[3], p[0]], [p[7], p[4]]]
        inputs = np.column_stack([data.u, np.ones(len(data.t))])
        y = lsim((np.array(a), np.array(b), np.eye(2), np.zeros((2, 2))), inputs, data.t, X0=p[8:])[1]
        return np.asarray(((data.z - y) / sigma).ravel())

    start = lmfit.Parameters()
    for name, value in zip(NAMES, data.begin, strict=True):
        start.add(name, value=value)
    minimizer = lmfit.Minimizer(residual, start, scale_covar=False)
    return minimizer, minimizer.leastsq(ftol=1e-13, xtol=1e-13)


def main() -> None:
    data = make()
    ours = solve(problem(data.t, data.u, data.z))
    assert isinstance(ours, Solution)
    minimizer, theirs = by_lmfit(data, ours.optimum.noise[:2])
    collocated = collocation(data)[0]()
    squares = by_least_squares(data)
    interval = lmfit.conf_interval(minimizer, theirs, p_names=["M_alpha", "Z_q"], sigmas=[2])
    std = np.sqrt(np.diag(ours.covariance_cr))
    print(
        "| parameter | advisor | lmfit | least_squares + lsim | collocation + IPOPT | std_cr | std by lmfit |"
    )
    print("|---|---:|---:|---:|---:|---:|---:|")
    for j, name in enumerate(PARAMETERS):
        print(
            f"| {name} | {ours.theta[j]:.7f} | {theirs.params[name].value:.7f} | {squares[j]:.7f}"
            f" | {collocated[j]:.7f} | {std[j]:.5f} | {theirs.params[name].stderr:.5f} |"
        )
    print()
    for name, bounds in interval.items():
        j = PARAMETERS.index(name)
        low, high = bounds[0][1], bounds[-1][1]
        print(
            f"{name}: ±2 std {ours.theta[j] - 2 * std[j]:.4f} .. {ours.theta[j] + 2 * std[j]:.4f},"
            f" profile likelihood {low:.4f} .. {high:.4f}  "
        )


if __name__ == "__main__":
    main()
