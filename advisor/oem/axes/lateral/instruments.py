"""Servos and clocks of a lateral record as nuisance parameters of the fit, each with a prior.

The command takes effect up to half an interval and a filter's delay before or after its stamps. The attitude
may be late relative to the rates, and every delay is relative to the rates. A servo without a stated lag in
the aircraft file has an unknown lag. An ignored lag of 0.08 s costs a quarter of L_p and L_δa. A sideslip
vane ahead of the centre of gravity reads β + (x/V)·r. A vane treated as at the centre of gravity shifts N_r
by -N_β·x/V. The true air speed differs from the air speed that the sensor reads. Each unknown instrument
quantity is an additional parameter, whose error is part of every interval.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.instruments.lateness import lateness_std
from advisor.model.axes.lateral import LATERAL
from advisor.oem.axes.lateral.problem import SEEN, SPEED, LateralAssembly, LateralProblem
from advisor.oem.extra import Prior
from advisor.oem.instruments import FLAT, KNOWN_TO, PLACE_S, USUAL_LAG
from advisor.process.arrays import FloatArray

ANGLE_OF_ATTACK = Prior(0.0, 0.01)
"""Prior of the excess of the true over the read angle of attack, rad. An autopilot's own angle is 0.2 to 0.5
deg off, and a vane is mounted no better. With an angle of half a degree too much, rolling turns into sideslip
that no side force explains."""
AIR_SPEED = Prior(0.0, 0.02)
"""Prior of the relative excess of the true over the read air speed. The read speed may be an indicated one,
and a static port reads a pressure that the wing changes."""
LONGEST_LAG_S = 0.4
FIRST_LAG_S = 0.01
"""Starting value of an unknown lag in the search, s."""
LARGEST_MOVE_S = 0.03
"""Largest step of one nuisance parameter, s, for which the fit is nearly linear."""


EXCESSES: Mapping[str, str] = {"air": "airspeed_excess", "alpha": "alpha_excess_rad"}
"""Field of a problem with the excess of the true over the read value, by the kind of nuisance parameter."""
_FIELDS = {"arm": "beta_arm_m", "command": "command_delay_s", **EXCESSES}
"""Field of a problem with the parameter's value, by its kind."""


@dataclass(frozen=True, slots=True)
class Nuisance:
    """One nuisance parameter of a lateral fit, in s, or in m for an arm."""

    kind: Literal["lag", "delay", "command", "arm", "air", "alpha", "term"]
    """Kind of the parameter: servo lag, delay of one output or of all commands, or place of the sideslip
    vane. The kinds ``air`` and ``alpha`` are excesses of the true over the read air speed and angle of
    attack, and ``term`` is a coefficient that the user added."""
    of: str
    """Control, output or term that the parameter belongs to; empty for the commands."""
    prior: Prior
    per_second: float = 1.0
    """Parameter change that moves the outputs as one second does; for an arm, the air speed, m."""

    @property
    def name(self) -> str:
        """Name of the nuisance parameter with its unit."""
        if self.kind in ("term", *EXCESSES):
            return EXCESSES.get(self.kind, self.of)
        what = {"lag": "lag_s", "arm": "arm_m"}.get(self.kind, "delay_s")
        return f"{self.of or 'command'}_{what}"

    def read(self, problem: LateralProblem) -> float:
        """Return the parameter's value in a problem, s or m."""
        if self.kind == "lag":
            return problem.servos[self.of].lag_s
        if self.kind in _FIELDS:
            return float(getattr(problem, _FIELDS[self.kind]))
        return (problem.terms if self.kind == "term" else problem.delays_s).get(self.of, 0.0)

    def write(self, problem: LateralProblem, value: float) -> LateralProblem:
        """Return the problem with another value of the parameter, s or m; a lag stays within its range."""
        if self.kind == "lag":
            servo = replace(problem.servos[self.of], lag_s=float(np.clip(value, 0.0, LONGEST_LAG_S)))
            return replace(problem, servos={**problem.servos, self.of: servo})
        if self.kind == "term":
            return replace(problem, terms={**problem.terms, self.of: value})
        if self.kind == "delay":
            return replace(problem, delays_s={**problem.delays_s, self.of: value})
        changed: dict[str, Any] = {_FIELDS[self.kind]: value}
        return replace(problem, **changed)

    def moved(self, problem: LateralProblem, change: float) -> LateralProblem:
        """Return the problem with the parameter changed by at most ``LARGEST_MOVE_S``."""
        most = np.inf if self.kind == "term" else LARGEST_MOVE_S * self.per_second
        return self.write(problem, self.read(problem) + float(np.clip(change, -most, most)))


