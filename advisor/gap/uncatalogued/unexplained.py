"""Is anything left that noise does not explain? The question behind "none" and "unknown".

What stays after the last named effect, freed of the flight's own noise, should be white, and no
louder while the stick moves than in quiet. Otherwise something is there without a name; where, is said by the
block whose unknown disturbance takes up most of it. A sensor that jumps now and then is no noise either.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.gap.decision import Decision
from advisor.gap.fitting.fit import Fitted, rms_of
from advisor.gap.fitting.problem import Problem
from advisor.gap.noise.probes import SENSOR_CHANNELS, Probe, probe_blocks
from advisor.gap.records.floor import STATED_FLOOR_MARGIN
from advisor.gap.simulator.layout import natural_frequency
from advisor.gap.uncatalogued.activity_power import power_by_activity
from advisor.gap.uncatalogued.clock_error import is_clock_error
from advisor.gap.uncatalogued.sensor_jumps import jumping_sensor

LEAST_GAIN = 100.0
"""Log likelihood a disturbance must bring ..."""
_LEAST_SHARE = 0.2
"""... and share of what is left that it must take up: less is the roughness of any model."""
_MOVING_SHARE = 0.1
"""The same where the air moves: its filter is known to low order only, and leaves a few per cent."""
_FAINT_SHARE = 0.05
"""The least share in still air, for a disturbance that is large beside what the named effects took up ..."""
_FAINT_OF_GAP = 0.25
"""... by this much: then no name came near what is there."""
_ACTIVITY_RATIO = 2.0
"""Power while the stick moves over that in quiet, from which on it is no noise."""
LEAST_OF_GAP = 0.1
"""Either beside what the named effects took up: less is an effect's shape, known to low order only."""
OF_PEAK = 0.01
"""Share of a channel's peak that must be left: a simplified model is no better than that ..."""
_BEYOND_DOUBT, _FAR_LOUDER, _FAR_ABOVE = 0.5, 4.0, 2.0
"""... that share of it where it is so much louder while the stick moves, and above noise in all."""
_CLEAR = 0.1
"""Share of a channel's peak that no shape of a named effect leaves, however much it took up."""


@dataclass(frozen=True)
class Unexplained:
    """Something without a name, and where it is."""

    block: str
    share: float
    """Of the power that is left, taken up by an unknown disturbance there."""
    ranking: tuple[tuple[str, float], ...]
    """Block and score, 1 for the likeliest."""
    in_quiet: FloatArray | None = None
    """Shape (channels,): mean square of what it does where nothing is flown, too; None: next to nothing."""
    note: str = ""
    """What is known of it, in a sentence."""
    decisions: tuple[Decision, ...] = ()
    """What told it from noise, where numbers were held against limits."""


def as_wind(found: Unexplained | None) -> Unexplained:
    """What is left where the wind is known to change with height: whatever it looks like, it is the air's."""
    ranking = () if found is None else tuple(pair for pair in found.ranking if pair[0] != "air")
    return Unexplained("air", 1.0 if found is None else found.share, (("air", 1.0), *ranking))


