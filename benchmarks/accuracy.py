"""Is the estimator as accurate as theory allows, and are its error bars true?

    python -m benchmarks.accuracy [--manoeuvres 2000] [--write docs/data/accuracy.md]

Simulated manoeuvres follow the model exactly (a general matrix exponential, not the advisor's
own discretisation); the noise is white, or coloured by a first-order autoregression. They go the whole way a
flight's manoeuvres go, ``estimate`` and ``estimate_jointly``. For each of the eight parameters: mean square
error over the Cramér-Rao bound, and how often value ± 1.96 std holds the truth.

The mean square of 2,000 errors scatters by 3 % around its expectation. So each error stands beside that of a
reference on the same noise: the linear estimator that is told truth and colour, whose mean square error is
the bound by construction. The ratio of the two has the same expectation and far less scatter.
"""

import argparse
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm
from scipy.signal import lfilter

from advisor.aircraft.aircraft import Aircraft, Elevator
from advisor.aircraft.reference import PARAMETERS
from advisor.flight.maneuvers.maneuver import Maneuver, Span
from advisor.flight.signals.record import Channel
from advisor.model.outputs import N_LOCAL, N_PARAMETERS
from advisor.model.response import respond
from advisor.oem.covariance import influence
from advisor.oem.estimate import Estimate
from advisor.oem.estimator import estimate, estimate_jointly
from advisor.oem.instruments import extra_of, unknown_instruments
from advisor.oem.problem import OutputErrorProblem, Record, assemble
from advisor.oem.rows import Signal

Array = NDArray[np.float64]

JET = np.array([-0.009, -0.483, 0.104, 0.676, 0.475, -4.93, -2.01, -7.21])
RATE_HZ = 50.0
LENGTH_S = 14.0
NOISE = 0.05
MEMORIES = (0.0, 0.5, 0.8, 0.95)
JOINT = 3


@dataclass(frozen=True)
class Row:
    """One line of the table."""

    estimate: str
    memory: float
    count: int
    failed: int
    efficiency: Array
    """(8,) mean square error over that of the reference, which is at the Cramér-Rao bound."""
    unpaired: Array
    """(8,) mean square error over the bound itself."""
    plain: Array
    """(8,) share of manoeuvres whose value ± 1.96 std_cr holds the truth."""
    corrected: Array
    """(8,) the same with std."""


def clean() -> tuple[Array, Array, Array]:
    """Stamps (n,), elevator (n,) and the response (n, 2) of the jet to a modified 3-2-1-1."""
    t = np.arange(0.0, LENGTH_S, 1.0 / RATE_HZ)
    system = JET[[1, 3, 5, 7]].reshape(2, 2)
    alpha, trim = np.linalg.solve(system, -JET[[0, 4]])
    u = np.full(len(t), trim)
    edge = 1.0
    for length, size in ((3.0, 0.8), (2.0, -1.2), (1.0, 1.1), (1.0, -1.1)):
        u[(t >= edge - 1e-9) & (t < edge + length - 1e-9)] += 0.03 * size
        edge += length
    big = np.zeros((5, 5))
    big[0, :3] = JET[1], 1 + JET[2], JET[3]
    big[1, :3] = JET[5], JET[6], JET[7]
    big[0, 4], big[1, 4] = JET[0], JET[4]
    big[2, 3] = 1.0
    x = np.array([alpha, 0.0])
    response = [x]
    step = expm(big / RATE_HZ)
    for k in range(len(t) - 1):
        x = (step @ [*x, u[k], (u[k + 1] - u[k]) * RATE_HZ, 1.0])[:2]
        response.append(x)
    return t, u, np.array(response)


def noise(rng: np.random.Generator, size: tuple[int, int], memory: float) -> Array:
    """AR(1) noise of unit variance down the first axis, stationary from its first sample."""
    e = rng.standard_normal(size)
    e[1:] *= np.sqrt(1.0 - memory**2)
    return np.asarray(lfilter([1.0], [1.0, -memory], e, axis=0))


def flown(number: int, noisy: Array) -> Maneuver:
    """A manoeuvre of the jet whose α and q read ``noisy`` (n, 2)."""
    t, u, _ = clean()
    channels = {"elevator": u, "alpha": noisy[:, 0], "q": noisy[:, 1]}
    span = Span(0.0, 1.0, 8.0, float(t[-1]), "3-2-1-1", (), "")
    return Maneuver(number, 0, span, {name: Channel(name, t, y) for name, y in channels.items()})


