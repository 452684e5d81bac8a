"""Models of a flight: one without effects and one for each effect."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from advisor.aircraft.aircraft import Aircraft, Estimation
from advisor.flight.instruments.kinematics import KinematicCheck
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.gap.axis.effects import AxisEffect
from advisor.gap.axis.fit import Fit, Known, Point, fitted
from advisor.gap.axis.setting import Flown, Setting
from advisor.gap.candidates.known import REACH
from advisor.gap.fitting.prior import ERROR_IF_WRONG
from advisor.gap.records.floor import SMOOTH, TOLERANCE
from advisor.gap.records.smoothness import white_part
from advisor.model.axis import Axis
from advisor.oem.axis.parameter import Parameter, parameters_of, stated_arm_m
from advisor.oem.axis.prepare import prepare
from advisor.oem.axis.problem import COMMAND, AxisProblem, lay_out
from advisor.oem.axis.start import starting_point
from advisor.oem.estimate import NoEstimate
from advisor.oem.extra import Prior
from advisor.oem.prepare import signal_of
from advisor.oem.prior import HELD
from advisor.process.arrays import FloatArray

NATURAL_STEP = 1e-3
"""Numerical: finite-difference step of a natural delay, s, where the simulation gives no derivative."""
_ANYWHERE = (-np.inf, np.inf)


@dataclass(frozen=True, slots=True)
class Case:
    """One flight and one simulator, prepared for the fits."""

    flown: Flown
    theta: FloatArray
    """Shape (s,): derivatives of the simulator; those of the flight where the file states none."""
    stated: tuple[str, ...]
    """Derivatives that the aircraft file states and the flight determines."""
    natural: tuple[Parameter, ...]
    """Nuisance parameters of every model: delays of commands and outputs, and errors of stated lags."""
    begin: Point
    """Start of the fit without effects."""
    numbers: tuple[int, ...] = ()
    """Numbers of the manoeuvres."""
    fixed: Mapping[str, float] = field(default_factory=dict)
    """Derivatives that the user holds at a value, by name."""
    kinematics: KinematicCheck | None = None
    """Check of a measured angle of attack against the motion; None without such an angle."""

    @property
    def axis(self) -> Axis:
        """Axis of the flight."""
        return self.flown.axis

    def prior_of(self, tolerance: float, free: Sequence[Parameter], share: float = 1.0) -> Known:
        """Return the prior of the derivatives, with relative error ``tolerance`` where stated, and of the
        parameters.

        ``share`` scales the prior's weight because the residuals are coloured.
        """
        names, sizes = self.axis.names.reported, self.axis.natural_size(self.theta)
        size = np.array([sizes[name] for name in names])
        scale = np.maximum(np.abs(self.theta), self.axis.relative_to * size)
        stated = np.array([name in self.stated for name in names])
        std = np.concatenate([np.where(stated, tolerance * scale, size), [f.prior.std for f in free]])
        mean = np.concatenate([self.theta, [f.prior.mean for f in free]])
        for name, value in self.fixed.items():
            k = names.index(name)
            mean[k], std[k] = value, HELD * max(abs(value), 1.0) / share
        return Known(mean, 1.0 / (share * std) ** 2)

    def fit(
        self, at: Point, free: Sequence[Parameter], tolerance: float = ERROR_IF_WRONG, share: float = 1.0
    ) -> Fit | None:
        """Return the fit from a start; ``tolerance`` is the relative error of the stated derivatives."""
        return fitted(self.flown, at, free, self.prior_of(tolerance, free, share), share)


def case_of(
    axis: Axis, maneuvers: Sequence[Maneuver], aircraft: Aircraft, theta: FloatArray
) -> Case | NoEstimate:
    """Return the flight and the simulator of an aircraft file; ``theta`` (s,) is the flight's estimate."""
    names = axis.names.reported
    fixed = aircraft.estimation.held(names)
    aircraft = replace(aircraft, estimation=Estimation())  # the prior holds what the user holds
    problem = prepare(axis, maneuvers, aircraft)
    if isinstance(problem, NoEstimate):
        return problem
    throttle = tuple(
        signal_of(m.channels["throttle"]) if "throttle" in m.channels else None for m in maneuvers
    )
    stated = {place: value for place, value in problem.values.items() if value}
    setting = {place: np.full(len(maneuvers), value) for place, value in {COMMAND: 0.0, **stated}.items()}
    natural = _natural(problem, aircraft, setting)
    free = lay_out(problem).free
    determined = tuple(name for k, name in enumerate(names) if name in aircraft.model and k in free)
    given = np.array([aircraft.model.get(n, v) for n, v in zip(names, theta, strict=True)])
    begin = Point(theta, starting_point(problem)[1], setting)
    arm_is_stated = any(stated_arm_m(name, aircraft) is not None for name in axis.arms)
    problem = replace(problem, floor=floor_of(problem))
    about = dict(zip(names, theta.tolist(), strict=True))
    flown = Flown(problem, throttle, arm_is_stated, about)
    return Case(flown, given, determined, tuple(natural), begin, tuple(m.number for m in maneuvers), fixed)


