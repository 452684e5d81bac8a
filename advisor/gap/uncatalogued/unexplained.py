"""The test for an unexplained residual, which decides between "none" and "unknown".

The whitened residual of the last model should be white, and no louder while the stick moves than in quiet.
Otherwise a cause outside the catalogue exists, in the block whose unknown disturbance explains most of the
residual. A sensor that jumps is no noise either.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.gap.decision import Decision
from advisor.gap.fitting.fit import EffectFit, rms_of
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.noise.probes import SENSOR_CHANNELS, Probe, probe_blocks
from advisor.gap.records.floor import STATED_FLOOR_MARGIN
from advisor.gap.simulator.layout import natural_frequency
from advisor.gap.uncatalogued.activity_power import power_by_activity
from advisor.gap.uncatalogued.clock_error import is_clock_error
from advisor.gap.uncatalogued.sensor_jumps import jumping_sensor

LEAST_GAIN = 100.0
"""Least gain in log likelihood of a disturbance in some block."""
_LEAST_SHARE = 0.2
"""Least share of the residual that a disturbance must explain. A smaller share is the roughness of any
model."""
_MOVING_SHARE = 0.1
"""Least share in moving air, whose low-order filter leaves a few per cent."""
_FAINT_SHARE = 0.05
"""Least share in still air, of a disturbance that is large relative to the explained residual."""
_FAINT_OF_GAP = 0.25
"""Least ratio of an unexplained to an explained residual for the smaller share in still air: no effect comes
near the cause then."""
_ACTIVITY_RATIO = 2.0
"""Ratio of the residual power while the stick moves to that in quiet, above which the residual is no
noise."""
LEAST_OF_GAP = 0.1
"""Least ratio of an unexplained to an explained residual. A smaller one is the low-order description of an
effect."""
OF_PEAK = 0.01
"""Least residual as a share of a channel's peak. A simplified model is no more accurate."""
_BEYOND_DOUBT, _FAR_LOUDER, _FAR_ABOVE = 0.5, 4.0, 2.0
"""Share of that limit that is enough for an evident residual. Such a residual exceeds the quiet power by the
second factor, and the noise by the third."""
_CLEAR = 0.1
"""Residual as a share of a channel's peak that no description of an effect leaves, however much it
explains."""


@dataclass(frozen=True)
class Unexplained:
    """An unexplained residual, and the block in which it arises."""

    block: str
    share: float
    """Share of the residual power that an unknown disturbance in the block explains."""
    ranking: tuple[tuple[str, float], ...]
    """Blocks with their scores; the likeliest block scores 1."""
    in_quiet: FloatArray | None = None
    """Shape (channels,): mean square of the cause in quiet stretches; None where it is negligible."""
    note: str = ""
    """A sentence about the cause."""
    decisions: tuple[Decision, ...] = ()
    """Statistics that were compared with limits."""


def as_wind(found: Unexplained | None) -> Unexplained:
    """Return the residual as one of the air, where the wind is known to change with height."""
    ranking = () if found is None else tuple(pair for pair in found.ranking if pair[0] != "air")
    return Unexplained("air", 1.0 if found is None else found.share, (("air", 1.0), *ranking))


