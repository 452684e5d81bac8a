"""Start of the search: the baseline model, fitted without a guess from the user."""

from dataclasses import replace

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.gap.candidates import known
from advisor.gap.candidates.known import base_entries, changes_in, lasting, variants_for, with_known
from advisor.gap.effects.actuator_lag import LAG
from advisor.gap.effects.transport_delay import DELAY
from advisor.gap.fitting.fit import EffectFit, evidence_of, fit, rms_of
from advisor.gap.fitting.neighbourhood import Neighbourhood
from advisor.gap.fitting.problem import EffectProblem, SearchPoint, counts
from advisor.gap.fitting.regression import regressions
from advisor.gap.fitting.whitening import Weighting
from advisor.gap.noise.quiet import loudness, whitening_of
from advisor.gap.noise.stamps import rates_of, stamp_jitter
from advisor.gap.records.flights import PreparedManeuvers
from advisor.gap.records.floor import stated_floor
from advisor.gap.search.screen import Screen
from advisor.gap.simulator.layout import DERIVATIVES, NUISANCES
from advisor.process.arrays import FloatArray

_SLIGHT_S = 0.005
"""Numerical: starting value of a delay or lag in its fit, s."""


def read_command(linear: EffectProblem, fitted: EffectFit) -> tuple[EffectProblem, EffectFit]:
    """Return the baseline model with the command held or linear between stamps, whichever the data favour.

    A held command looks like a linear one with a delay of half an interval. The linear command may have a
    delay and a lag, at their price (Schwarz). The held command is chosen if it explains more without a delay
    and a lag. Otherwise half an interval is added to the delay's error.
    """
    best = min(Screen(linear, fitted).quick_fits((DELAY, LAG)), key=lambda s: s.cost, default=None)
    if best is None:
        return linear, fitted
    other = LAG if best.variant is DELAY else DELAY
    held, plainly_held = read_otherwise(linear, fitted)
    as_linear, as_held = evidence_of(linear, fitted), evidence_of(held, plainly_held)
    price = float(np.log(np.sum(counts(linear))))
    if as_linear <= as_held and fitted.cost - best.cost < 2.0 * price:
        return linear, fitted
    late = fit(linear, best.point.with_effect(other, (_SLIGHT_S,)), best.noise, 8)
    is_held = as_held < min(as_linear, evidence_of(linear, late) + 2.0 * price)
    return (held, plainly_held) if is_held else (linear, fitted)


def read_otherwise(problem: EffectProblem, fitted: EffectFit) -> tuple[EffectProblem, EffectFit]:
    """Return the baseline model with the other motion of the command: held instead of linear, or the
    reverse."""
    other = replace(problem, held=not problem.held)
    return other, fit(other, fitted.point, fitted.noise)


_QUIETER = 0.7
"""Largest ratio of the quiet residual's power with an effect to that without, for the effect to be kept."""
_MAIN = [DERIVATIVES.index(name) for name in ("Z_alpha", "M_alpha", "M_delta_e")]
"""Indices of the derivatives that a regression hardly ever misses by a factor of three."""
_ALIKE = 1.0 / 3.0
"""Numerical: least ratio of Z_α, M_α and M_δe between regression and aircraft file, above which the file's
derivatives are the only start."""
_MUCH = 0.1
"""Numerical: largest residual of the fit from the file's derivatives for which no other start is tried."""


def everywhere(point: SearchPoint, flights: PreparedManeuvers, latency_s: float = 0.0) -> SearchPoint:
    """Return the point with all nuisance parameters that are part of every model.

    The latency is one loop of the autopilot; ``with_telemetry`` widens it after the command's motion is
    known.
    """
    late = point.with_effect(known.LOOP, (latency_s,)).with_effect(known.GYRO, (0.0,))
    if flights.alpha_is_derived:
        own = known.filters(flights)
        late = late.with_effect(own, (0.0,) * len(own.names))
        late = late.with_effect(known.OWN_ALPHA, (0.0, 0.0))
    elif {"alpha", "theta"} & set(flights.channels):
        late = late.with_effect(known.IMU, (0.0,))
    if "a_z" in flights.channels:
        late = late.with_effect(known.AIRSPEED, (0.0,))
    if known.rolls(flights):
        late = late.with_effect(known.INERTIA, (0.0, 0.0))
    return late.with_effect(known.PROPELLER, (0.0, 0.0, 0.0)) if flights.speed_measured else late


