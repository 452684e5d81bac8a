"""Servos, clocks and sensors of a record as nuisance parameters of the fit, each with a prior.

The command takes effect up to half an interval and a filter's delay before or after its stamps. Outputs may
be late relative to the rates, and every delay is relative to the rates. A servo without a stated lag in the
aircraft file has an unknown lag, because an ignored lag of 0.08 s costs a quarter of L_p and L_δa. A
sideslip vane ahead of the centre of gravity reads β + (x/V)·r. Without its arm N_r would be wrong by
-N_β·x/V. The true air speed differs from the air speed that the sensor reads. Each unknown property of an
instrument is an additional parameter, whose error is part of every interval.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Protocol, Self, TypeVar

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.instruments.delayed_fit import lateness_std
from advisor.model.axis import Place
from advisor.oem.axis.problem import COMMAND, TERM, AxisProblem, AxisRecord
from advisor.oem.extra import Prior
from advisor.oem.instruments import FLAT, KNOWN_TO, PLACE_S, USUAL_LAG
from advisor.oem.rows import Signal
from advisor.process.arrays import FloatArray

LONGEST_LAG_S = 0.4
FIRST_LAG_S = 0.01
"""Starting value of an unknown lag in the search, s."""
LARGEST_MOVE_S = 0.03
"""Largest step of one nuisance parameter, s, for which the fit is nearly linear."""
_NO_BOUNDS = (-np.inf, np.inf)


class Valued(Protocol):
    """A problem with values of instruments by their place."""

    def at(self, place: Place, /) -> float:
        """Return the value at a place."""

    def having(self, place: Place, value: float, /) -> Self:
        """Return the problem with another value at a place."""


P = TypeVar("P", bound=Valued)


@dataclass(frozen=True, slots=True)
class Parameter:
    """One number of servos, clocks or sensors that a fit estimates, in the unit at the end of its name."""

    place: Place
    """Control, output, signal or term that the number belongs to, and its entry."""
    prior: Prior
    most: float = np.inf
    """Largest change in one step of the search."""
    bounds: tuple[float, float] = _NO_BOUNDS
    step: float = 0.0
    """Step of a finite difference, where the simulation gives no derivative by the number."""
    column: FloatArray | None = field(default=None, compare=False)
    """Shape (N,): known derivative of the outputs by the number."""
    adds: bool = False
    """Whether the number adds its column to the simulated outputs, so that no simulation uses it."""

    @property
    def entry(self) -> str:
        """Property of the instrument: ``lag_s``, ``delay_s``, ``arm_m``."""
        return self.place[1]

    @property
    def name(self) -> str:
        """Name of the number with its unit; the text of a term."""
        return self.entry if self.place[0] == TERM else "_".join(self.place)

    def read(self, problem: Valued) -> float:
        """Return the number's value in a problem."""
        return problem.at(self.place)

    def write(self, problem: P, value: float) -> P:
        """Return the problem with another value of the number, within its bounds."""
        return problem.having(self.place, float(np.clip(value, *self.bounds)))

    def moved(self, problem: P, change: float) -> P:
        """Return the problem with the number changed by at most ``most``."""
        return self.write(problem, self.read(problem) + float(np.clip(change, -self.most, self.most)))


def stated_arm_m(output: str, aircraft: Aircraft) -> float | None:
    """Return the stated distance of an output's vane ahead of the centre of gravity, m; None where unknown.

    A boom that carries both vanes has one distance.
    """
    arm: float | None = getattr(aircraft, output).vane_arm_m
    return aircraft.alpha.vane_arm_m if arm is None else arm


def parameters_of(problem: AxisProblem, aircraft: Aircraft) -> tuple[Parameter, ...]:
    """Return the nuisance parameters of a problem; an input that does not move has none."""
    return tuple(_parameters(problem, aircraft))


def _parameters(problem: AxisProblem, aircraft: Aircraft) -> Iterator[Parameter]:
    axis, records = problem.axis, problem.records
    moving = [name for name in axis.inputs if problem.moves(name)]
    commands = [r.inputs[name] for r in records for name in moving if name in r.inputs]
    if commands:
        yield _clock(COMMAND, commands)
    for name in axis.clocks:
        if measured := [r.outputs[name] for r in records if name in r.outputs]:
            yield _clock((name, "delay_s"), measured)
            if name in axis.arms and stated_arm_m(name, aircraft) is None and not problem.is_computed:
                # An arm moves the outputs by a second's turn as the air speed does.
                speed = problem.mean_airspeed_m_s
                yield Parameter((name, "arm_m"), Prior(0.0, PLACE_S * speed), LARGEST_MOVE_S * speed)
    for name in moving:
        stated = getattr(aircraft, name).lag_s
        if stated != 0.0:
            prior = Prior(stated, KNOWN_TO * stated) if stated else USUAL_LAG
            yield Parameter((name, "lag_s"), prior, LARGEST_MOVE_S, (0.0, LONGEST_LAG_S))
    for place, moment in axis.moments.items():
        if np.isfinite(moment.std) and all(moves_in(r, moment.signals) for r in records):
            yield Parameter(place, Prior(moment.mean, moment.std))
    if moving and problem.tells_force:
        yield from (Parameter(at, Prior(0.0, std), LARGEST_MOVE_S) for at, std in axis.errors.items())
    yield from (Parameter((TERM, term), FLAT) for term in problem.terms)


def moves_in(record: AxisRecord, signals: Sequence[str]) -> bool:
    """Return whether a record has signals whose product moves."""
    return all(name in record.signals and np.ptp(record.signals[name].y) > 0.0 for name in signals)


def _clock(place: Place, signals: Sequence[Signal]) -> Parameter:
    return Parameter(place, Prior(0.0, lateness_std([signal.t for signal in signals])), LARGEST_MOVE_S)


def begun(problem: AxisProblem, parameters: Sequence[Parameter]) -> AxisProblem:
    """Return the problem at the start of the search: short unknown lags, other parameters at prior means.

    A servo lag and the roll mode have a similar effect on the roll rate. A search that starts from a long lag
    may exchange the lag and the roll mode.
    """
    for x in parameters:
        problem = x.write(problem, FIRST_LAG_S if x.prior is USUAL_LAG else x.prior.mean)
    return problem