def nuisances_of(problem: LateralProblem, aircraft: Aircraft) -> tuple[Nuisance, ...]:
    """Return the nuisance parameters of a problem; an input that does not move has none."""
    moving = [name for name in LATERAL.inputs if problem.moves(name)]
    stamps = [record.inputs[name].t for record in problem.records for name in moving if name in record.inputs]
    open_ones = [Nuisance("command", "", Prior(0.0, lateness_std(stamps)))] if stamps else []
    for name in ("bank", "a_y", "beta"):
        measured = [record.outputs[name].t for record in problem.records if name in record.outputs]
        if measured:
            open_ones.append(Nuisance("delay", name, Prior(0.0, lateness_std(measured))))
            if name == "beta" and beta_arm_m(aircraft) is None:
                speed = float(np.mean([np.mean(record.airspeed.y) for record in problem.records]))
                open_ones.append(Nuisance("arm", name, Prior(0.0, PLACE_S * speed), speed))
    for name in moving:
        stated = getattr(aircraft, name).lag_s
        if stated != 0.0:
            open_ones.append(Nuisance("lag", name, Prior(stated, KNOWN_TO * stated) if stated else USUAL_LAG))
    if moving and problem.tells_force:
        open_ones += [Nuisance("air", "", AIR_SPEED), Nuisance("alpha", "", ANGLE_OF_ATTACK)]
    open_ones += [Nuisance("term", term, FLAT) for term in problem.terms]
    return tuple(open_ones)


def beta_arm_m(aircraft: Aircraft) -> float | None:
    """Return the stated distance of the sideslip vane ahead of the centre of gravity, m; None where unknown.

    A boom that carries both vanes has one distance.
    """
    return aircraft.alpha.vane_arm_m if aircraft.beta.vane_arm_m is None else aircraft.beta.vane_arm_m


def begun(problem: LateralProblem, nuisances: Sequence[Nuisance]) -> LateralProblem:
    """Return the problem at the start of the search: short unknown lags, other parameters at prior means.

    A servo lag and the roll mode have a similar effect on the roll rate. A search that starts from a long lag
    may exchange the lag and the roll mode.
    """
    for x in nuisances:
        problem = x.write(problem, FIRST_LAG_S if x.prior is USUAL_LAG else x.prior.mean)
    return problem


def columns_of(
    assembly: LateralAssembly, by: Mapping[str, FloatArray], motion: FloatArray,
    nuisances: Sequence[Nuisance], y: FloatArray,
) -> FloatArray:  # fmt: skip
    """Return the derivatives of the outputs by the nuisance parameters, shape (N, k).

    Parameters
    ----------
    by
        Derivatives (N,) of the outputs by ``OPEN``, ``CAUSES`` and added terms, which change the motion.
    motion
        Shape (E, 2, 4): states and their rates at the events, for the instruments of the outputs.
    y
        Shape (N,): simulated outputs.
    """
    columns, factors = np.zeros((len(assembly.z), len(nuisances))), assembly.grid.known
    for k, x in enumerate(nuisances):
        if x.kind in ("command", "lag", "term", *EXCESSES):
            columns[:, k] = by[x.name if x.kind in EXCESSES else x.of or "command"]
        elif x.of == "a_y":  # the outputs' rates have no rates of their own
            for rows in (named["a_y"] for named in assembly.rows if "a_y" in named):
                columns[rows, k] = -np.gradient(y[rows], assembly.t[rows], edge_order=2)
        else:
            output = LATERAL.outputs.index(x.of)
            row = assembly.grid.row[output]
            at, row = np.flatnonzero(row >= 0), row[row >= 0]
            terms = [(state, factor) for of, state, factor, number, _ in SEEN if of == output and number < 0]
            late = -sum(factors[at, factor] * motion[at, 1, state] for state, factor in terms)
            by_arm = motion[at, 0, LATERAL.states.index("r")] / factors[at, SPEED]
            columns[row, k] = late if x.kind == "delay" else by_arm
    return columns
