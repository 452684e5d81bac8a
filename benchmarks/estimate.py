"""How fast the estimator is, against four other ways to the same optimum.

    python -m benchmarks.estimate

Same data, same cost, CPU time, one run. What each row is: ``benchmarks/README.md``. Every row ends at its
own optimum, and the cost there is evaluated by one and the same function.
"""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares, minimize
from scipy.signal import lsim

from advisor.aircraft.reference import PARAMETERS
from advisor.model.outputs import N_PARAMETERS
from advisor.model.response import respond
from advisor.oem.problem import OutputErrorProblem, Record
from advisor.oem.rows import Signal
from advisor.oem.solution import search, solve
from advisor.oem.start import start
from benchmarks.accuracy import JET, clean

Array = NDArray[np.float64]

NOISE = 0.05
SAMPLES = 500


@dataclass(frozen=True)
class Data:
    """One manoeuvre: 500 samples at 50 Hz of the jet, 5 % noise."""

    t: Array
    u: Array
    z: Array
    begin: Array
    """(10,) the regression's eight parameters and two initial states: where gradient methods begin."""
    prior: Array
    """(10,) parameters 30 % off and the first measured state: where the paper's simplex begins."""


def make() -> Data:
    t, u, response = (x[:SAMPLES] for x in clean())
    z = response + NOISE * response.std(axis=0) * np.random.default_rng(7).standard_normal(response.shape)
    shared, local = start(problem(t, u, z))
    off = 1.0 + 0.3 * np.array([1, -1, 1, -1, -1, 1, -1, 1])
    return Data(t, u, z, from_solver(shared, local), np.concatenate([off * JET, z[0]]))


def problem(t: Array, u: Array, z: Array) -> OutputErrorProblem:
    return OutputErrorProblem((Record(Signal(t, u), {"alpha": Signal(t, z[:, 0]), "q": Signal(t, z[:, 1])}),))


def from_solver(shared: Array, local: Array) -> Array:
    """(10,) in the order of ``PARAMETERS``, then α(0), q(0)."""
    own = local[0]
    return np.array([own[0], *shared[:3], own[1], *shared[3:6], own[2], own[3]])


def log_cost(data: Data, p: Array) -> float:
    """log J of a set of parameters, by the exact solution: the judge of all rows."""
    assembly, _ = search(problem(data.t, data.u, data.z))
    shared = np.array([p[1], p[2], p[3], p[5], p[6], p[7], 0.0])
    local = np.array([[p[0], p[4], p[8], p[9], 0.0, 0.0, 0.0]])
    y = np.empty(len(assembly.z))
    respond(assembly.grid, shared, local, y, np.empty((0, N_PARAMETERS)))
    v = (assembly.z - y).reshape(2, -1)
    return float(np.sum(np.log(np.mean(v**2, axis=1))))


# --- the paper: Nelder-Mead over a Runge-Kutta loop ---------------------------------------------------------


def scalar_cost(data: Data) -> Callable[[Array], float]:
    """log J by fourth-order Runge-Kutta in plain Python numbers."""
    u, za, zq = data.u.tolist(), data.z[:, 0].tolist(), data.z[:, 1].tolist()
    h = float(data.t[1] - data.t[0])

    def cost(p: Array) -> float:
        z0, za_, zq_, zd, m0, ma, mq, md, a, q = p.tolist()
        sa = sq = 0.0
        n = len(u)
        for k in range(n):
            sa += (za[k] - a) ** 2
            sq += (zq[k] - q) ** 2
            if k + 1 == n:
                break
            d0, d2 = u[k], u[k + 1]
            d1 = 0.5 * (d0 + d2)
            a1 = z0 + za_ * a + (1 + zq_) * q + zd * d0
            q1 = m0 + ma * a + mq * q + md * d0
            x, y = a + 0.5 * h * a1, q + 0.5 * h * q1
            a2 = z0 + za_ * x + (1 + zq_) * y + zd * d1
            q2 = m0 + ma * x + mq * y + md * d1
            x, y = a + 0.5 * h * a2, q + 0.5 * h * q2
            a3 = z0 + za_ * x + (1 + zq_) * y + zd * d1
            q3 = m0 + ma * x + mq * y + md * d1
            x, y = a + h * a3, q + h * q3
            a4 = z0 + za_ * x + (1 + zq_) * y + zd * d2
            q4 = m0 + ma * x + mq * y + md * d2
            a += h * (a1 + 2 * a2 + 2 * a3 + a4) / 6
            q += h * (q1 + 2 * q2 + 2 * q3 + q4) / 6
            if not abs(a) + abs(q) < 1e6:
                return 1e9
        return math.log(sa / n) + math.log(sq / n)

    return cost