def study(count: int, memory: float, together: int, seed: int = 1) -> Row:
    """Estimate ``count`` times from ``together`` manoeuvres at once."""
    rng = np.random.default_rng(seed)
    response = clean()[2]
    spread = NOISE * response.std(axis=0)
    aircraft = Aircraft(elevator=Elevator(lag_s=0.0))
    reference = influence_at_truth(memory, together, spread, aircraft)
    found, least = [], []
    for _ in range(count):
        noises = [spread * noise(rng, response.shape, memory) for _ in range(together)]
        maneuvers = [flown(number, response + v) for number, v in enumerate(noises, start=1)]
        found.append(
            estimate(maneuvers[0], aircraft) if together == 1 else estimate_jointly(maneuvers, aircraft)
        )
        whitened = [
            white(column / size, memory) for v in noises for column, size in zip(v.T, spread, strict=True)
        ]
        least.append(np.concatenate(whitened) @ reference)
    good = [isinstance(e, Estimate) for e in found]
    estimates = [e for e in found if isinstance(e, Estimate)]
    error = np.array([e.theta for e in estimates]) - JET
    mean_square = np.mean(error**2, axis=0)
    return Row(
        estimate="one manoeuvre" if together == 1 else f"{together} jointly",
        memory=memory,
        count=count,
        failed=count - len(estimates),
        efficiency=mean_square / np.mean(np.array(least)[good] ** 2, axis=0),
        unpaired=mean_square / np.sum(reference**2, axis=0),
        plain=np.mean(np.abs(error) < 1.96 * np.array([e.std_cr for e in estimates]), axis=0),
        corrected=np.mean(np.abs(error) < 1.96 * np.array([e.std for e in estimates]), axis=0),
    )


def white(v: Array, memory: float) -> Array:
    """Stationary AR(1) noise of unit variance, or what passes with it, made white: first axis is time."""
    result = v.copy()
    result[1:] = (v[1:] - memory * v[:-1]) / np.sqrt(1.0 - memory**2)
    return result


def influence_at_truth(memory: float, together: int, spread: Array, aircraft: Aircraft) -> Array:
    """(N, 8) error of the reference for each unit of whitened noise; squares of a column sum to the bound.

    The reference leaves open what the estimator leaves open: the aircraft file does not tell when a command
    arrives, or where instruments are.
    """
    t, u, response = clean()
    outputs = {"alpha": Signal(t, response[:, 0]), "q": Signal(t, response[:, 1])}
    problem = OutputErrorProblem((Record(Signal(t, u), outputs),) * together)
    assembly = assemble(problem)
    y, g = np.empty(len(assembly.z)), np.empty((len(assembly.z), N_PARAMETERS))
    local = np.zeros((together, N_LOCAL))
    local[:, 0], local[:, 1] = JET[0], JET[4]
    local[:, 2:4] = response[0]
    shared = np.append(JET[[1, 2, 3, 5, 6, 7]], 0.0)
    respond(assembly.grid, shared, local, y, g)
    extra = extra_of(problem, assembly, shared, local, unknown_instruments(problem, aircraft))
    columns = extra.columns.copy()
    for named in assembly.rows:
        for output, size in zip(("alpha", "q"), spread, strict=True):
            rows = named[output]
            g[rows] = white(g[rows] / size, memory)
            columns[rows] = white(columns[rows] / size, memory)
    # White and of unit variance now: the influence's own covariance is the bound.
    found = influence(assembly, g, np.ones(4), extra.whitened(columns))
    assert found is not None
    return found.rows[:, : len(JET)]


def table(rows: list[Row]) -> str:
    """The three tables in Markdown."""
    head = "| estimate | noise | " + " | ".join(PARAMETERS) + " |\n" + "|---|---|" + "---:|" * 8

    def line(row: Row, values: Array, scale: float, digits: int) -> str:
        name = "white" if row.memory == 0.0 else f"AR(1), φ = {row.memory:g}"
        return f"| {row.estimate} | {name} | " + " | ".join(f"{scale * v:.{digits}f}" for v in values) + " |"

    return "\n".join(
        [
            "Mean square error over the Cramér-Rao bound (of an estimator that is told the colour):",
            "",
            head,
            *(line(row, row.efficiency, 1.0, 3) for row in rows),
            "",
            "Share of ±1.96·`std` intervals that hold the truth, percent (95 is right):",
            "",
            head,
            *(line(row, row.corrected, 100.0, 1) for row in rows),
            "",
            "The same with the plain bound `std_cr`, for comparison:",
            "",
            head,
            *(line(row, row.plain, 100.0, 1) for row in rows),
        ]
    )


def main() -> None:
    parser = argparse.ArgumentParser(description="Accuracy of the estimator against the Cramér-Rao bound.")
    parser.add_argument("--manoeuvres", type=int, default=2000)
    parser.add_argument("--write", type=Path, help="write the tables to this file")
    arguments = parser.parse_args()
    begin = time.process_time()
    rows = []
    for together, count in ((1, arguments.manoeuvres), (JOINT, arguments.manoeuvres)):
        for memory in MEMORIES:
            print(f"{together} x {count}, memory {memory} ...", file=sys.stderr)
            rows.append(study(count, memory, together))
    text = table(rows)
    failed = sum(row.failed for row in rows)
    ratios = np.concatenate([row.unpaired for row in rows])
    text += (
        f"\n\nUnpaired, the ratios of the first table lie between {ratios.min():.3f} and {ratios.max():.3f}."
    )
    text += f" {len(rows)} x {arguments.manoeuvres} estimates, {failed} without a result;"
    text += f" {time.process_time() - begin:.0f} s of CPU time."
    print(text)
    if arguments.write:
        arguments.write.write_text(f"{text}\n", encoding="utf-8")


if __name__ == "__main__":
    main()
