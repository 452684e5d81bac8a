"""The measurements of a diagnosis as plain numbers, from which the columns of the evidence are made."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from advisor.flight.instruments.kinematics import KinematicCheck
from advisor.flight.signals.messages import FloatArray
from advisor.gap.evidence.course import courses_of, drift_and_step
from advisor.gap.evidence.found import Evidence
from advisor.gap.fitting.fit import EffectFit, rms_of
from advisor.gap.fitting.holdout import HeldOut, mean_squares
from advisor.gap.fitting.measure import whole_gap
from advisor.gap.fitting.problem import EffectProblem, counts
from advisor.gap.fitting.uncertainty import distance_from_file, effective_samples
from advisor.gap.noise.probes import Probe, probe_blocks
from advisor.gap.search.acceptance import JudgedAddition, size_of
from advisor.gap.search.score import difference, support_of
from advisor.gap.search.screen import Screened, penalty
from advisor.gap.search.stage import added_in
from advisor.gap.uncatalogued.activity_power import power_by_activity
from advisor.gap.uncatalogued.unexplained import innovation_noise, instruments_of


@dataclass(frozen=True)
class Residual:
    """The residual of a model."""

    power: FloatArray
    """Shape (channels,): mean square of the innovations over that of the noise."""
    by_maneuver: FloatArray
    """Shape (manoeuvres, channels): that power of each manoeuvre."""
    of_peak: FloatArray
    """Shape (channels,): root mean square of the residual beyond the instruments' noise, over the peak."""
    activity: FloatArray
    """Shape (channels,): power while the stick moves over power in quiet."""
    probes: Mapping[str, tuple[float, float]]
    """By block: gain in log likelihood of a free disturbance, and the share of the residual it explains."""


@dataclass(frozen=True)
class QuickFit:
    """An effect in the screening."""

    gain: float
    """Gain in log likelihood, less the price of the parameters, with the gain in log prior."""
    file_agreement: float
    """Part of the gain that comes from the aircraft file's derivatives."""
    size: float
    """Size of the first parameter over the smallest physical size."""


@dataclass(frozen=True)
class FullFit:
    """An effect that was fitted as an addition to a model."""

    gain: float
    support: float
    change: float
    """Mean square change of the motion over the least visible one."""
    sigmas: float
    size: float
    at_bound: bool
    removed: float
    """Mean square change of the motion, relative to the noise."""
    gap: float
    """Gap on held-out manoeuvres with the effect."""
    power: FloatArray
    """Shape (channels,): mean square of the innovations on held-out manoeuvres, over that of the noise."""
    by_maneuver: FloatArray
    """Shape (manoeuvres, channels): that power of each manoeuvre."""


@dataclass(frozen=True)
class Measured:
    """All numbers that the columns of the evidence are made of."""

    channels: tuple[str, ...]
    samples: FloatArray
    """Shape (manoeuvres, channels): effective number of samples."""
    base: Residual
    """Residual of the baseline model."""
    last: Residual
    """Residual of the model with all effects that were found."""
    base_gap: float
    base_held: FloatArray
    """Shape (manoeuvres, channels): power of the innovations of the baseline model on held-out manoeuvres."""
    screened: Mapping[str, QuickFit]
    fitted: Mapping[str, FullFit]
    """Effects that were fitted as an addition to the baseline model."""
    added: Mapping[str, FullFit]
    """Effects of the final model, each as an addition to the model of its stage."""
    named_gain: float
    """Gain of all effects of the final model together, in the fit."""
    sets: Mapping[tuple[str, str], FullFit] = field(default_factory=dict)
    """Sets of two effects that the search found, each as an addition to the baseline model."""
    air_gain: float = 0.0
    air_angle: float = 0.0
    """Standard deviation of the gust angle, rad."""
    air_is_gust: bool | None = None
    """Whether the air has one or a few bumps and is otherwise still; None where no air was found."""
    last_gap: float = 0.0
    """Gap on held-out manoeuvres of the model with all effects that were found."""
    air_gap: float = 0.0
    """That gap without the likeliest course of the air; equal to ``last_gap`` where no air was found."""
    offset_gap: float = 0.0
    """Gap of the offset of α that the kinematics show, over the channels."""
    laws: Mapping[str, float] = field(default_factory=dict)
    """Gain of the best uncatalogued law of each block."""
    file_gap: float = 0.0
    """Mean square of the file's derivatives beyond that of fitted ones, over the floor's square."""
    file_distance: float = 0.0
    """Squared distance of the file's derivatives from fitted ones."""
    has_file: bool = False
    offset_rad: tuple[float, float] = (0.0, 0.0)
    """Offset of α by the kinematics, and its standard deviation."""
    lag_s: tuple[float, float] = (0.0, 0.0)
    scale: tuple[float, float] = (0.0, 0.0)
    courses: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    """By block: gain of a drift and of a step of trims, offsets and estimates."""
    alpha_is_estimated: bool = False
    weight: Mapping[str, float] = field(default_factory=dict)
    """By block: error of the weight that its sensor reads, over the largest one that an offset explains."""