def matrix_cost(data: Data) -> Callable[[Array], float]:
    """The same with NumPy matrix products in the loop."""
    h = float(data.t[1] - data.t[0])

    def cost(p: Array) -> float:
        a = np.array([[p[1], 1 + p[2]], [p[5], p[6]]])
        b, c, x = np.array([p[3], p[7]]), np.array([p[0], p[4]]), p[8:10]
        y = np.empty_like(data.z)
        for k in range(len(data.t)):
            y[k] = x
            if k + 1 == len(data.t):
                break
            d0, d2 = data.u[k], data.u[k + 1]
            d1 = 0.5 * (d0 + d2)
            k1 = a @ x + b * d0 + c
            k2 = a @ (x + 0.5 * h * k1) + b * d1 + c
            k3 = a @ (x + 0.5 * h * k2) + b * d1 + c
            k4 = a @ (x + h * k3) + b * d2 + c
            x = x + h * (k1 + 2 * k2 + 2 * k3 + k4) / 6
            if not np.abs(x).sum() < 1e6:
                return 1e9
        return float(np.sum(np.log(np.mean((data.z - y) ** 2, axis=0))))

    return cost


def simplex(cost: Callable[[Array], float], data: Data) -> Array:
    """``fminsearch`` with its default tolerances, on log J, without a limit on its evaluations."""
    p = data.prior
    first = np.vstack([p, p + np.diag(np.where(p != 0, 0.05 * p, 0.00025))])
    options = {"initial_simplex": first, "xatol": 1e-4, "fatol": 1e-4, "maxiter": 20000, "maxfev": 20000}
    return np.asarray(minimize(cost, p, method="Nelder-Mead", options=options).x)


# --- scipy: least squares over its linear simulation --------------------------------------------------------


def by_least_squares(data: Data) -> Array:
    """``least_squares`` over ``lsim``, the weights renewed until J stands still."""
    inputs = np.column_stack([data.u, np.ones(len(data.t))])

    def residual(p: Array, weight: Array) -> Array:
        a = np.array([[p[1], 1 + p[2]], [p[5], p[6]]])
        b = np.array([[p[3], p[0]], [p[7], p[4]]])
        y = lsim((a, b, np.eye(2), np.zeros((2, 2))), inputs, data.t, X0=p[8:10])[1]
        return np.asarray(((data.z - y) * weight).ravel())

    p, last = data.begin, math.inf
    for _ in range(20):
        sigma = np.sqrt(np.mean(residual(p, np.ones(2)).reshape(-1, 2) ** 2, axis=0))
        cost = float(np.sum(np.log(sigma)))
        if last - cost < 1e-10:
            break
        last = cost
        p = least_squares(residual, p, args=(1 / sigma,), method="lm", xtol=1e-10, ftol=1e-10).x
    return np.asarray(p)


# --- CasADi and IPOPT ---------------------------------------------------------------------------------------


IPOPT = {
    "ipopt.print_level": 0,
    "print_time": False,
    "ipopt.sb": "yes",
    "ipopt.tol": 1e-10,
    "show_eval_warnings": False,
}