def with_telemetry(point: SearchPoint, flights: PreparedManeuvers) -> SearchPoint:
    """Return the point with the delay that telemetry may cause between command stamps and effect."""
    effects = tuple(known.latency(flights) if e is known.LOOP else e for e in point.effects)
    return replace(point, effects=effects)


def fit_telemetry(problem: EffectProblem, fitted: EffectFit, noise: FloatArray) -> EffectFit:
    """Return the fit with the telemetry's delay, started from the present fit and from both ends of the
    prior.

    Edges of the command move with the delay, so the cost has local minima.
    """
    point = with_telemetry(fitted.point, problem.flights)
    k = point.index_of(known.LOOP.effect)
    best = fit(problem, point, noise)
    for start in point.effects[k].bounds[0]:
        values = (*point.values[:k], np.array([start]), *point.values[k + 1 :])
        other = fit(problem, replace(point, values=values), noise, beaten_by=best.cost)
        best = min(best, other, key=_finite_cost)
    return best


def prior_derivatives(aircraft: Aircraft) -> FloatArray | None:
    """Return the aircraft file's derivatives, shape (6,); None if a derivative is missing."""
    if any(name not in aircraft.model for name in DERIVATIVES):
        return None
    return np.array([aircraft.model[name] for name in DERIVATIVES])


def first_fit(problem: EffectProblem, aircraft: Aircraft) -> EffectFit:
    """Return the baseline model, fitted from the aircraft file's derivatives or from a regression of rates.

    The file's derivatives are usually nearer to the optimum. If a sign or a unit in the file is wrong, no
    step leads away from the file's derivatives. All starts are tried if the regression differs strongly, or
    if the fit leaves a large residual.
    """
    flights = problem.flights
    own = np.zeros((len(flights), len(NUISANCES)))
    own[:, NUISANCES.index("Z_trim")] = [f.level_lift for f in flights.flights]

    def fitted_from(guess: FloatArray) -> EffectFit:
        return fit(problem, everywhere(SearchPoint(guess, own), flights, latency_s=0.001))

    seen, prior = regressions(flights), prior_derivatives(aircraft)
    if prior is None:
        return min(map(fitted_from, seen), key=_finite_cost)
    fitted = fitted_from(prior.copy())
    agree = seen[-1][_MAIN] * prior[_MAIN] > _ALIKE * np.maximum(seen[-1][_MAIN] ** 2, prior[_MAIN] ** 2)
    if np.all(agree) and np.all(rms_of(problem, fitted.residuals) < _MUCH * flights.peaks):
        return fitted
    return min([fitted, *map(fitted_from, seen)], key=_finite_cost)


def _finite_cost(fitted: EffectFit) -> float:
    return fitted.cost if np.isfinite(fitted.cost) else np.inf


def fit_unfiltered(flights: PreparedManeuvers, aircraft: Aircraft) -> tuple[EffectProblem, EffectFit]:
    """Return the baseline model with white noise, and with the command linear between its stamps."""
    instruments, variants = stated_floor(flights), variants_for(flights)
    problem = EffectProblem(
        flights,
        with_known(base_entries(aircraft), aircraft.effects, flights, variants),
        changes=changes_in(aircraft.effects, variants),
        prior_derivatives=prior_derivatives(aircraft),
        fixed=aircraft.estimation.held(DERIVATIVES),
        instruments=instruments,
        smallest_noise=0.5 * instruments,
    )
    return problem, _at_rest(problem, first_fit(problem, aircraft), aircraft)


