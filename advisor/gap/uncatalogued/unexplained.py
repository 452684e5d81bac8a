"""The test for an unexplained residual, which decides between "none" and "unknown".

The whitened residual of the last model should be white, and no louder while the stick moves than in quiet.
Otherwise a cause outside the catalogue exists, in the block whose unknown disturbance explains most of the
residual. A sensor that jumps is no noise either.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.gap.decision import BEYOND_DOUBT, Decision
from advisor.gap.fitting.fit import EffectFit, rms_of
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.noise.probes import SENSOR_CHANNELS, Probe, probe_blocks
from advisor.gap.records.floor import STATED_FLOOR_MARGIN
from advisor.gap.simulator.layout import natural_frequency
from advisor.gap.uncatalogued.activity_power import power_by_activity
from advisor.gap.uncatalogued.clock_error import is_clock_error
from advisor.gap.uncatalogued.sensor_jumps import jumping_sensor

_LEAST_SHARE = 0.2
"""Least share of the residual that a disturbance must explain. A smaller share is the roughness of any model,
or what the low-order filter of moving air leaves. On 40 flights the share was above 0.56 where something
without a name acted, and below 0.07 elsewhere."""
_ACTIVITY_RATIO = 2.0
"""Ratio of the residual power while the stick moves to that in quiet, above which the residual of a smoothed
record is no noise."""
LEAST_OF_GAP = 0.05
"""Least ratio of an unexplained to an explained residual. A smaller one is the low-order description of an
effect."""
OF_PEAK = 0.01
"""Least residual as a share of a channel's peak. A simplified model is no more accurate."""


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
    probes: Sequence[Probe],
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
    probes
        Free disturbances in the residual of ``last``, likeliest first.
    """
    noise = innovation_noise(problem)
    powers = (rms_of(problem, last.innovations) / noise) ** 2
    telling = np.isin(np.arange(len(problem.channels)), problem.flights.telling)
    beyond = np.sqrt(np.maximum(rms_of(problem, last.residuals) ** 2 - instruments_of(problem) ** 2, 0.0))
    least = np.maximum(OF_PEAK, _of_the_command(problem, last)) * problem.flights.peaks
    telling &= beyond > least
    jumping = jumping_sensor(problem, last, tolerance)
    nothing = not np.any(telling)
    if nothing and jumping is None:
        return None
    best = probes[0]
    # A residual that a Gauss-Markov disturbance describes did not jump.
    if jumping is not None and best.explained < _LEAST_SHARE:
        return Unexplained(jumping, 1.0, ranking_of(probes, jumping), note="It jumps now and then.")
    if nothing:
        return None
    loud = telling & (rms_of(problem, last.residuals) > STATED_FLOOR_MARGIN * tolerance)
    active, quiet = power_by_activity(problem, last.innovations)
    louder = np.where(loud, np.maximum(active / np.maximum(quiet, 1e-300), 1.0), 1.0)
    likelihood = Decision("", "likelihood", best.gain, BEYOND_DOUBT, "log likelihood of a disturbance there")
    place = Decision("", "place", best.explained, _LEAST_SHARE, "of what is left")
    activity = Decision("", "activity", float(np.max(louder)), _ACTIVITY_RATIO, "times the power in quiet")
    # Low-pass filtered noise resembles no Gauss-Markov noise, so there only the stick's activity decides.
    asked = [activity] if problem.flights.alpha_is_smoothed else [likelihood, place]
    unexplained = max(best.explained * float(np.sum(powers)), float(np.sum(powers * (1.0 - 1.0 / louder))))
    taken = float(np.sum((rms_of(problem, first.innovations) / noise) ** 2 - powers))
    unit = "of the power that the names took up"
    asked.append(Decision("", "size", unexplained, LEAST_OF_GAP * taken, unit))
    if not np.any(loud) or not all(decision.holds for decision in asked):
        return None
    block = _block(problem, last, best.block)
    if moving_air and block == "air":
        # The filter leaves a part of the moving air, whose spectrum it knows to low order only.
        return None
    decisions = tuple(replace(decision, about=block) for decision in asked)
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