def unexplained_residual(
    problem: EffectProblem,
    first: EffectFit,
    last: EffectFit,
    tolerance: FloatArray,
    moving_air: bool,
) -> Unexplained | None:
    """Return the residual of the last model, if it is more than noise.

    Parameters
    ----------
    first, last
        The baseline model, and the model with every named effect.
    tolerance
        Shape (channels,): assumed noise of channels that were filtered before storage, else 0.
    moving_air
        Whether the air moves. Its filter is then a low-order approximation.
    """
    noise = innovation_noise(problem)
    powers = (rms_of(problem, last.innovations) / noise) ** 2
    telling = np.isin(np.arange(len(problem.channels)), problem.flights.telling)
    beyond = np.sqrt(np.maximum(rms_of(problem, last.residuals) ** 2 - instruments_of(problem) ** 2, 0.0))
    peaks = problem.flights.peaks
    active, quiet = power_by_activity(problem, last.innovations)
    beyond_doubt = (active > _FAR_LOUDER * quiet) & (powers > _FAR_ABOVE)
    of_peak = np.where(beyond_doubt, _BEYOND_DOUBT, 1.0) * OF_PEAK
    telling &= beyond > np.maximum(of_peak, _of_the_command(problem, last)) * peaks
    jumping = jumping_sensor(problem, last, tolerance)
    nothing = not np.any(telling)
    if nothing and jumping is None:
        return None
    probes = probe_blocks(problem, last, noise)
    best = probes[0]
    # A residual that a Gauss-Markov disturbance describes did not jump.
    if jumping is not None and best.explained < _LEAST_SHARE:
        return Unexplained(jumping, 1.0, ranking_of(probes, jumping), note="It jumps now and then.")
    if nothing:
        return None
    loud = telling & (rms_of(problem, last.residuals) > STATED_FLOOR_MARGIN * tolerance)
    louder = np.where(loud, active / np.maximum(quiet, 1e-300), 1.0)
    faint = best.explained < _LEAST_SHARE
    least_share = _MOVING_SHARE if moving_air else _FAINT_SHARE
    disturbed = best.gain >= LEAST_GAIN and best.explained >= least_share and bool(np.any(loud))
    # Low-pass filtered noise resembles no Gauss-Markov noise, so there only the stick's activity decides.
    disturbed = disturbed and not problem.flights.alpha_is_smoothed
    if not disturbed and np.max(louder) < _ACTIVITY_RATIO:
        return None
    clear = bool(np.any((louder > _ACTIVITY_RATIO) & (beyond > _CLEAR * peaks)))
    if faint and not clear and not moving_air and first is not last:
        # Every block explains equally little: the residual is the model error of the named effects.
        return None
    unexplained = max(best.explained * float(np.sum(powers)), float(np.sum(powers * (1.0 - 1.0 / louder))))
    taken = float(np.sum((rms_of(problem, first.innovations) / noise) ** 2 - powers))
    least = _FAINT_OF_GAP if disturbed and faint and np.max(louder) < _ACTIVITY_RATIO else LEAST_OF_GAP
    if unexplained < least * taken and not clear:
        return None
    block = _block(problem, last, best.block)
    if moving_air and block == "air":
        # The filter leaves a part of the moving air, whose spectrum it knows to low order only.
        return None
    decisions = (
        Decision(block, "likelihood", best.gain, LEAST_GAIN, "log likelihood of a disturbance there"),
        Decision(block, "place", best.explained, least_share, "of what is left"),
        Decision(block, "activity", float(np.max(louder)), _ACTIVITY_RATIO, "times the power in quiet"),
        Decision(block, "size", unexplained, least * taken, "of the power that the names took up"),
    )
    return Unexplained(block, best.explained, ranking_of(probes, block), decisions=decisions)


def located(problem: EffectProblem, last: EffectFit) -> Unexplained:
    """Return the residual, in the block whose unknown disturbance explains it best."""
    probes = probe_blocks(problem, last, innovation_noise(problem))
    block = _block(problem, last, probes[0].block)
    return Unexplained(block, probes[0].explained, ranking_of(probes, block))


def _block(problem: EffectProblem, last: EffectFit, likeliest: str) -> str:
    """Return the likeliest block, or timing where a sensor's error is its rate times a varying delay."""
    channel = SENSOR_CHANNELS.get(likeliest)
    return "timing" if channel is not None and is_clock_error(problem, last, channel) else likeliest


def _of_the_command(problem: EffectProblem, last: EffectFit) -> float:
    """Return the share of a response's peak, as RMS, that depends on the command between two stamps.

    A step is known as a ramp from one stamp to the next. While it lasts, the pitch rate is off by up to ω T/4
    of its peak, where ω is the frequency of the short period. The steps of an input take about a tenth of a
    record.
    """
    if problem.held:
        return 0.0
    frequency = natural_frequency(last.point.derivatives)
    interval = float(np.median(np.concatenate([np.diff(f.t_u) for f in problem.flights.flights])))
    return frequency * interval / 12.0


def innovation_noise(problem: EffectProblem) -> FloatArray:
    """Return the noise of the innovations, shape (channels,): 1 where the filter knows the noise."""
    return np.ones(len(problem.channels)) if problem.knows_the_noise else instruments_of(problem)


def instruments_of(problem: EffectProblem) -> FloatArray:
    """Return the white noise of the instruments, shape (channels,); 0 where it is not known."""
    return np.zeros(len(problem.channels)) if problem.instruments is None else problem.instruments


def ranking_of(probes: Sequence[Probe], first: str) -> tuple[tuple[str, float], ...]:
    """Return the blocks with their scores; ``first`` scores 1."""
    best = max(probes[0].gain, 1e-9)
    scores = {first: 1.0}
    for p in probes:
        scores.setdefault(p.block, round(min(max(p.gain, 0.0) / best, 1.0), 4))
    return tuple(scores.items())
