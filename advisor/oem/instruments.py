"""Instruments of a log as parameters: servo lag, command delay, and arm or delay of the vane.

A log holds the command, not the surface. An ignored servo lag of 0.14 s halves M_α and M_δe of a small
aircraft, while the fit still explains 95 % of the motion. A command that acts 10 ms after its stamps changes
M_q and M_δe by 7 to 19 %. A vane ahead of the centre of gravity reads α - (x/V)·q, and an autopilot's own
angle of attack is late. A delay of α and an arm change Z_α, Z_q, Z_δe and M_q without a worse fit of α and q.
With a_z and air speed the kinematics distinguish instrument and aircraft.

A moment that does not scale with V² is treated as one more nuisance parameter. If the air speed changes,
thrust with an arm about the centre of gravity would bias M_α, M_q and M_δe. The simulator of an autopilot has
such a moment as well.

Each unknown instrument quantity is an additional shared parameter of the fit (``instrument_fit``).
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from advisor.aircraft.added_term import parse_term
from advisor.aircraft.aircraft import Aircraft
from advisor.flight.instruments.delayed_fit import lateness_std
from advisor.oem.estimate import InstrumentEstimate
from advisor.oem.extra import Extra, Prior
from advisor.oem.instrument_columns import instrument_columns
from advisor.oem.known_instruments import FoundInstruments, InstrumentName, found_of
from advisor.oem.problem import Assembly, OutputErrorProblem
from advisor.process.arrays import FloatArray
from advisor.words.quantities import NORMAL_95

KNOWN_TO = 0.1
"""Relative standard deviation at which a value is known, and of a servo's lag in an aircraft file. An error
of a tenth of a usual servo lag moves M_δe by some 5 %, the default tolerance of a campaign."""
USUAL_LAG = Prior(0.05, 0.05)
"""Prior of a servo's lag that the aircraft file does not state, s. Servos of small aircraft have 0.03 to 0.15
s, and a measured surface has no lag."""
STEADY_MOMENT_RAD = 0.02
"""Standard deviation of the elevator deflection that balances the moments which do not scale with V², rad. A
change of power needs about one degree of trim. Between 0.005 and 0.08 rad no derivative of a business jet's
held step moves by a fiftieth of its interval. No derivative of the autopilots' tests leaves its interval."""
PLACE_S = 0.1
"""Standard deviation of an unknown vane or accelerometer arm, over the air speed, s. Recorded vanes have 0.01
to 0.11 s; the longest is a nose boom of 13 m at 130 m/s."""

FLAT = Prior(0.0, np.inf)
"""Prior of an unknown coefficient."""


@dataclass(frozen=True, slots=True)
class Instrument:
    """One instrument parameter of a problem."""

    name: InstrumentName
    resolution: float
    """Distance from a range's end at which the search has reached the end, in the parameter's unit."""
    lowest: float
    highest: float
    usual: Callable[[OutputErrorProblem], Prior]
    """Prior of the parameter if nobody has stated its value."""
    starts: tuple[float, ...] = ()
    """Additional starting values of the search."""
    known_to: float = 0.0
    """Relative standard deviation of a stated value."""
    prior: Prior | None = None
    stated: float | None = None
    """Value in the aircraft file, in the parameter's unit. None if the file does not state the value."""

    def read(self, problem: OutputErrorProblem) -> float:
        """Return the parameter's value in a problem. A delay of the command is relative to its linear motion
        between stamps."""
        if self.name == "servo_lag_s":
            return problem.servo.lag_s
        if self.name == "command_delay_s":
            return problem.servo.delay_s + _held_for(problem)
        return float(problem.terms[self.name] if self.name in problem.terms else getattr(problem, self.name))

    def write(self, problem: OutputErrorProblem, value: float) -> OutputErrorProblem:
        """Return the problem with another value of the parameter."""
        changed: dict[str, Any] = {self.name: value}
        if self.name == "servo_lag_s":
            changed = {"servo": replace(problem.servo, lag_s=value)}
        elif self.name == "command_delay_s":
            changed = {"servo": replace(problem.servo, delay_s=value - _held_for(problem))}
        elif self.name in problem.terms:
            changed = {"terms": {**problem.terms, self.name: value}}
        return replace(problem, **changed)

    def moved(self, problem: OutputErrorProblem, change: float) -> OutputErrorProblem:
        """Return the problem with the parameter changed, within its range."""
        return self.write(problem, float(np.clip(self.read(problem) + change, self.lowest, self.highest)))

    def open(self, problem: OutputErrorProblem) -> "Instrument":
        """Return the instrument with its usual prior."""
        return replace(self, prior=self.usual(problem))

    def at_end(self, problem: OutputErrorProblem, std: float) -> bool:
        """Return whether the value is within its standard deviation of an end of the range.

        A value at the end of its range is no estimate.
        """
        value = self.read(problem)
        return not self.lowest + self.resolution < value < self.highest - NORMAL_95 * std


def _held_for(problem: OutputErrorProblem) -> float:
    """Return the mean age of a held command, s."""
    if not problem.records[0].held:
        return 0.0
    return 0.5 * float(np.median(np.concatenate([np.diff(r.elevator.t) for r in problem.records])))


def _speed(problem: OutputErrorProblem) -> float:
    """Return the mean air speed in m/s; 0 without a measured air speed."""
    speeds = [float(np.mean(r.airspeed.y)) for r in problem.records if r.airspeed is not None]
    return float(np.mean(speeds)) if speeds else 0.0


