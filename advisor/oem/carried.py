"""Update of a solution with the newest samples of a manoeuvre, without solving the whole model again.

The model is solved over the new samples alone, from the state and the sensitivities at the end of the
solution. Each new sample adds to running sums, which give the next Gauss-Newton step and the errors. Every
refresh uses all samples. Air speed and turn rate of the path stay at their last values, so a complete
solution follows twice per second.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from advisor.aircraft.reference import PARAMETERS
from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.flight.maneuvers.maneuver import BEFORE_S, Maneuver
from advisor.flight.signals.motion import channel_at
from advisor.model.outputs import LOCAL, N_PARAMETERS, N_SHARED, OUTPUTS
from advisor.model.response import Grid, respond
from advisor.oem.covariance import REPORTED
from advisor.oem.estimate import ChannelFit, Estimate
from advisor.oem.prepare import Prepared
from advisor.oem.prior import precision
from advisor.oem.rows import STAMP_S, Measurements, Piece, Signal, events_of, lay_rows, padded
from advisor.oem.solution import Solution, noise_floor, reported
from advisor.oem.weighted_sums import Sums
from advisor.process.arrays import FloatArray

LONGEST_PROMISE = 2.0
"""Largest change of -2 log likelihood that a Gauss-Newton step may promise. Beyond this change the model is
solved again over all samples. Nine of ten updated estimates then lie within 0.17 standard deviations of the
complete ones (the first manoeuvre of ``logs/arduplane-calm.tlog``)."""
NEARLY_SINGULAR = 1e12
"""Largest sum of relative variances for a well-conditioned matrix. Above this sum rounding errors
dominate."""
_INITIAL = [N_SHARED + LOCAL.index(name) for name in ("alpha_initial", "q_initial", "theta_initial")]
_Q_BIAS = LOCAL.index("q_bias")
_EIGHT = np.array([i if is_shared else N_SHARED + i for is_shared, i in REPORTED])
_STATES = tuple(OUTPUTS.index(name) for name in ("alpha", "q", "theta"))


class _Step(NamedTuple):
    """A Gauss-Newton step from the parameters of the solution."""

    change: FloatArray
    """Shape (n,): step of the free parameters."""
    information: FloatArray
    """Shape (n, n): information of the samples."""
    inverse: FloatArray
    """Shape (n, n): inverse of the information of samples and prior."""
    promise: float
    """Promised change of -2 log likelihood by the step."""


class UpdatableSolution:
    """Solution of one manoeuvre that new samples can update.

    Parameters
    ----------
    solution
        Solution of one record, whose model was solved at the optimum.
    prepared
        Prepared record of the solution.
    reported
        Estimate that was reported for the solution.
    """

    def __init__(self, solution: Solution, prepared: Prepared, reported: Estimate) -> None:
        assembly, optimum = solution.assembly, solution.optimum
        self._solution, self._estimate = solution, reported
        self._held = prepared.alpha_held
        self._free = assembly.free
        self._floor = noise_floor(assembly)
        local = np.zeros(N_PARAMETERS - N_SHARED)
        self._prior = np.append(precision(solution.problem, optimum.shared), local)[self._free]
        self._place = np.append(optimum.shared, local)[self._free]
        self._end_s = max(float(assembly.t[rows][-1]) for rows in assembly.rows[0].values())
        self._state, self._sensitivities = _end(assembly.grid, optimum.shared, optimum.local)
        self._rows = {
            name: [(assembly.t[s], assembly.z[s], solution.fitted[s], solution.sensitivities[s])]
            for name, s in assembly.rows[0].items()
        }
        self._sums = {name: Sums.none(len(self._free), solution.noise.colours[name]) for name in self._rows}
        for name, ((_, z, y, g),) in self._rows.items():
            self._sums[name].add(np.ascontiguousarray(g[:, self._free]), z - y)

    def on(self, maneuver: Maneuver) -> Estimate | None:
        """Return the estimate with the newest samples; None if the model must be solved again."""
        new = {name: self._new(name, maneuver) for name in self._rows}
        stamps = np.concatenate([signal.t for signal in new.values()])
        goes_on = not len(stamps) or self._solve(maneuver, new, stamps)
        return self._stepped() if goes_on else None

    def _new(self, name: str, maneuver: Maneuver) -> Signal:
        """Return the new samples of an output. A repeated angle of attack is no new sample."""
        channel = maneuver.channels[name]
        last_s, last = self._rows[name][-1][0][-1], self._rows[name][-1][1][-1]
        late = channel.delay_s + (self._solution.problem.alpha_delay_s if name == "alpha" else 0.0)
        first = int(np.searchsorted(channel.t, last_s + late + STAMP_S))
        t, y = channel.t[first:] - late, channel.y[first:]
        keep = np.isfinite(y)
        if name == "alpha" and self._held:
            keep &= np.diff(y, prepend=last) != 0.0
        return Signal(t[keep], y[keep])

    def _solve(self, maneuver: Maneuver, new: Mapping[str, Signal], stamps: FloatArray) -> bool:
        """Solve the model over the new samples, and return whether that succeeded."""
        if not np.min(stamps) > self._end_s - STAMP_S:
            return False
        shared, local = self._solution.optimum.shared, self._solution.optimum.local.copy()
        local[0, [i - N_SHARED for i in _INITIAL]] = self._state
        laid, grid = self._grid(maneuver, new)
        y, g = np.empty(len(laid["z"])), np.empty((len(laid["z"]), N_PARAMETERS))
        if not respond(grid, shared, local, y, g):
            return False
        self._state, ends = _end(grid, shared, local)
        g, self._sensitivities = self._through(g), self._through(ends)
        self._end_s = float(np.max(stamps))
        for name, rows in laid["rows"][0].items():
            if len(y[rows]):
                self._rows[name].append((laid["t"][rows], laid["z"][rows], y[rows], g[rows]))
                self._sums[name].add(np.ascontiguousarray(g[rows][:, self._free]), laid["z"][rows] - y[rows])
        return True

    def _through(self, g: FloatArray) -> FloatArray:
        """Return the derivatives (k, 14) of the outputs by all parameters, from the derivatives by the first
        state."""
        whole = g.copy()
        whole[:, _INITIAL] = 0.0
        return np.asarray(whole + g[:, _INITIAL] @ self._sensitivities)

    def _grid(self, maneuver: Maneuver, new: Mapping[str, Signal]) -> tuple[Measurements, Grid]:
        """Return the new samples laid out for the kernel, starting at the end of the solution."""
        problem, last = self._solution.problem, self._solution.assembly.grid
        command = maneuver.command("elevator")
        begin = int(np.searchsorted(command.t, self._end_s - BEFORE_S))
        flown = command.t[begin:], command.y[begin:]
        signals = {"end": Signal(np.array([self._end_s]), np.empty(0)), **new}
        t = events_of(signals, [problem.servo.grid(flown[0])])
        laid = lay_rows([Piece(t, new, {})], OUTPUTS)
        gravity = np.full(len(t), last.gravity[-1])
        theta = maneuver.channels.get("theta")
        if problem.records[0].gravity_z is not None and theta is not None:
            attitude = np.interp(t, theta.t, theta.y)
            gravity = GRAVITY_M_S2 * np.cos(attitude) * np.cos(channel_at("bank", t, maneuver.channels))
        moved = problem.servo.course(*flown, t, problem.records[0].held)
        fields: dict[str, Any] = dict(zip(("elevator", "start", "slope"), moved, strict=True))
        for name in ("known", "vane", "airspeed", "acceleration"):
            fields[name] = np.full(len(t), getattr(last, name)[-1])
        return laid.measurements, last._replace(
            first=laid.first,
            kind=np.arange(len(t)),
            step_s=padded(np.diff(t)),
            ratio=np.full(len(t), last.ratio[last.kind[-1]]),
            row=laid.row,
            gravity=gravity,
            **fields,
        )

    def _stepped(self) -> Estimate | None:
        """Return the estimate after one Gauss-Newton step from the solution, with all samples."""
        optimum = self._solution.optimum
        first = self._step({name: float(optimum.noise[OUTPUTS.index(name)]) for name in self._sums})
        noise = {} if first is None else self._noise_after(first.change)
        step = None if first is None else self._step(noise)
        if step is None or not step.promise < LONGEST_PROMISE:
            return None
        moved = np.zeros(N_PARAMETERS)
        moved[self._free] = step.change
        rows = step.inverse[np.searchsorted(self._free, _EIGHT)]
        coloured = np.sum(
            [s.colour.variance / noise[name] ** 4 * s.coloured for name, s in self._sums.items()], axis=0
        )
        widening = self._solution.noise.widening[: len(PARAMETERS)]
        other = "alpha" if "alpha" in noise else "a_z"
        return replace(
            self._estimate,
            theta=reported(optimum.shared + moved[:N_SHARED], optimum.local + moved[N_SHARED:]),
            covariance_cr=rows @ step.information @ rows.T,
            covariance=rows @ coloured @ rows.T * np.outer(widening, widening),
            cost=(noise["q"] * noise[other]) ** 2,
            fits=({name: self._fit(name, moved, noise[name]) for name in self._rows},),
        )

    def _step(self, noise: Mapping[str, float]) -> "_Step | None":
        """Return the Gauss-Newton step for this noise of the outputs; None if nearly undetermined."""
        whole = np.sum([s.gram / noise[name] ** 2 for name, s in self._sums.items()], axis=0)
        information, gradient = whole[:-1, :-1], whole[:-1, -1]
        drawn = self._prior * self._place
        inverse = _inverse(information + np.diag(self._prior))
        if inverse is None:
            return None
        change = inverse @ (gradient - drawn)
        return _Step(change, information, inverse, float((gradient - drawn) @ change))

    def _noise_after(self, change: FloatArray) -> dict[str, float]:
        return {
            name: max(float(np.sqrt(s.power(change))), float(self._floor[OUTPUTS.index(name)]))
            for name, s in self._sums.items()
        }

    def _fit(self, name: str, moved: FloatArray, noise: float) -> ChannelFit:
        t, z, y, g = (np.concatenate(parts) for parts in zip(*self._rows[name], strict=True))
        return ChannelFit(name, t, z, y + g @ moved, noise)


def _end(grid: Grid, shared: FloatArray, local: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return α, q, θ at the last event, shape (3,), and their derivatives by all parameters, shape (3,
    14)."""
    row = np.full_like(grid.row, -1)
    row[list(_STATES), -1] = np.arange(len(_STATES))
    y, g = np.empty(len(_STATES)), np.empty((len(_STATES), N_PARAMETERS))
    respond(grid._replace(row=row, vane=np.zeros_like(grid.vane)), shared, local, y, g)
    y[1] -= local[0, _Q_BIAS]
    g[1, N_SHARED + _Q_BIAS] -= 1.0
    return y, g


def _inverse(information: FloatArray) -> FloatArray | None:
    """Return the inverse of a symmetric matrix; None if it is nearly singular."""
    diagonal = np.diag(information)
    if not np.all(diagonal > 0.0):
        return None
    scale = 1.0 / np.sqrt(diagonal)
    outer = np.outer(scale, scale)
    try:
        half = np.linalg.inv(np.linalg.cholesky(information * outer))
    except np.linalg.LinAlgError:
        return None
    inverse: FloatArray = half.T @ half
    return inverse * outer if np.trace(inverse) < NEARLY_SINGULAR else None
