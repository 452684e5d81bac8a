"""Something that swings at one frequency, and where it is.

A servo that hunts and a moment that swings push the aircraft alike; what tells them apart is the little lift
of the elevator, and when it began. What swings by itself did so before the stick moved. What the stick has
set swinging, slowly and for long, is a mass: fuel, a load on a sling. A servo would come to rest in a moment.
"""

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.gap.fitting.fit import Fitted, rms_of
from advisor.gap.fitting.problem import Problem
from advisor.gap.noise.probes import KNOTS_S, SENSOR_CHANNELS, disturbance_courses, probe_blocks
from advisor.gap.unnamed.clock import is_of_the_clock
from advisor.gap.unnamed.leftover import (
    LEAST_GAIN,
    LEAST_OF_GAP,
    OF_PEAK,
    Leftover,
    instruments_of,
    noise_of,
    ranking_of,
)
from advisor.gap.unnamed.origin import ALIKE
from advisor.gap.unnamed.slosh import sloshing
from advisor.gap.unnamed.tone import Tone, tone_in

_OF_PEAK_SWINGING = 0.005
"""Share of a channel's peak that a swing of the aircraft must be: no error of a model looks like that."""
_VISIBLE = 0.05
"""Power of a swing, beside the instruments' noise, from which on there is something to explain."""
_SHAKEN = 4.0
"""The same of an accelerometer: an engine shakes each of them, and samples make a slow swing of it."""
_SET_OFF = 0.25
"""Power before the stick moves, over that after, below which it was the stick that set something swinging."""
_SLOW_HZ, _NEARLY = 3.0, 0.9
"""No servo rings on for seconds below that; and share of the best gain that the moment must have then."""
_MOSTLY = 0.7
"""Share of the swing that a mass which pitching sets off must explain: then that is what it is."""
_SAME_LINE = 0.1
"""How near to a named structure's frequency a swing is its own, relative ..."""
_PLAINLY = 20.0
"""... and log likelihood by which another place than the gyro must explain it better."""


def swinging(problem: Problem, first: Fitted, last: Fitted, tolerance: FloatArray) -> Leftover | None:
    """What swings of itself, where it is more than an instrument's noise. Arguments as in ``left_over``."""
    noise, instruments = noise_of(problem), np.maximum(instruments_of(problem), 1e-12)
    tone = tone_in(problem, last, noise)
    if tone is None or tone.probes[0].gain < LEAST_GAIN or tone.probes[0].block == "air":
        return None
    best = tone.probes[0]
    least = OF_PEAK if best.block in SENSOR_CHANNELS else _OF_PEAK_SWINGING
    if not np.any(tone.power > np.maximum(least * problem.flights.peaks, tolerance) ** 2):
        return None
    beside = tone.power / instruments**2
    if float(np.mean(beside)) < _VISIBLE or (_may_be_shaken(tone) and np.max(beside) < _SHAKEN):
        return None
    powers = (rms_of(problem, last.innovations) / noise) ** 2
    taken = float(np.sum((rms_of(problem, first.innovations) / noise) ** 2 - powers))
    if best.explained * float(np.sum(powers)) < LEAST_OF_GAP * taken:
        return None
    if best.block in SENSOR_CHANNELS and is_of_the_clock(problem, last, SENSOR_CHANNELS[best.block]):
        # What comes too early or too late swings with the motion, not by itself.
        return Leftover("timing", best.explained, ranking_of(tone.probes, "timing"))
    if best.block in ALIKE and tone.hz < _SLOW_HZ:
        hanging = sloshing(problem, last)
        if hanging is not None and hanging.share > _MOSTLY * best.explained:
            ranking = ranking_of(tone.probes, hanging.block)
            return Leftover(hanging.block, best.explained, ranking, tone.power, hanging.note)
    set_off = best.block in ALIKE and _is_set_off(problem, last, noise, best.block)
    moment = next(p.gain for p in tone.probes if p.block == "moment_equation")
    a_mass = set_off and tone.hz < _SLOW_HZ and moment >= _NEARLY * best.gain
    block = "moment_equation" if a_mass else best.block
    return Leftover(block, best.explained, ranking_of(tone.probes, block), tone.power, _said(tone, set_off))


def swings_the_aircraft(problem: Problem, first: Fitted, last: Fitted) -> Leftover | None:
    """A named structure of which all channels tell, not the gyro alone: then it is the aircraft that swings.

    Arguments as in ``left_over``. The plain model shows it: the other's numbers have adapted to the name.
    """
    named = zip(last.point.effects, last.point.values, strict=True)
    omegas = (v[e.names.index("omega_rad_s")] for e, v in named if e.effect == "structural_mode")
    omega = next(omegas, None)
    tone = tone_in(problem, first, noise_of(problem)) if omega is not None else None
    if omega is None or tone is None or abs(2.0 * np.pi * tone.hz - omega) > _SAME_LINE * omega:
        return None
    best, gyro = tone.probes[0], next(p for p in tone.probes if p.block == "pitch_rate_sensor")
    if best.block in (*SENSOR_CHANNELS, "air") or best.gain - gyro.gain < _PLAINLY:
        return None
    ranking = ranking_of(tone.probes, best.block)
    return Leftover(best.block, best.explained, ranking, tone.power, _said(tone, set_off=False))


def _may_be_shaken(tone: Tone) -> bool:
    """Whether a swing is the accelerometer's, or a force's so fast that nothing else feels it."""
    best = tone.probes[0]
    accelerometer = next((p.gain for p in tone.probes if p.block == "accelerometer"), 0.0)
    return best.block in ("accelerometer", "force_equation") and accelerometer > best.gain - LEAST_GAIN


def _is_set_off(problem: Problem, last: Fitted, noise: FloatArray, block: str) -> bool:
    """Whether a disturbance is next to nothing before the first step."""
    size = probe_blocks(problem, last, noise, [block])[0].size
    courses = disturbance_courses(problem, last, noise, block, [size])[0].knots
    before, after = [], []
    for flight, course in zip(problem.flights.flights, courses, strict=True):
        began = KNOTS_S * np.arange(1.0, len(course) + 1.0) >= flight.first_step_s
        before.append(course[~began])
        after.append(course[began])
    still, loud = np.concatenate(before), np.concatenate(after)
    if not len(still) or not len(loud):
        return False
    return float(np.mean(still**2)) < _SET_OFF * float(np.mean(loud**2))


def _said(tone: Tone, set_off: bool) -> str:
    what = "Once set off, it swings" if set_off else "It swings by itself"
    return f"{what}, {tone.hz:.2g} times a second."