def _command(problem: OutputErrorProblem) -> Prior:
    return Prior(COMMAND_DELAY.read(problem), lateness_std([record.elevator.t for record in problem.records]))


def _alpha(problem: OutputErrorProblem) -> Prior:
    stamps = [record.outputs["alpha"].t for record in problem.records]
    return Prior(problem.alpha_delay_s, lateness_std(stamps))


def _place(arm: str) -> Callable[[OutputErrorProblem], Prior]:
    return lambda problem: Prior(float(getattr(problem, arm)), PLACE_S * _speed(problem))


SERVO_LAG = Instrument("servo_lag_s", 1e-4, 0.0, 0.4, lambda _: USUAL_LAG, (0.0, 0.05, 0.1, 0.2), KNOWN_TO)
COMMAND_DELAY = Instrument("command_delay_s", 1e-4, -0.5, 1.0, _command)
VANE_ARM = Instrument("vane_arm_m", 1e-3, -100.0, 100.0, _place("vane_arm_m"))
ALPHA_DELAY = Instrument("alpha_delay_s", 1e-4, -0.3, 0.5, _alpha)
ACCELEROMETER_ARM = Instrument("accelerometer_arm_m", 1e-3, -100.0, 100.0, _place("accelerometer_arm_m"))
STEADY_MOMENT = Instrument(
    "steady_moment_rad", 1e-4, -0.5, 0.5, lambda problem: Prior(problem.steady_moment_rad, STEADY_MOMENT_RAD)
)
BY_NAME: Mapping[InstrumentName, Instrument] = {
    x.name: x for x in (SERVO_LAG, COMMAND_DELAY, VANE_ARM, ALPHA_DELAY, ACCELEROMETER_ARM, STEADY_MOMENT)
}


COUPLING = parse_term("M:p*r")
"""Moment of rolling with yawing, (I_zz - I_xx)/I_yy·p·r, in the model of inputs at once. Every body has
I_zz ≤ I_xx + I_yy, and an aircraft has I_xx ≤ I_zz. The factor therefore lies between 0 and 1 (Etkin & Reid,
Dynamics of Flight, 1996, ch. 4)."""
COUPLING_PRIOR = Prior(0.5, 12.0**-0.5)
"""Prior of the factor of ``COUPLING``: mean and standard deviation of a number between 0 and 1."""


def coefficient(term: str) -> Instrument:
    """Return the coefficient of a term, as one more parameter."""
    prior = COUPLING_PRIOR if term == COUPLING.name else FLAT
    return Instrument(term, 0.0, -np.inf, np.inf, lambda _: prior, prior=prior)


def knows_the_lag(lag: InstrumentEstimate | None) -> bool:
    """Return whether a servo's lag is estimated accurately enough for the aircraft."""
    return lag is not None and lag.name == SERVO_LAG.name and lag.std < KNOWN_TO * lag.value


def extra_of(
    problem: OutputErrorProblem,
    assembly: Assembly,
    shared: FloatArray,
    local: FloatArray,
    names: Sequence[Instrument],
) -> Extra:
    """Return the instruments as additional parameters of a fit; ``shared`` (7,), ``local`` (m, 7)."""
    if not names:
        return Extra.none(len(assembly.z))
    columns = instrument_columns(problem, assembly, shared, local, [x.name for x in names])
    return Extra.of(columns, problem, names)


def unknown_instruments(problem: OutputErrorProblem, aircraft: Aircraft) -> tuple[Instrument, ...]:
    """Return the instrument parameters that are estimated together with the derivatives.

    A vane and an accelerometer at one place describe the motion of that place. Instruments at the centre of
    gravity would describe the aircraft's motion equally well. One place must be known to determine the other
    place. Without a specific force only the priors determine the vane's place and delay.
    """
    instruments = found_of(aircraft)
    command = COMMAND_DELAY.open(problem)
    if instruments is not None:
        wanted = (command, *map(coefficient, problem.terms))
        return tuple(x for x in wanted if x.name not in instruments.names)
    unknown = [*map(coefficient, problem.terms)]
    unknown += [_stated_or_open(SERVO_LAG, aircraft.elevator.lag_s, problem), command]
    if problem.reference_airspeed_m_s is not None:
        unknown.append(STEADY_MOMENT.open(problem))
    measured = {name for record in problem.records for name in record.outputs}
    if "alpha" not in measured or _speed(problem) <= 0.0:
        return tuple(unknown)
    unknown.append(ALPHA_DELAY.open(problem))
    vane_m, imu_m = aircraft.alpha.vane_arm_m, aircraft.accelerometer.arm_m
    if vane_m is None and ("a_z" in measured or not problem.alpha_is_computed):
        unknown.append(VANE_ARM.open(problem))
    elif "a_z" in measured:
        place = ACCELEROMETER_ARM.open(problem) if imu_m is None else replace(VANE_ARM, stated=vane_m)
        unknown.append(place)
    return tuple(unknown)


def _stated_or_open(x: Instrument, stated: float | None, problem: OutputErrorProblem) -> Instrument:
    """Return the instrument with its usual prior, about the stated value if there is one."""
    usual = x.usual(problem)
    return replace(x, stated=stated, prior=usual if stated is None else replace(usual, mean=stated))


def as_found(problem: OutputErrorProblem, given: FoundInstruments | None) -> OutputErrorProblem:
    """Return the problem with the instruments that several manoeuvres determined together."""
    for name, value in zip(given.names, given.values, strict=True) if given is not None else ():
        if name in BY_NAME or name in problem.terms:
            problem = (BY_NAME.get(name) or coefficient(name)).write(problem, float(value))
    return problem
