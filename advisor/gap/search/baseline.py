"""Where the search begins: the plain model fitted to the data without a guess from the user."""

from dataclasses import replace

import numpy as np

from advisor.aircraft import Aircraft
from advisor.flight.messages import FloatArray
from advisor.gap.candidates import input, moment, sensors, timing
from advisor.gap.candidates.catalogue import variants_for
from advisor.gap.candidates.known import stated_in, with_known
from advisor.gap.fitting.fit import Fitted, fit, rms_of
from advisor.gap.fitting.prior import ARMS
from advisor.gap.fitting.problem import Point, Problem
from advisor.gap.fitting.regression import regressions
from advisor.gap.fitting.whitening import Weighting
from advisor.gap.noise.quiet import loudness, whitening_of
from advisor.gap.noise.stamps import rates_of, stamp_jitter
from advisor.gap.records.flights import Flights
from advisor.gap.records.floor import stated_floor
from advisor.gap.search.command import read_command
from advisor.gap.search.screen import Screen
from advisor.gap.simulator.layout import DERIVATIVES, ENTRIES, INDEX, NUISANCES

_LOUD = 1.5
"""Power of what is left where nothing is flown, beside white noise, from which on it is asked what it is."""
_QUIETER = 0.7
"""Share of that power which a model with one effect more may leave there, to be believed for this."""
_AT_MOST = 2
"""Effects in that model."""
_MAIN = [DERIVATIVES.index(name) for name in ("Z_alpha", "M_alpha", "M_delta_e")]
"""Derivatives that a regression hardly ever misses by a factor of three ..."""
_ALIKE = 1.0 / 3.0
"""... so that within it the aircraft file's are the better start ..."""
_MUCH = 0.1
"""... unless the fit from there leaves this share of a channel's peak."""


def everywhere(point: Point, flights: Flights, latency_s: float = 0.0) -> Point:
    """The point with what is part of every model."""
    late = point.with_effect(input.LATENCY, (latency_s,))
    if flights.alpha_is_derived:
        filters = timing.filters(flights)
        late = late.with_effect(filters, (0.0,) * len(filters.names))
    if {"alpha", "a_z"} <= set(flights.channels):
        late = late.with_effect(sensors.TRUE_AIR_SPEED, (0.0,))
    return late.with_effect(moment.PROPELLER, (0.0, 0.0, 0.0)) if flights.speed_measured else late


def base_entries(aircraft: Aircraft) -> FloatArray:
    """Shape (entries,): what the aircraft file says lies between command and surface."""
    base = np.zeros(len(ENTRIES))
    base[INDEX["lag_s"]] = aircraft.elevator.lag_s or 0.0
    base[INDEX["delay_s"]] = aircraft.elevator.delay_s or 0.0
    base[INDEX["vane_arm_m"]] = aircraft.alpha.vane_arm_m or 0.0
    base[INDEX["imu_arm_m"]] = aircraft.accelerometer.arm_m or 0.0
    return base


def prior_derivatives(aircraft: Aircraft) -> FloatArray | None:
    """Shape (6,): what the aircraft file says of the derivatives; None unless it has them all."""
    if any(name not in aircraft.model for name in DERIVATIVES):
        return None
    return np.array([aircraft.model[name] for name in DERIVATIVES])


def arms_in(aircraft: Aircraft) -> frozenset[str]:
    """Effects whose arm the aircraft file states."""
    return frozenset(effect for effect in ARMS if stated_in(aircraft, effect) is not None)