def collocation(data: Data) -> tuple[Callable[[], Array], float]:
    """Direct collocation (Legendre, three points), the weights renewed until J stands still.

    Returns the solve and the time to build it.
    """
    begin = time.process_time()
    h = float(data.t[1] - data.t[0])
    tau = [0.0, *ca.collocation_points(3, "legendre")]
    c, d, _ = ca.collocation_coeff(tau[1:])
    n = len(data.t)
    here, there, du, q = ca.SX.sym("x", 2), ca.SX.sym("y", 2), ca.SX.sym("u", 2), ca.SX.sym("p", 8)
    inside = ca.SX.sym("c", 2, 3)
    a = ca.vertcat(ca.horzcat(q[1], 1 + q[2]), ca.horzcat(q[5], q[6]))
    b, e = ca.vertcat(q[3], q[7]), ca.vertcat(q[0], q[4])
    points = ca.horzcat(here, inside)
    levels = (du[0] + x * (du[1] - du[0]) for x in tau[1:])
    rates = ca.horzcat(*(a @ inside[:, j] + b * level + e for j, level in enumerate(levels)))
    defects = ca.vertcat(ca.vec(points @ c - h * rates), there - points @ d)
    interval = ca.Function("interval", [here, inside, there, du, q], [defects]).map(n - 1)
    p, states = ca.MX.sym("p", 8), ca.MX.sym("x", 2, n)
    inner = ca.MX.sym("c", 2, 3 * (n - 1))
    inputs = ca.DM(np.vstack([data.u[:-1], data.u[1:]]))
    g = ca.vec(interval(states[:, :-1], inner, states[:, 1:], inputs, ca.repmat(p, 1, n - 1)))
    v = ca.DM(data.z.T) - states
    weight = ca.MX.sym("w", 2)
    cost = weight[0] * ca.sumsqr(v[0, :]) + weight[1] * ca.sumsqr(v[1, :])
    unknown = ca.vertcat(p, ca.vec(states), ca.vec(inner))
    solver = ca.nlpsol("solver", "ipopt", {"x": unknown, "f": cost, "g": g, "p": weight}, IPOPT)
    smooth = np.array(
        [np.convolve(np.pad(x, 4, mode="edge"), np.full(9, 1 / 9), mode="valid") for x in data.z.T]
    )
    x0 = np.concatenate([data.begin[:8], smooth.T.ravel(), np.repeat(smooth.T[:-1], 3, axis=0).ravel()])
    built = time.process_time() - begin

    def run() -> Array:
        found, weights, last = x0, 1.0 / np.var(data.z - smooth.T, axis=0), math.inf
        for _ in range(20):
            found = np.asarray(solver(x0=found, lbg=0, ubg=0, p=weights / n)["x"]).ravel()
            power = np.mean((data.z - found[8 : 8 + 2 * n].reshape(n, 2)) ** 2, axis=0)
            weights, now = 1.0 / power, float(np.sum(np.log(power)))
            if last - now < 1e-11:
                break
            last = now
        return found[:10]

    return run, built


def shooting(data: Data) -> tuple[Callable[[], Array], float]:
    """Single shooting over Runge-Kutta of the same cost, exact derivatives."""
    begin = time.process_time()
    h = float(data.t[1] - data.t[0])
    p, x, du = ca.SX.sym("p", 8), ca.SX.sym("x", 2), ca.SX.sym("u", 2)
    a = ca.vertcat(ca.horzcat(p[1], 1 + p[2]), ca.horzcat(p[5], p[6]))
    b, e = ca.vertcat(p[3], p[7]), ca.vertcat(p[0], p[4])

    def rate(s: ca.SX, level: ca.SX) -> ca.SX:
        return a @ s + b * level + e

    middle = (du[0] + du[1]) / 2
    k1 = rate(x, du[0])
    k2 = rate(x + h / 2 * k1, middle)
    k3 = rate(x + h / 2 * k2, middle)
    k4 = rate(x + h * k3, du[1])
    step = ca.Function("step", [x, du, p], [x + h * (k1 + 2 * k2 + 2 * k3 + k4) / 6])
    unknown = ca.MX.sym("w", 10)
    n = len(data.t)
    inputs = ca.DM(np.vstack([data.u[:-1], data.u[1:]]))
    states = step.mapaccum(n - 1)(unknown[8:], inputs, ca.repmat(unknown[:8], 1, n - 1))
    v = ca.DM(data.z.T) - ca.horzcat(unknown[8:], states)
    cost = ca.log(ca.sumsqr(v[0, :]) / n) + ca.log(ca.sumsqr(v[1, :]) / n)
    solver = ca.nlpsol("solver", "ipopt", {"x": unknown, "f": cost}, IPOPT)
    built = time.process_time() - begin

    def run() -> Array:
        return np.asarray(solver(x0=data.begin)["x"]).ravel()

    return run, built


