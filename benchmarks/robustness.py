"""Does the search find the best fit from its own start, whatever the aircraft?

    python -m benchmarks.robustness [--aircraft 2000]

Random aircraft, stable and mildly unstable; noise 1 to 20 %; 20 to 100 Hz; stamps irregular, up to 10 % of
them missing. The search from its own start is held against one begun at the truth: ending higher is
a failure. Then the model is made wrong (60 ms of servo lag, light turbulence, lift that bends) and
nothing may crash; intervals have to widen.
"""

import argparse
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from advisor.model.outputs import N_LOCAL, N_PARAMETERS
from advisor.model.response import respond
from advisor.oem.problem import OutputErrorProblem, Record, assemble
from advisor.oem.rows import Signal
from advisor.oem.solution import Solution, solve
from advisor.oem.surface import Servo

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Flight:
    """A manoeuvre of a random aircraft."""

    problem: OutputErrorProblem
    shared: Array
    local: Array
    noise: float


def random_aircraft(rng: np.random.Generator) -> Array:
    """(8,) parameters: 1.5 to 12 rad/s, damping 0.2 to 1.2; one in six mildly unstable.

    Mildly: half of them diverge without oscillating and double in 6 s or more, the worst that
    MIL-F-8785C (3.2.1.1, level 3) leaves to a pilot; the others oscillate with slightly negative damping.
    """
    frequency = np.exp(rng.uniform(np.log(1.5), np.log(12.0)))
    damping = rng.uniform(0.2, 1.2)
    share = rng.uniform(0.3, 0.75)
    z_alpha = -2.0 * damping * frequency * share
    m_q = -2.0 * damping * frequency * (1.0 - share)
    z_q = rng.uniform(-0.1, 0.1)
    m_alpha = (z_alpha * m_q - frequency**2) / (1.0 + z_q)
    fate = rng.random()
    if fate < 1.0 / 12.0:
        m_q = -z_alpha + 2.0 * rng.uniform(0.0, 0.05) * frequency
        m_alpha = (z_alpha * m_q - frequency**2) / (1.0 + z_q)
    elif fate < 2.0 / 12.0:
        growth = rng.uniform(0.02, math.log(2.0) / 6.0)
        m_alpha = (z_alpha - growth) * (m_q - growth) / (1.0 + z_q)
    m_delta = -(frequency**2) * rng.uniform(0.8, 2.5)
    z_delta = rng.uniform(-0.15, 0.15) * abs(m_delta) / frequency
    return np.array([0.0, z_alpha, z_q, z_delta, rng.normal(0.0, 0.1), m_alpha, m_q, m_delta])


def fly(rng: np.random.Generator) -> Flight:
    """A 3-2-1-1 fitted to the aircraft's frequency, measured badly."""
    theta = random_aircraft(rng)
    rate = rng.uniform(20.0, 100.0)
    frequency = max(np.sqrt(abs(theta[1] * theta[6] - (1 + theta[2]) * theta[5])), 1.0)
    unit = float(np.clip(1.6 / frequency, 0.15, 1.2))
    length = 2.0 + 7.0 * unit + 6.0 / frequency + 1.0
    t = np.arange(0.0, length, 1.0 / rate)
    u = np.zeros(len(t))
    edge = 1.0
    sign = rng.choice([-1.0, 1.0])
    for span, size in ((3, 0.8), (2, -1.2), (1, 1.1), (1, -1.1)):
        u[(t >= edge) & (t < edge + span * unit)] += sign * 0.03 * size
        edge += span * unit
    missing = rng.uniform(0.0, 0.1)
    stamps = {}
    for name in ("alpha", "q"):
        s = np.sort(t[1:-1] + rng.uniform(-0.4, 0.4, len(t) - 2) / rate)
        stamps[name] = s[rng.random(len(s)) > missing]
    elevator = Signal(t, u)
    problem = OutputErrorProblem(
        (Record(elevator, {n: Signal(s, np.zeros(len(s))) for n, s in stamps.items()}),)
    )
    assembly = assemble(problem)
    shared = np.append(theta[[1, 2, 3, 5, 6, 7]], 0.0)
    local = np.zeros((1, N_LOCAL))
    local[0, :4] = theta[0], theta[4], rng.normal(0.0, 0.01), rng.normal(0.0, 0.03)
    y = np.empty(len(assembly.z))
    if not respond(assembly.grid, shared, local, y, np.empty((0, N_PARAMETERS))):
        raise ArithmeticError("the aircraft leaves the range of numbers")
    noise = rng.uniform(0.01, 0.2)
    outputs = {}
    for name, rows in assembly.rows[0].items():
        clean = y[rows]
        outputs[name] = Signal(
            assembly.t[rows], clean + noise * clean.std() * rng.standard_normal(len(clean))
        )
    return Flight(OutputErrorProblem((Record(elevator, outputs),)), shared, local, noise)


