"""Is the estimator as accurate as theory allows, and are its error bars true?

    python -m benchmarks.accuracy [--manoeuvres 2000] [--write docs/accuracy.md]

Simulated manoeuvres follow the model exactly (a general matrix exponential, not the advisor's
own discretisation); the noise is white, or coloured by a first-order autoregression. For each of the
eight parameters: mean square error over the Cramér-Rao bound where the noise is white, and how often
value ± 1.96 std holds the truth. The joint estimate is judged in the same way.
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

from advisor.aircraft import PARAMETERS
from advisor.model.response import N_LOCAL, N_PARAMETERS, respond
from advisor.oem.covariance import influence
from advisor.oem.problem import Problem, Record, Signal, assemble
from advisor.oem.solution import Solution, solve

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
    """(8,) mean square error over the Cramér-Rao bound for this noise, its colour known."""
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


def study(count: int, memory: float, together: int, seed: int = 1) -> Row:
    """Estimate ``count`` times from ``together`` manoeuvres at once."""
    rng = np.random.default_rng(seed)
    t, u, response = clean()
    spread = NOISE * response.std(axis=0)

    def measured(scale: float) -> Problem:
        records = []
        for _ in range(together):
            z = response + scale * spread * noise(rng, response.shape, memory)
            records.append(Record(Signal(t, u), {"alpha": Signal(t, z[:, 0]), "q": Signal(t, z[:, 1])}))
        return Problem(tuple(records))

    found = [solve(measured(1.0)) for _ in range(count)]
    good = [s for s in found if isinstance(s, Solution)]
    error = np.array([s.theta for s in good]) - JET
    plain = np.sqrt(np.array([np.diag(s.covariance_cr) for s in good]))
    corrected = np.sqrt(np.array([np.diag(s.covariance) for s in good]))
    return Row(
        estimate="one manoeuvre" if together == 1 else f"{together} jointly",
        memory=memory,
        count=count,
        failed=count - len(good),
        efficiency=np.mean(error**2, axis=0) / bound(measured(0.0), spread, memory),
        plain=np.mean(np.abs(error) < 1.96 * plain, axis=0),
        corrected=np.mean(np.abs(error) < 1.96 * corrected, axis=0),
    )


def bound(problem: Problem, spread: Array, memory: float) -> Array:
    """(8,) Cramér-Rao bounds at the truth for noise of this colour: every output whitened exactly."""
    assembly = assemble(problem)
    y, g = np.empty(len(assembly.z)), np.empty((len(assembly.z), N_PARAMETERS))
    local = np.zeros((assembly.maneuvers, N_LOCAL))
    local[:, 0], local[:, 1] = JET[0], JET[4]
    local[:, 2:4] = clean()[2][0]
    respond(assembly.grid, np.append(JET[[1, 2, 3, 5, 6, 7]], 0.0), local, y, g)
    for named in assembly.rows:
        for output, rows in named.items():
            part = g[rows] / spread[0 if output == "alpha" else 1]
            part[1:] = (part[1:] - memory * part[:-1]) / np.sqrt(1.0 - memory**2)
            g[rows] = part
    # White and of unit variance now: the influence's own covariance is the bound.
    found = influence(assembly, g, np.ones(4))
    assert found is not None
    return np.asarray(np.sum(found.rows**2, axis=0))


def table(rows: list[Row]) -> str:
    """The three tables in Markdown."""
    head = "| estimate | noise | " + " | ".join(PARAMETERS) + " |\n" + "|---|---|" + "---:|" * 8

    def line(row: Row, values: Array, scale: float, digits: int) -> str:
        name = "white" if row.memory == 0.0 else f"AR(1), φ = {row.memory:g}"
        return f"| {row.estimate} | {name} | " + " | ".join(f"{scale * v:.{digits}f}" for v in values) + " |"

    return "\n".join(
        [
            "Mean square error over the Cramér-Rao bound (for coloured noise the bound of an estimator that"
            " is told the colour):",
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
    parser.add_argument("--write", type=Path, help="rewrite the tables of this document")
    arguments = parser.parse_args()
    begin = time.process_time()
    rows = []
    for together, count in ((1, arguments.manoeuvres), (JOINT, arguments.manoeuvres)):
        for memory in MEMORIES:
            print(f"{together} x {count}, memory {memory} ...", file=sys.stderr)
            rows.append(study(count, memory, together))
    text = table(rows)
    failed = sum(row.failed for row in rows)
    text += f"\n\n{len(rows)} x {arguments.manoeuvres} estimates, {failed} without a result;"
    text += f" {time.process_time() - begin:.0f} s of CPU time."
    print(text)
    if arguments.write:
        document = arguments.write.read_text(encoding="utf-8")
        start, end = "<!-- accuracy: begin -->", "<!-- accuracy: end -->"
        before, after = document.split(start)[0], document.split(end)[1]
        arguments.write.write_text(f"{before}{start}\n{text}\n{end}{after}", encoding="utf-8")


if __name__ == "__main__":
    main()