def measured(e: Evidence, kinematics: KinematicCheck) -> Measured:
    """Return the numbers that the columns are made of."""
    problem, first, last = e.problem, e.stages[0], e.stages[-1]
    noise = _noise(problem, first.fitted)
    effective = effective_samples(problem, last.fitted.innovations) / np.maximum(counts(problem), 1.0)
    samples = np.array([[len(f.outputs[c].t) for c in problem.channels] for f in problem.flights.flights])
    number = float(np.sum(counts(problem)))
    left = residual_of(problem, last.fitted, e.probes)
    offset = kinematics.offset
    return Measured(
        channels=problem.channels,
        samples=samples * effective,
        base=left if len(e.stages) == 1 else residual_of(problem, first.fitted),
        last=left,
        base_gap=whole_gap(first.held_out.mean_square, e.floor),
        base_held=_power(problem, first.held_out, noise),
        screened={s.variant.effect: _quick(first.fitted.cost, s, number) for s in first.screened},
        fitted={j.effect: _full(e, j, noise) for j in reversed(first.considered)},
        added={j.effect: _full(e, j, noise) for j in added_in(e.stages)},
        sets={names: _full_set(e, *pair, noise) for names, pair in e.sets.items()},
        named_gain=0.5 * (first.fitted.cost - last.fitted.cost),
        air_gain=e.sought_air.gain,
        air_angle=e.sought_air.angle_std,
        air_is_gust=None if e.air is None else e.air.gust,
        last_gap=whole_gap(last.held_out.mean_square, e.floor),
        air_gap=whole_gap(
            last.held_out.mean_square if e.air is None else e.air.mean_square_beyond_air, e.floor
        ),
        offset_gap=_offset_gap(e, offset.rad if offset.stays else 0.0),
        laws=e.laws,
        file_gap=0.0 if e.file_model is None else float(
            np.mean((e.file_model.mean_square - first.held_out.mean_square) / e.floor**2)
        ),
        file_distance=distance_from_file(problem, last.fitted).statistic,
        has_file=problem.prior_derivatives is not None,
        offset_rad=_pair(offset.rad if offset.stays else 0.0, offset.std_rad),
        lag_s=_pair(kinematics.lag_s, kinematics.lag_std_s),
        scale=_pair(kinematics.scale, kinematics.scale_std),
        courses=drift_and_step(
            courses_of(problem, first.fitted), [f.started_s for f in problem.flights.flights]
        ),
        alpha_is_estimated=problem.flights.alpha_is_derived,
        weight={} if e.weight is None else {"accelerometer": e.weight.departure},
    )  # fmt: skip


def _offset_gap(e: Evidence, offset_rad: float) -> float:
    """Return the mean over the channels of an offset's square over the floor's square; 0 where unknown."""
    channels = e.problem.channels
    if not np.isfinite(offset_rad) or "alpha" not in channels:
        return 0.0
    return float((offset_rad / e.floor[channels.index("alpha")]) ** 2) / len(channels)


def residual_of(problem: EffectProblem, fitted: EffectFit, probes: Sequence[Probe] = ()) -> Residual:
    """Return the residual of a fitted model, with a free disturbance tried in every block."""
    noise = _noise(problem, fitted)
    active, quiet = power_by_activity(problem, fitted.innovations)
    beyond = rms_of(problem, fitted.residuals) ** 2 - instruments_of(problem) ** 2
    return Residual(
        power=(rms_of(problem, fitted.innovations) / noise) ** 2,
        by_maneuver=mean_squares(problem, fitted.innovations) / noise**2,
        of_peak=np.sqrt(np.maximum(beyond, 0.0)) / np.maximum(problem.flights.peaks, 1e-12),
        activity=active / np.maximum(quiet, 1e-300),
        probes={p.block: (p.gain, p.explained) for p in probes or probe_blocks(problem, fitted, noise)},
    )


def _noise(problem: EffectProblem, fitted: EffectFit) -> FloatArray:
    """Return the noise of the innovations, shape (channels,); that of the fit where none is known."""
    noise = innovation_noise(problem)
    return np.where(noise > 0.0, noise, fitted.noise)


def _power(problem: EffectProblem, held: HeldOut, noise: FloatArray) -> FloatArray:
    return np.asarray(mean_squares(problem, held.innovations) / noise**2)


def _quick(cost: float, s: Screened, samples: float) -> QuickFit:
    size = size_of(s.variant, s.point.values[-1])
    gain = 0.5 * (cost - s.cost - penalty(s.variant, samples)) + s.prior_gain
    return QuickFit(gain, s.prior_gain, size / s.variant.smallest if s.variant.smallest > 0.0 else 0.0)


def _full(e: Evidence, j: JudgedAddition, noise: FloatArray) -> FullFit:
    power = _power(e.problem, j.held_out, noise)
    return FullFit(
        gain=j.gain,
        support=j.support,
        change=j.removed / max(j.least, 1e-12),
        sigmas=float(j.sigmas),
        size=size_of(j.variant, j.value) / j.smallest if j.smallest > 0.0 else 0.0,
        at_bound=j.at_its_bounds,
        removed=j.removed,
        gap=whole_gap(j.held_out.mean_square, e.floor),
        power=j.held_out.innovation_square / noise**2,
        by_maneuver=power,
    )


def _full_set(e: Evidence, earlier: JudgedAddition, later: JudgedAddition, noise: FloatArray) -> FullFit:
    """Return the joint fit of a set as one addition to the baseline; its size is the weaker effect's."""
    one, both, before = _full(e, earlier, noise), _full(e, later, noise), e.stages[0].held_out
    removed = difference(e.problem, before, later.held_out)
    return replace(
        both, gain=one.gain + both.gain, support=support_of(e.problem, before, later.held_out),
        change=removed / max(later.least, 1e-12), removed=removed,
        sigmas=min(one.sigmas, both.sigmas), size=min(one.size, both.size),
        at_bound=one.at_bound or both.at_bound,
    )  # fmt: skip


def _pair(value: float, std: float) -> tuple[float, float]:
    return (value, std) if np.isfinite(value) and np.isfinite(std) else (0.0, 0.0)