def _at_rest(problem: EffectProblem, fitted: EffectFit, aircraft: Aircraft) -> EffectFit:
    """Return the fit with the side on which the file's play rests at the start of each manoeuvre."""
    for variant in variants_for(problem.flights):
        if variant.sides is not None and variant.effect in aircraft.effects:
            point = Neighbourhood(problem, fitted).choose_sides(fitted.point, variant.sides[1])
            return min(fitted, fit(problem, point, fitted.noise), key=_finite_cost)
    return fitted


def of_this_flight(flights: PreparedManeuvers, aircraft: Aircraft) -> Aircraft:
    """Return the aircraft without the file's changes in flight, if these manoeuvres are likelier without
    them.

    A change in flight belongs to one flight. An aircraft file that this flight improved already contains the
    change.
    """
    others = replace(aircraft, effects=lasting(aircraft.effects))
    if others == aircraft:
        return aircraft
    return min((others, aircraft), key=lambda file: _finite_cost(fit_unfiltered(flights, file)[1]))


def fit_baseline(flights: PreparedManeuvers, aircraft: Aircraft) -> tuple[EffectProblem, EffectFit]:
    """Return the baseline model with the noise of this flight, and with the command held or linear."""
    problem, fitted = fit_unfiltered(flights, aircraft)
    baseline, seen = fitted, quietest(problem, fitted)
    problem, fitted = read_command(*_filtered(problem, fitted, seen, first_look=True))
    fitted = fit_telemetry(problem, fitted, fitted.noise)
    if not problem.knows_the_noise:
        return problem, fitted
    # The noise is estimated through a fit, and the fit uses the noise: the second round is the last.
    seen = fit_telemetry(problem, seen, fitted.noise) if seen is not baseline else fitted
    return _filtered(problem, fitted, seen)


def at_another_speed(
    problem: EffectProblem, fitted: EffectFit, flights: PreparedManeuvers
) -> tuple[EffectProblem, EffectFit]:
    """Return the baseline model of the flights at another air speed, with noise and command unchanged."""
    again = replace(problem, flights=flights)
    return again, fit(again, fitted.point, fitted.noise)


def quietest(problem: EffectProblem, fitted: EffectFit) -> EffectFit:
    """Return the model for the noise estimate, with likely effects that make the quiet residual smaller.

    Motion from a missing effect decays long after the last step, and would look like coloured noise. The
    right effect removes the decaying motion, but no motion that occurs in still flight.
    """
    best, loud = fitted, loudness(problem, fitted)
    # No effect removes the instruments' noise, whose power is 1.
    while _QUIETER * loud >= 1.0:
        present = {variant.effect for variant in best.point.effects}
        # The drift represents all changes between manoeuvres, because their residuals decay equally fast.
        variants = [
            v for v in variants_for(problem.flights) if v.effect not in present and not v.comes_at_any_time
        ]
        likeliest = Screen(problem, best, steps=1).likeliest(variants)
        if likeliest is None:
            break
        more = fit(problem, likeliest.point, likeliest.noise, iterations=8)
        before, loud = loud, loudness(problem, more)
        if loud > _QUIETER * before:
            break
        best = more
    return best


def _filtered(
    problem: EffectProblem, fitted: EffectFit, seen: EffectFit, first_look: bool = False
) -> tuple[EffectProblem, EffectFit]:
    """Return the problem with the noise estimated through ``seen``, and a fit with that noise."""
    problem = replace(problem, jitter_s=stamp_jitter(problem, seen, rates_of(problem, seen)))
    whitening = whitening_of(problem, seen, first_look)
    if whitening is None or isinstance(whitening, Weighting):
        # The filter of the round before gave innovations in units of their own standard deviation.
        assert problem.instruments is not None
        white = replace(problem, whitening=whitening, smallest_noise=0.5 * problem.instruments)
        return white, fit(white, fitted.point, problem.instruments, iterations=8)
    ones = np.ones(len(problem.channels))
    filtered = replace(problem, whitening=whitening, smallest_noise=0.5 * ones)
    return filtered, fit(filtered, fitted.point, ones, iterations=8)