def unexplained_residual(
    problem: Problem,
    first: Fitted,
    last: Fitted,
    tolerance: FloatArray,
    moving_air: bool,
) -> Unexplained | None:
    """What the last model leaves, if it is more than noise.

    Parameters
    ----------
    first, last
        The plain model and the one with every named effect.
    tolerance
        Shape (channels,): tolerance of channels that were filtered before they were recorded, else 0.
    moving_air
        Whether the air was found to move: then the filter that knows of it is known to low order only.
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
    # What a disturbance with a memory describes did not jump.
    if jumping is not None and best.explained < _LEAST_SHARE:
        return Unexplained(jumping, 1.0, ranking_of(probes, jumping), note="It jumps now and then.")
    if nothing:
        return None
    loud = telling & (rms_of(problem, last.residuals) > STATED_FLOOR_MARGIN * tolerance)
    louder = np.where(loud, active / np.maximum(quiet, 1e-300), 1.0)
    faint = best.explained < _LEAST_SHARE
    least_share = _MOVING_SHARE if moving_air else _FAINT_SHARE
    disturbed = best.gain >= LEAST_GAIN and best.explained >= least_share and bool(np.any(loud))
    # What a low-pass leaves of noise is like no noise with a memory: there only the stick can tell.
    disturbed = disturbed and not problem.flights.alpha_is_smoothed
    if not disturbed and np.max(louder) < _ACTIVITY_RATIO:
        return None
    clear = bool(np.any((louder > _ACTIVITY_RATIO) & (beyond > _CLEAR * peaks)))
    if faint and not clear and not moving_air and first is not last:
        # What every block explains as little is the error of the named effects' model.
        return None
    unexplained = max(best.explained * float(np.sum(powers)), float(np.sum(powers * (1.0 - 1.0 / louder))))
    taken = float(np.sum((rms_of(problem, first.innovations) / noise) ** 2 - powers))
    least = _FAINT_OF_GAP if disturbed and faint and np.max(louder) < _ACTIVITY_RATIO else LEAST_OF_GAP
    if unexplained < least * taken and not clear:
        return None
    block = _block(problem, last, best.block)
    if moving_air and block == "air":
        # What the filter leaves of the air, whose shape is known to low order only.
        return None
    decisions = (
        Decision(block, "likelihood", best.gain, LEAST_GAIN, "log likelihood of a disturbance there"),
        Decision(block, "place", best.explained, least_share, "of what is left"),
        Decision(block, "activity", float(np.max(louder)), _ACTIVITY_RATIO, "times the power in quiet"),
        Decision(block, "size", unexplained, least * taken, "of the power that the names took up"),
    )
    return Unexplained(block, best.explained, ranking_of(probes, block), decisions=decisions)


def located(problem: Problem, last: Fitted) -> Unexplained:
    """What is left, in the block whose unknown disturbance explains it best."""
    probes = probe_blocks(problem, last, innovation_noise(problem))
    block = _block(problem, last, probes[0].block)
    return Unexplained(block, probes[0].explained, ranking_of(probes, block))


def _block(problem: Problem, last: Fitted, likeliest: str) -> str:
    """The likeliest block, or timing where a sensor is off by its rate times a delay that changes."""
    channel = SENSOR_CHANNELS.get(likeliest)
    return "timing" if channel is not None and is_clock_error(problem, last, channel) else likeliest


def _of_the_command(problem: Problem, last: Fitted) -> float:
    """Share of a response's peak, as an RMS, that hangs on how the command went between two stamps.

    A step is known as a ramp from one stamp to the next, shifted as fits best. While it lasts the pitch rate
    is off by up to ω T/4 of its peak, ω being the short period's frequency; the steps of an input take about
    a tenth of its record.
    """
    if problem.held:
        return 0.0
    frequency = natural_frequency(last.point.derivatives)
    interval = float(np.median(np.concatenate([np.diff(f.t_u) for f in problem.flights.flights])))
    return frequency * interval / 12.0


def innovation_noise(problem: Problem) -> FloatArray:
    """What innovations are measured against, shape (channels,): 1 where the filter knows the noise."""
    return np.ones(len(problem.channels)) if problem.knows_the_noise else instruments_of(problem)


def instruments_of(problem: Problem) -> FloatArray:
    """White noise of the instruments, shape (channels,); 0 where it is not known."""
    return np.zeros(len(problem.channels)) if problem.instruments is None else problem.instruments


def ranking_of(probes: Sequence[Probe], first: str) -> tuple[tuple[str, float], ...]:
    """Blocks and their scores, 1 for the first."""
    best = max(probes[0].gain, 1e-9)
    scores = {first: 1.0}
    for p in probes:
        scores.setdefault(p.block, round(min(max(p.gain, 0.0) / best, 1.0), 4))
    return tuple(scores.items())
