"""Models of a lateral flight: one without effects and one for each effect."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from advisor.aircraft.aircraft import Aircraft, Estimation
from advisor.aircraft.reference import SIDE_PARAMETERS
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.gap.axes.lateral.effects import SideEffect
from advisor.gap.axes.lateral.fit import Fit, Free, Known, Point, fitted
from advisor.gap.axes.lateral.setting import AIR_SPEED, ANGLE_OF_ATTACK, COMMAND, Flown, Place
from advisor.gap.fitting.prior import ERROR_IF_WRONG
from advisor.model.axes.lateral import LATERAL, natural_size
from advisor.oem.axes.lateral.instruments import beta_arm_m, nuisances_of
from advisor.oem.axes.lateral.prepare import prepare_lateral
from advisor.oem.axes.lateral.problem import assemble_lateral
from advisor.oem.axes.lateral.start import lateral_start
from advisor.oem.estimate import NoEstimate
from advisor.oem.prepare import signal_of
from advisor.oem.prior import HELD
from advisor.process.arrays import FloatArray

SMALL_SHARE = 0.1
"""Prior: least size of a derivative for its relative error, over the derivative's natural size
(``natural_size``)."""
NATURAL_STEP = 1e-3
"""Numerical: finite-difference step of a natural delay (s) or arm (m)."""
_PLACES = {"command": COMMAND, "air": AIR_SPEED, "alpha": ANGLE_OF_ATTACK}
"""Place in a setting of each kind of nuisance parameter that belongs to no control or output."""
_ENTRIES = {"delay": "skew_s", "arm": "arm_m", "lag": "lag_s"}
"""Entry in a setting of each kind of nuisance parameter, by the kind's name."""


@dataclass(frozen=True, slots=True)
class Case:
    """One flight and one simulator, prepared for the fits."""

    flown: Flown
    theta: FloatArray
    """Shape (15,): derivatives of the simulator; those of the flight where the file states none."""
    stated: tuple[str, ...]
    """Derivatives that the aircraft file states and the flight determines."""
    natural: tuple[Free, ...]
    """Nuisance parameters of every model: delays of commands and outputs, and errors of stated lags."""
    begin: Point
    """Start of the fit without effects."""
    numbers: tuple[int, ...] = ()
    """Numbers of the manoeuvres."""
    fixed: Mapping[str, float] = field(default_factory=dict)
    """Derivatives that the user holds at a value, by name."""

    def prior_of(self, tolerance: float, free: Sequence[Free], share: float = 1.0) -> Known:
        """Return the prior of the derivatives, with relative error ``tolerance`` where stated, and of the
        parameters.

        ``share`` scales the prior's weight because the residuals are coloured.
        """
        sizes = natural_size(self.theta)
        size = np.array([sizes[name] for name in SIDE_PARAMETERS])
        scale = np.maximum(np.abs(self.theta), SMALL_SHARE * size)
        stated = np.array([name in self.stated for name in SIDE_PARAMETERS])
        std = np.concatenate([np.where(stated, tolerance * scale, size), [f.std for f in free]])
        mean = np.concatenate([self.theta, [f.mean for f in free]])
        for name, value in self.fixed.items():
            k = SIDE_PARAMETERS.index(name)
            mean[k], std[k] = value, HELD * max(abs(value), 1.0) / share
        return Known(mean, 1.0 / (share * std) ** 2)

    def fit(
        self, at: Point, free: Sequence[Free], tolerance: float = ERROR_IF_WRONG, share: float = 1.0
    ) -> Fit | None:
        """Return the fit from a start; ``tolerance`` is the relative error of the stated derivatives."""
        return fitted(self.flown, at, free, self.prior_of(tolerance, free, share))


def case_of(maneuvers: Sequence[Maneuver], aircraft: Aircraft, theta: FloatArray) -> Case | NoEstimate:
    """Return the flight and the simulator of an aircraft file; ``theta`` (15,) is the flight's estimate."""
    fixed = aircraft.estimation.held(SIDE_PARAMETERS)
    aircraft = replace(aircraft, estimation=Estimation())  # the prior holds what the user holds
    problem = prepare_lateral(maneuvers, aircraft)
    if isinstance(problem, NoEstimate):
        return problem
    throttle = tuple(
        signal_of(m.channels["throttle"]) if "throttle" in m.channels else None for m in maneuvers
    )
    setting: dict[Place, FloatArray] = {COMMAND: np.zeros(len(maneuvers))}
    natural = []
    for name in LATERAL.inputs:
        control = getattr(aircraft, name)
        for entry, value in (("lag_s", control.lag_s), ("delay_s", control.delay_s)):
            if value:
                setting[name, entry] = np.full(len(maneuvers), value)
    for name in filter(problem.flies, LATERAL.inputs):
        # Held or linear between two stamps: a rate limit begins with the first, a lag with their mean.
        stamps = np.concatenate([np.diff(r.inputs[name].t) for r in problem.records if name in r.inputs])
        stated_s = getattr(aircraft, name).delay_s or 0.0
        natural.append(Free((name, "delay_s"), 0.5 * float(np.median(stamps)), NATURAL_STEP, mean=stated_s))
    for x in nuisances_of(problem, aircraft):
        place = _PLACES.get(x.kind) or (x.of, _ENTRIES[x.kind])
        # A lag that the file leaves open is absent from the simulator: such a lag is an effect.
        if x.kind != "lag" or place in setting:
            natural.append(Free(place, x.prior.std, NATURAL_STEP * x.per_second, mean=x.prior.mean))
    free = assemble_lateral(problem).free
    stated = tuple(name for k, name in enumerate(SIDE_PARAMETERS) if name in aircraft.model and k in free)
    given = np.array([aircraft.model.get(n, v) for n, v in zip(SIDE_PARAMETERS, theta, strict=True)])
    begin = Point(theta, lateral_start(problem)[1], setting)
    flown = Flown(problem, throttle, beta_arm_m(aircraft) is not None)
    return Case(flown, given, stated, tuple(natural), begin, tuple(m.number for m in maneuvers), fixed)


def free_with(case: Case, effect: SideEffect, plain: Fit) -> tuple[Free, ...]:
    """Return the free parameters of a model with an effect, which replaces a nuisance parameter at its
    place."""
    variant = effect.variant
    kept = [f for f in free_near(case, plain) if f.place not in effect.places]
    columns = [None] * len(effect.places) if effect.columns is None else effect.columns.T
    base = base_of(case, effect)
    numbers = zip(effect.places, effect.std, variant.steps, variant.bounds, base, columns, strict=True)
    own = [
        Free(place, std, step, (min(low, low + at), high + at), at, column, column is not None)
        for place, std, step, (low, high), at, column in numbers
    ]
    return (*kept, *own)


def free_near(case: Case, plain: Fit) -> tuple[Free, ...]:
    """Return the free parameters of a model whose optimum is near the plain fit.

    Nuisance parameters keep the outputs' derivatives of the plain fit; parameters of known effects do not.
    """
    natural = {f.place for f in case.natural}
    return tuple(
        f._replace(column=plain.slopes[:, k] if f.place in natural else None)
        for k, f in enumerate(plain.free)
    )


def base_of(case: Case, effect: SideEffect) -> FloatArray:
    """Return the values that the simulator has at an effect's places."""
    setting = case.begin.setting
    return np.array([setting[place][0] if place in setting else 0.0 for place in effect.places])
