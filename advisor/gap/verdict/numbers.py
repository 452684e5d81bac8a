"""The numbers of a diagnosis: gap, shrink, waterfall, model, fidelity and traces.

The measures are Theil's inequality coefficient (Theil 1966), R², and the tolerance of simulator
qualification. Theil's coefficient is split into bias, variance and covariance (Jategaonkar, *Flight Vehicle
System Identification*, section 11.3). For the short period the tolerance is ±1.5° of pitch or ±2 °/s, and
±0.10 g. The source is 14 CFR Part 60, Appendix A, and EASA CS-FSTD(A), test 2.c.10.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from advisor.aircraft.reference import PARAMETERS
from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.gap.fitting.fit import EffectFit
from advisor.gap.fitting.holdout import HeldOut
from advisor.gap.fitting.measure import by_band, by_phase, gap_between, shrink_between, whole_gap
from advisor.gap.fitting.prior import derivative_scale
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.inference.findings import Findings, Model
from advisor.gap.records.floor import prefiltered
from advisor.gap.result import Cause, ComparedDerivative, Gap, Shrink, Trace, Value, Yardsticks
from advisor.gap.simulator.layout import DERIVATIVES
from advisor.process.arrays import FloatArray


def gap_numbers(problem: EffectProblem, floor: FloatArray, before: HeldOut, last: HeldOut) -> Gap:
    """Return the gap of the simulator as given and of the final model, as numbers."""
    smooth = [c for c, yes in prefiltered(problem.flights).items() if yes]
    note = "measured where nothing was flown, before the first step and late in the free response"
    if smooth:
        note = f"stated as 2 % of peak for {', '.join(smooth)} (filtered before storage); else measured"
    flights = problem.flights.flights
    errors = ((held.mean_square, held.by_maneuver) for held in (before, last))
    gap = gap_between(problem.channels, [f.number for f in flights], floor, note, *errors)
    phases, bands = by_phase(problem, before.residuals, floor), by_band(problem, before.residuals)
    return replace(gap, by_phase=phases, by_band_hz=bands)


def irreducible(mean_square: FloatArray, floor: FloatArray, gap: Gap) -> float:
    """Return the share of the final model's error, on held-out manoeuvres, that is noise and moving air.

    ``mean_square``, shape (channels,), is that of the error with moving air, which the gap excludes.
    """
    whole = float(np.mean(np.maximum(mean_square / floor**2, 1.0)))
    return float(np.clip(1.0 - gap.after / whole, 0.0, 1.0))


def shrink_of(
    e: Findings, kept: Sequence[int], gap: Gap, before: HeldOut, last: HeldOut, wrong_derivatives: bool
) -> Shrink:
    """Return the shrink of the gap on held-out manoeuvres, with its 95 % interval by resampling.

    ``wrong_derivatives``: the file's derivatives were found wrong.
    """
    beyond_air = by_numbers = None
    if wrong_derivatives and e.air is None and len(e.models) > 1:
        by_numbers = _by_numbers(e)
    elif e.air is not None and (len(e.models) > 1 or wrong_derivatives):
        beyond_air = _by_effects(e) if len(e.models) > 1 else _by_numbers(e)
    which = list(kept)
    numbers = [e.problem.flights.flights[i].number for i in kept]
    shrink = shrink_between(gap, numbers, e.floor, before.by_maneuver[which], last.by_maneuver[which])
    return replace(shrink, beyond_air_percent=beyond_air, by_numbers_percent=by_numbers)


def _by_numbers(e: Findings) -> float | None:
    """Return the per cent of the gap that fitted derivatives remove; None without derivatives."""
    if e.file_model is None:
        return None
    was, now = (whole_gap(held.mean_square, e.floor) for held in (e.file_model, e.models[0].held_out))
    return float(np.clip(100.0 * (1.0 - now / was), 0.0, 100.0)) if was > 1e-9 else None


def _by_effects(e: Findings) -> float | None:
    """Return the shrink of the innovations, per cent, as defined in ``Shrink``."""
    removed = _removed_beyond_air(e.models)
    return None if removed is None else float(np.clip(100.0 * removed, 0.0, 100.0))


def _removed_beyond_air(models: Sequence[Model]) -> float | None:
    """Return the share of the residual beyond moving air that the effects remove, on held-out manoeuvres."""
    # With two of three folds fitted, squared innovations exceed 1 by 1.5 k over the samples.
    last = models[-1]
    noise, samples = last.fitted.noise**2, sum(map(len, last.fitted.innovations))
    was, now = (float(np.mean(s.held_out.innovation_square / noise)) - 1.0 for s in (models[0], last))
    right = 1.5 * len(last.fitted.point.shared) / samples
    return 1.0 - max(now - right, 0.0) / (was - right) if was > right else None


def waterfall_of(
    models: Sequence[Model], floor: FloatArray, extra: Sequence[Cause], start: float
) -> tuple[tuple[str, float], ...]:
    """Return the gap after the addition of each effect, in order.

    ``extra`` are causes that are judged outside the fits, and ``start`` is the simulator's gap.
    """
    steps: list[tuple[str, float]] = []
    for model, following in pairwise(models):
        assert model.added is not None
        steps.append((model.added.effect, whole_gap(following.held_out.mean_square, floor)))
    for cause in extra:
        steps.append((cause.effect, min(cause.gap_after, steps[-1][1] if steps else start)))
    return tuple(steps)


def model_of(problem: EffectProblem, fitted: EffectFit, cov: FloatArray) -> dict[str, Value]:
    """Return the eight parameters about zero angles, from the parameters about each manoeuvre's trim.

    ``cov``, shape (k, k), is the covariance of the shared parameters. An error of the derivatives moves the
    terms at zero angles of all manoeuvres together, through the trim angles.
    """
    d, own = fitted.point.derivatives, fitted.point.own
    trims = np.array([[f.alpha_trim, f.u_trim] for f in problem.flights.flights])
    # Trim terms are given at the reference speed, and so is the weight that they carry there.
    gravity = GRAVITY_M_S2 / problem.flights.reference_m_s
    slopes = {"Z_0": (0, 2), "M_0": (3, 5)}
    terms = {"Z_0": own[:, 2] + gravity, "M_0": own[:, 3]}
    began = _as_it_began(problem, fitted)
    values = {}
    for name, pair in slopes.items():
        each = terms[name] - trims @ d[list(pair)]
        mean_trim = np.mean(trims, axis=0)
        together = mean_trim @ cov[np.ix_(pair, pair)] @ mean_trim
        several = each[began] if np.count_nonzero(began) > 1 else each
        scatter = np.var(several, ddof=min(1, len(several) - 1)) / np.count_nonzero(began)
        values[name] = Value(float(np.mean(each[began])), float(np.sqrt(scatter + max(together, 0.0))))
    for k, name in enumerate(DERIVATIVES):
        values[name] = Value(float(d[k]), float(np.sqrt(max(cov[k, k], 0.0))))
    return {name: values[name] for name in PARAMETERS}


def compared_derivatives(
    problem: EffectProblem, fitted: EffectFit, cov: FloatArray
) -> tuple[ComparedDerivative, ...]:
    """Return the simulator's and the flight's derivatives, with the most significant difference first.

    ``cov``, shape (k, k), is the covariance of the shared parameters. Without a simulator no derivative is
    compared.
    """
    if problem.prior_derivatives is None:
        return ()
    std = np.sqrt(np.maximum(np.diag(cov), 0.0))
    pairs = [
        ComparedDerivative(name, float(given), Value(float(flown), float(std[k])))
        for k, (name, given, flown) in enumerate(
            zip(DERIVATIVES, problem.prior_derivatives, fitted.point.derivatives, strict=False)
        )
    ]
    return tuple(sorted(pairs, key=lambda d: -abs(d.found.value - d.given) / max(d.half, 1e-300)))


def _as_it_began(problem: EffectProblem, fitted: EffectFit) -> FloatArray:
    """Return whether each manoeuvre was flown before a change in flight, shape (manoeuvres,), bool."""
    derivatives = problem.driving(fitted.point)[:, : len(DERIVATIVES)]
    off = np.max(
        np.abs(derivatives - fitted.point.derivatives) / derivative_scale(fitted.point.derivatives), axis=1
    )
    return np.asarray(off == np.min(off))


def fidelity_of(
    problem: EffectProblem, before: HeldOut, last: HeldOut
) -> dict[str, tuple[Yardsticks, Yardsticks]]:
    """Return the published fidelity measures of every channel, for the given simulator and the final
    model."""
    measures = {}
    for c, name in enumerate(problem.channels):
        measured = np.concatenate([f.outputs[name].y for f in problem.flights.flights])
        pair = []
        for held in (before, last):
            residual = np.concatenate([
                x[problem.rows(f)[c]] for f, x in zip(problem.flights.flights, held.residuals, strict=True)
            ])  # fmt: skip
            pair.append(yardsticks(name, measured, measured - residual))
        measures[name] = (pair[0], pair[1])
    return measures


def traces_of(problem: EffectProblem, before: HeldOut, last: HeldOut) -> tuple[Trace, ...]:
    """Return measured and simulated values for plotting."""
    traces = []
    for i, flight in enumerate(problem.flights.flights):
        for name, rows in zip(problem.channels, problem.rows(flight), strict=True):
            out = flight.outputs[name]
            simulated = (out.y - held.residuals[i][rows] for held in (before, last))
            traces.append(Trace(flight.number, name, out.t, out.y, *simulated))
    return tuple(traces)


BAND = {"theta": np.radians(1.5), "q": np.radians(2.0), "a_z": 0.10 * GRAVITY_M_S2}
"""Words: tolerance of simulator qualification for the short period, by channel, SI."""


def yardsticks(channel: str, measured: FloatArray, simulated: FloatArray) -> Yardsticks:
    """Return all measures of fidelity of one channel; both arrays have shape (n,)."""
    error = measured - simulated
    power = float(np.mean(error**2))
    size = float(np.sqrt(np.mean(measured**2)) + np.sqrt(np.mean(simulated**2)))
    spread_m, spread_s = float(np.std(measured)), float(np.std(simulated))
    bias = float(np.mean(error)) ** 2
    variance = (spread_m - spread_s) ** 2
    band = BAND.get(channel)
    return Yardsticks(
        theil=float(np.sqrt(power)) / size if size > 0.0 else float("nan"),
        bias=bias / power if power > 0.0 else 0.0,
        variance=variance / power if power > 0.0 else 0.0,
        covariance=max(1.0 - (bias + variance) / power, 0.0) if power > 0.0 else 1.0,
        r2=1.0 - power / spread_m**2 if spread_m > 0.0 else float("nan"),
        within_tolerance=None if band is None else float(np.mean(np.abs(error) <= band)),
    )