@dataclass(frozen=True)
class Result:
    """How the searches ended."""

    count: int
    worse: int
    """Searches that ended above the one begun at the truth."""
    refused: int
    """Answers that were a reason instead of an estimate."""
    iterations: float


def search_everywhere(count: int, seed: int = 0) -> Result:
    """Begin ``count`` searches at their own start and at the truth."""
    rng = np.random.default_rng(seed)
    worse = refused = 0
    iterations = []
    for _ in range(count):
        flight = fly(rng)
        own = solve(flight.problem)
        best = solve(flight.problem, begin=(flight.shared, flight.local))
        if not isinstance(own, Solution):
            refused += 1
            continue
        iterations.append(own.optimum.iterations)
        if isinstance(best, Solution) and own.cost > best.cost * (1.0 + 1e-6):
            worse += 1
    return Result(count, worse, refused, float(np.mean(iterations)))


def mismatched(kind: str, seed: int) -> OutputErrorProblem:
    """A manoeuvre of a small aircraft that the model does not describe, 2 % noise."""
    rng = np.random.default_rng(seed)
    theta = np.array([0.0, -6.0, 0.0, -0.5, 0.0, -40.0, -4.0, -60.0])
    t = np.arange(0.0, 8.0, 0.02)
    u = np.zeros(len(t))
    edge = 1.0
    for span, size in ((3, 0.8), (2, -1.2), (1, 1.1), (1, -1.1)):
        u[(t >= edge) & (t < edge + span * 0.3)] += 0.04 * size
        edge += span * 0.3
    surface = Servo(0.06).move(t, u, t)[0] if kind == "lag" else u
    gust = np.zeros(len(t))
    if kind == "turbulence":
        for k in range(1, len(t)):
            gust[k] = 0.97 * gust[k - 1] + np.sqrt(1 - 0.97**2) * 0.006 * rng.standard_normal()
    bend = -25.0 if kind == "lift" else 0.0

    def rate(time: float, x: Array) -> list[float]:
        delta, wind = np.interp(time, t, surface), np.interp(time, t, gust)
        alpha = x[0] + wind
        lift = theta[1] * alpha - bend * theta[1] * alpha**3 + theta[3] * delta
        return [lift + x[1], theta[5] * alpha + theta[6] * x[1] + theta[7] * delta]

    x = solve_ivp(rate, (0.0, t[-1]), [0.0, 0.0], t_eval=t, max_step=0.02, rtol=1e-8, atol=1e-10).y
    alpha = x[0] + gust
    z = [v + 0.02 * v.std() * rng.standard_normal(len(t)) for v in (alpha, x[1])]
    return OutputErrorProblem((Record(Signal(t, u), {"alpha": Signal(t, z[0]), "q": Signal(t, z[1])}),))


def main() -> None:
    parser = argparse.ArgumentParser(description="Robustness of the search.")
    parser.add_argument("--aircraft", type=int, default=2000)
    arguments = parser.parse_args()
    result = search_everywhere(arguments.aircraft)
    print(
        f"{result.count} random aircraft: {result.worse} ended above the best fit, {result.refused} gave a"
        f" reason instead, {result.iterations:.1f} iterations on average"
    )
    for kind in ("nothing", "lag", "turbulence", "lift"):
        widths = []
        for seed in range(20):
            found = solve(mismatched(kind, seed))
            if isinstance(found, Solution):
                ratio = np.sqrt(np.diag(found.covariance) / np.diag(found.covariance_cr))
                widths.append(np.sqrt(found.covariance[5, 5]) * np.array([1.0, 1.0 / ratio[5]]))
        std, plain = np.median(widths, axis=0)
        print(
            f"model wrong by {kind:10s}: {len(widths)}/20 estimates, M_alpha ± {std:.2f} (plain {plain:.2f})"
        )


if __name__ == "__main__":
    main()