# --- ours ---------------------------------------------------------------------------------------------------


def ours(data: Data) -> Array:
    _, optimum = search(problem(data.t, data.u, data.z))
    return from_solver(optimum.shared, optimum.local)


def cpu(run: Callable[[], object], repeats: int = 1) -> float:
    """Seconds of CPU time a call."""
    begin = time.process_time()
    for _ in range(repeats):
        run()
    return (time.process_time() - begin) / repeats


def race() -> None:
    data = make()
    ours(data)
    quick = cpu(lambda: ours(data), 300)
    best = log_cost(data, ours(data))
    print(f"{'way to the optimum':58s} {'CPU':>10s} {'ratio':>8s} {'goal':>8s}  {'J above ours':>12s}")
    print(f"{'advisor: layout, start, Gauss-Newton':58s} {1e3 * quick:7.2f} ms {1:8.0f}")
    shot, shot_built = shooting(data)
    rows: list[tuple[str, Callable[[], Array], int, str]] = [
        ("scipy least_squares over lsim", lambda: by_least_squares(data), 3, "75"),
        (f"CasADi + IPOPT, shooting (built before, {shot_built:.2f} s)", shot, 10, "15"),
        (
            "Nelder-Mead over RK4 in plain Python (the paper's way)",
            lambda: simplex(scalar_cost(data), data),
            1,
            "1000",
        ),
        (
            "Nelder-Mead over RK4 with NumPy matrix products",
            lambda: simplex(matrix_cost(data), data),
            1,
            "5000",
        ),
    ]
    collocate, built = collocation(data)
    rows.insert(2, (f"CasADi + IPOPT, collocation (built before, {built:.2f} s)", collocate, 2, ""))
    for name, run, repeats, goal in rows:
        p = run()
        seconds = cpu(run, repeats)
        excess = math.expm1(log_cost(data, p) - best)
        print(f"{name:58s} {1e3 * seconds:7.1f} ms {seconds / quick:8.0f} {goal:>8s}  {excess:+12.1e}")
    complete = cpu(lambda: solve(problem(data.t, data.u, data.z)), 100)
    print(f"{'advisor, complete: with both kinds of errors':58s} {1e3 * complete:7.2f} ms")


def scale() -> None:
    """Cost against the amount of data."""
    data = make()
    print("\nLinear in the data (optimum of a joint estimate):")
    one = problem(data.t, data.u, data.z)
    rng = np.random.default_rng(3)
    base = 0.0
    for count in (1, 10, 100):
        records = tuple(
            Record(
                one.records[0].elevator,
                {
                    n: Signal(s.t, s.y + 0.02 * s.y.std() * rng.standard_normal(len(s.y)))
                    for n, s in one.records[0].outputs.items()
                },
            )
            for _ in range(count)
        )
        many = OutputErrorProblem(records)
        search(many)
        seconds = cpu(lambda many=many: search(many), max(1, 60 // count))  # type: ignore[misc]
        base = base or seconds
        print(f"  {count:4d} manoeuvres {1e3 * seconds:8.2f} ms = {seconds / base / count:.2f} x linear")


def main() -> None:
    print(f"{len(PARAMETERS)} parameters and 2 initial states, {SAMPLES} samples of alpha and q, CPU time\n")
    race()
    scale()


if __name__ == "__main__":
    main()