def first_fit(problem: Problem, aircraft: Aircraft) -> Fitted:
    """The plain model fitted from the aircraft file's derivatives, or from a regression of the rates.

    The file's are nearer as a rule. But where a sign or a unit in it is wrong no step leads away from them:
    where the regression sees something else altogether, or the fit leaves much, all are tried.
    """
    flights = problem.flights
    own = np.zeros((len(flights), len(NUISANCES)))
    own[:, NUISANCES.index("Z_trim")] = [f.level_lift for f in flights.flights]

    def fitted_from(guess: FloatArray) -> Fitted:
        return fit(problem, everywhere(Point(guess, own), flights, latency_s=0.001))

    seen, prior = regressions(flights), prior_derivatives(aircraft)
    if prior is None:
        return min(map(fitted_from, seen), key=_finite_cost)
    fitted = fitted_from(prior.copy())
    agree = seen[-1][_MAIN] * prior[_MAIN] > _ALIKE * np.maximum(seen[-1][_MAIN] ** 2, prior[_MAIN] ** 2)
    if np.all(agree) and np.all(rms_of(problem, fitted.residuals) < _MUCH * flights.peaks):
        return fitted
    return min([fitted, *map(fitted_from, seen)], key=_finite_cost)


def _finite_cost(fitted: Fitted) -> float:
    return fitted.cost if np.isfinite(fitted.cost) else np.inf


def fit_baseline(flights: Flights, aircraft: Aircraft) -> tuple[Problem, Fitted]:
    """The plain model, with the noise this flight had and the command held or linear as the data decide."""
    instruments = stated_floor(flights)
    problem = Problem(
        flights,
        with_known(base_entries(aircraft), aircraft.effects, flights, variants_for(flights)),
        prior_derivatives=prior_derivatives(aircraft),
        arms_in_file=arms_in(aircraft),
        instruments=instruments,
        smallest_noise=0.5 * instruments,
    )
    fitted = first_fit(problem, aircraft)
    baseline, seen = fitted, quietest(problem, fitted)
    problem, fitted = read_command(*_filtered(problem, fitted, seen, first_look=True))
    if not problem.knows_the_noise:
        return problem, fitted
    # The noise is seen through a fit, and the fit made by the noise: the second round is the last.
    seen = fit(problem, seen.point, fitted.noise, iterations=8) if seen is not baseline else fitted
    return _filtered(problem, fitted, seen)


def at_another_speed(problem: Problem, fitted: Fitted, flights: Flights) -> tuple[Problem, Fitted]:
    """The plain model of the same flights at another air speed: noise and command are as they were."""
    again = replace(problem, flights=flights)
    return again, fit(again, fitted.point, fitted.noise)


def quietest(problem: Problem, fitted: Fitted) -> Fitted:
    """The model through which the noise is seen: with the likeliest effects in it, where that is quieter.

    What a missing effect makes of the motion dies down long after the last step, and would pass for noise
    with a memory; a right one takes it away, and none takes away what moves in still flight of itself.
    """
    best, loud = fitted, loudness(problem, fitted)
    for _ in range(_AT_MOST):
        if loud < _LOUD:
            break
        present = {variant.effect for variant in best.point.effects}
        # Of changes between manoeuvres the drift stands for all: what they leave dies down as fast as any.
        variants = [
            v for v in variants_for(problem.flights) if v.effect not in present and not v.comes_at_any_time
        ]
        likeliest = next(iter(Screen(problem, best, steps=1).try_all(variants, lambda _: 0.0)), None)
        if likeliest is None:
            break
        more = fit(problem, likeliest.point, likeliest.noise, iterations=8)
        before, loud = loud, loudness(problem, more)
        if loud > _QUIETER * before:
            break
        best = more
    return best


def _filtered(
    problem: Problem, fitted: Fitted, seen: Fitted, first_look: bool = False
) -> tuple[Problem, Fitted]:
    """The problem with the noise that is seen through one fit, and another fit made by it."""
    problem = replace(problem, jitter_s=stamp_jitter(problem, seen, rates_of(problem, seen)))
    whitening = whitening_of(problem, seen, first_look)
    if whitening is None or isinstance(whitening, Weighting):
        # A filter of the round before measured innovations in units of their own.
        assert problem.instruments is not None
        white = replace(problem, whitening=whitening, smallest_noise=0.5 * problem.instruments)
        return white, fit(white, fitted.point, problem.instruments, iterations=8)
    one = np.ones(len(problem.channels))
    filtered = replace(problem, whitening=whitening, smallest_noise=0.5 * one)
    return filtered, fit(filtered, fitted.point, one, iterations=8)