def _natural(problem: AxisProblem, aircraft: Aircraft, setting: Setting) -> list[Parameter]:
    """Return the nuisance parameters of every model of a flight."""
    axis, natural = problem.axis, []
    for name in filter(problem.flies, axis.inputs):
        # Held or linear between two stamps: a rate limit begins with the first, a lag with their mean.
        stamps = np.concatenate([np.diff(r.inputs[name].t) for r in problem.records if name in r.inputs])
        prior = Prior(problem.at((name, "delay_s")), 0.5 * float(np.median(stamps)))
        natural.append(Parameter((name, "delay_s"), prior, step=NATURAL_STEP))
    # A lag that the file leaves open is absent from the simulator: such a lag is an effect.
    natural += [
        replace(x, most=np.inf, bounds=_ANYWHERE, step=NATURAL_STEP)
        for x in parameters_of(problem, aircraft)
        if x.entry != "lag_s" or x.place in setting
    ]
    natural = list(_of_one_control(problem, natural)) if len(axis.inputs) == 1 else natural
    own = {x.place: x for x in _filters(problem)}
    return [x for x in natural if x.place not in own] + [*own.values()]


def _of_one_control(problem: AxisProblem, natural: Sequence[Parameter]) -> Iterator[Parameter]:
    """Yield the natural parameters of an axis with one control, whose delay is that of all commands."""
    axis = problem.axis
    common = next((x.prior.std for x in natural if x.place == COMMAND), 0.0)
    # The filters of gyro and accelerometer delay both behind the command; with a vane that is no mere clock.
    late = 0.0 if problem.is_computed else REACH * max(axis.filters.values(), default=0.0)
    for x in natural:
        if x.place == COMMAND or (axis.arms_are_causes and x.entry == "arm_m"):
            continue
        if x.place[0] in axis.inputs and x.entry == "delay_s":
            at = x.prior.mean
            prior = Prior(at, float(np.hypot(common, late)))
            x = replace(x, prior=prior, bounds=(at - common, at + common + late))
        yield x


def _filters(problem: AxisProblem) -> Iterator[Parameter]:
    """Yield the delays by an autopilot's filters, and the instrument of an angle that the autopilot
    computes."""
    axis = problem.axis
    measured = set.intersection(*(set(record.outputs) for record in problem.records))
    for of, std in axis.filters.items():
        if of in measured:
            yield Parameter((of, "delay_s"), Prior(0.0, std), bounds=(-REACH * std, REACH * std), step=1e-3)
        if axis.hidden in measured and not problem.is_computed:
            # A vane passes no filter of gyro and accelerometer, so that its angle is early beside theirs.
            place = (axis.hidden, "delay_s")
            yield Parameter(place, Prior(0.0, std), bounds=(-REACH * std, 0.0), step=1e-3)
    if problem.is_computed:
        for place, (std, bounds) in axis.computed.items():
            yield Parameter(place, Prior(0.0, std), bounds=bounds, step=0.01)


def floor_of(problem: AxisProblem) -> Mapping[str, float]:
    """Return the noise that is assumed in outputs filtered before storage: 2 % of the output's peak.

    Differences of raw samples show the white noise of an instrument, unless the record was filtered.
    """
    if not problem.axis.computed:
        return {}
    floor = {}
    for name in set.intersection(*(set(record.outputs) for record in problem.records)):
        series = [record.outputs[name].y for record in problem.records]
        peak = float(np.median([np.max(np.abs(y - np.median(y[: max(5, len(y) // 50)]))) for y in series]))
        white = white_part(series)
        own = name == problem.axis.hidden and problem.is_computed
        floor[name] = TOLERANCE * peak if own or white < SMOOTH * peak else white
    return floor


def free_with(case: Case, effect: AxisEffect, plain: Fit) -> tuple[Parameter, ...]:
    """Return the free parameters of a model with an effect, which replaces a nuisance parameter at its
    place."""
    variant = effect.variant
    kept = [f for f in free_near(case, plain) if f.place not in effect.places]
    columns = [None] * len(effect.places) if effect.columns is None else effect.columns.T
    base = base_of(case, effect)
    numbers = zip(effect.places, effect.std, variant.steps, variant.bounds, base, columns, strict=True)
    own = [
        Parameter(
            place, Prior(at, std), np.inf, (min(low, low + at), high + at), step, column, column is not None
        )
        for place, std, step, (low, high), at, column in numbers
    ]
    return (*kept, *own)


def free_near(case: Case, plain: Fit) -> tuple[Parameter, ...]:
    """Return the free parameters of a model whose optimum is near the plain fit.

    Nuisance parameters keep the outputs' derivatives of the plain fit; parameters of known effects do not.
    """
    natural = {f.place for f in case.natural}
    return tuple(
        f if f.adds else replace(f, column=plain.slopes[:, k] if f.place in natural else None)
        for k, f in enumerate(plain.free)
    )


def base_of(case: Case, effect: AxisEffect) -> FloatArray:
    """Return the values that the simulator has at an effect's places."""
    setting = case.begin.setting
    return np.array([setting[place][0] if place in setting else 0.0 for place in effect.places])
