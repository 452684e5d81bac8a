"""A simple law that has no name in the catalogue: a reading out of proportion, a moment that bends.

α and q may be scaled by name; a_z and θ may not, no reading may be bent, and no gyro feel an acceleration.
A moment may bend by name with the deflection and with α, but not with the pitch rate, nor with products. Yet
two or three named effects together imitate such a law well. One law that explains more than all of them do
is likelier.
"""

from collections.abc import Sequence
from functools import partial

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.gap.candidates.catalogue import BLOCK_OF
from advisor.gap.candidates.variant import Values, Variant
from advisor.gap.fitting.fit import Fitted, fit
from advisor.gap.fitting.holdout import HeldOut, hold_out
from advisor.gap.fitting.problem import Problem
from advisor.gap.fitting.uncertainty import belief_in, worth
from advisor.gap.records.flights import Flights
from advisor.gap.search.merit import Judged
from advisor.gap.search.score import addition, difference, log_likelihood_gained
from advisor.gap.search.screen import Screen, penalty
from advisor.gap.search.waterfall import Stage
from advisor.gap.simulator.layout import INDEX
from advisor.gap.unnamed.leftover import Leftover


def _scale(name: str, block: str, channel: str) -> Variant:
    """A factor of what is read."""
    entries = (f"{channel}_scale",)
    return Variant(name, block, ("scale",), ((0.0,),), (0.002,), ((-0.8, 3.0),), 0.03, entries=entries)


def _curve(name: str, block: str, channel: str, unit: float) -> Variant:
    """Factors of what is read, of its square and of its cube (IEEE Std 1293); ``unit``: a usual change."""
    return Variant(
        name, block, ("scale", "square", "cube"), ((0.0, 0.0, 0.0),),
        (0.002, 0.002 / unit, 0.002 / unit**2),
        ((-0.8, 3.0), (-10.0 / unit, 10.0 / unit), (-100.0 / unit**2, 100.0 / unit**2)), 0.0,
        entries=tuple(f"{channel}_{order}" for order in ("scale", "read2", "read3")),
    )  # fmt: skip


_PULLED, _STOP, _RINGS = "gyro_pulled", "surface_stop", "servo_rings"
_TRIMMED_RAD = 0.002
"""Nearest to its trim that a surface may be stopped."""
_READINGS = {
    "a_z": (_curve("accelerometer_curve", "accelerometer", "a_z", 5.0),),
    "alpha": (_curve("alpha_curve", "alpha_sensor", "alpha", 0.05),),
    "theta": (_scale("attitude_scale", "attitude_sensor", "theta"),),
    "q": (
        # IEEE Std 1431: drift that goes with acceleration, and with its square.
        Variant(
            "gyro_pulled",
            "pitch_rate_sensor",
            ("per_m_s2", "per_m_s2_squared"),
            ((0.0, 0.0),),
            (1e-4, 1e-5),
            ((-0.1, 0.1), (-0.02, 0.02)),
            0.0,
            entries=("q_pull", "q_pull2"),
        ),
    ),
}
_MOMENTS = (
    Variant(
        "damping_curve", "moment_equation", ("M_q_abs", "M_q_q"), ((0.0, 0.0),), (0.05, 0.1),
        ((-50.0, 50.0), (-200.0, 200.0)), 0.0, entries=("M_q_abs", "M_q_q"),
    ),
    Variant(
        "crossed_moment", "moment_equation", ("M_alpha_q", "M_alpha_delta_e"), ((0.0, 0.0),), (0.5, 1.0),
        ((-300.0, 300.0), (-2000.0, 2000.0)), 0.0, entries=("M_alpha_q", "M_alpha_delta_e"),
    ),
)  # fmt: skip
_RINGING = Variant(
    _RINGS, "input", ("lag_s", "damping"), ((0.05, 0.25), (0.025, 0.25), (0.012, 0.25)), (5e-4, 0.01),
    ((0.002, 0.3), (0.02, 0.45)), 0.0, entries=("lag_s", "lag_damping"),
)  # fmt: skip
_SAID = {
    "accelerometer_curve": "The accelerometer does not read in proportion: it clips, rectifies or bends.",
    "alpha_curve": "The angle of attack does not read in proportion: its vane bends, rubs or meets a stop.",
    "attitude_scale": "The attitude reads {percent:+.1f} % against what the pitch rate says.",
    _STOP: "The surface stops before the command does: it moves {degrees} deg from its trim and no further.",
    _RINGS: "The surface overshoots its command: a servo of second order that is hardly damped.",
    _PULLED: "The pitch rate feels the acceleration.",
    "damping_curve": "The damping in pitch is not the same up and down, or fast and slow.",
    "crossed_moment": "The damping in pitch or the power of the elevator changes with the angle of attack.",
}
_CERTAIN = 30.0
"""Log likelihood that a law must bring: most of what a reading's does is the lift's own slope."""
_WORTH_A_FIT = 0.2
"""Share of the likeliest law's gain in the screening from which on another is fitted, too."""
_LIKELIER = 10.0
"""... and by how much it must beat all that was named together."""
_LEAVES = 0.3
"""Share of a channel's power that a gyro leaves at most, if it feels acceleration: an attitude that leans
looks alike, but for that."""
_SEVERAL = 2
"""Names that together imitate a law."""
_BESIDE = 0.5
"""What the named effects bring beside the law, of what they bring without, where they are another matter;
certain is enough. And they must change that share of what the law removes: a speed that is off has
side effects."""


def _stops(flights: Flights) -> list[Variant]:
    """A surface that goes no further than to a stop, one way or both, wherever each manoeuvre was trimmed."""
    trims = np.array([flight.u_trim for flight in flights.flights])
    middle = float(np.median(trims))
    ways = {"stop_up_rad": 1.0, "stop_down_rad": -1.0}

    def stopped(entries: Sequence[str], p: FloatArray, values: Values, _: Flights) -> None:
        for entry, value in zip(entries, values, strict=True):
            p[:, INDEX[entry]] = np.maximum(value + ways[entry] * (middle - trims), _TRIMMED_RAD)

    def furthest(entry: str) -> float:
        return max(float(np.max(ways[entry] * (f.u - middle))) for f in flights.flights)

    variants = []
    for entries in (tuple(ways), ("stop_up_rad",), ("stop_down_rad",)):
        most = [furthest(entry) for entry in entries]
        if min(most) <= _TRIMMED_RAD:
            continue
        variants.append(
            Variant(
                _STOP, "input", entries, tuple(tuple(x * m for m in most) for x in (0.5, 0.8)),
                (1e-3,) * len(entries), tuple((_TRIMMED_RAD, 1.5 * m) for m in most), 0.0,
                apply_with=partial(stopped, entries),
            )
        )  # fmt: skip
    return variants


def unnamed_law(problem: Problem, stages: list[Stage]) -> Leftover | None:
    """The law that explains more than everything that was named; None where none does."""
    plain, held = stages[0].fitted, stages[0].held_out
    readings = [problem.channels[c] for c in problem.flights.telling]
    tried = [variant for channel in readings for variant in _READINGS.get(channel, ())]
    found = Screen(problem, plain).quick_fits([*tried, *_MOMENTS, *_stops(problem.flights), _RINGING])
    samples = float(np.sum(worth(problem, plain.innovations)))
    best = min((s.cost for s in found), default=plain.cost)
    most = plain.cost - 2.0 * max(_CERTAIN, 0.5 * _WORTH_A_FIT * (plain.cost - best))
    # A law that changes what the derivatives are takes more steps than a screening makes.
    fits = [(s.variant, fit(problem, s.point, s.noise, tolerance=0.5)) for s in found if s.cost <= most]
    if not fits:
        return None
    law, fitted = min(fits, key=lambda pair: pair[1].cost + penalty(pair[0], samples))
    independent = worth(problem, fitted.innovations)
    bent = addition(problem, plain, held, fitted, law.effect, independent)
    named = _gain_of_all(problem, stages)
    if not bent.worth_naming or bent.gain < max(_CERTAIN, named + _LIKELIER):
        return None
    alike = difference(problem, stages[-1].held_out, bent.held_out) < bent.least
    if alike and sum(s.added is not None for s in stages) < _SEVERAL:
        # Next to the same motion as what was named: one name stays, several in concert are no likelier.
        return None
    if len(stages) > 1 and _is_another_matter(problem, stages, bent, independent):
        return None
    left = bent.held_out.mean_square / held.mean_square
    if law.effect == _PULLED and np.min(left) > _LEAVES:
        return None
    block = law.block
    rivals = {BLOCK_OF[j.effect]: _share(j, bent) for j in reversed(stages[0].considered)}
    ranking = sorted(((b, s) for b, s in rivals.items() if b != block), key=lambda pair: -pair[1])
    share = float(np.clip(1.0 - np.mean(left), 0.0, 1.0))
    return Leftover(block, share, ((block, 1.0), *ranking), note=_said(bent))


def _said(bent: Judged) -> str:
    """What the law is, and what else would look like it."""
    degrees = " and ".join(f"{np.degrees(value):.1f}" for value in bent.value)
    return _SAID[bent.effect].format(percent=100.0 * float(bent.value[0]), degrees=degrees)


def _gain_of_all(problem: Problem, stages: list[Stage]) -> float:
    """What the named effects bring together, as ``Judged.gain`` counts; 0 without any."""
    first, last = stages[0], stages[-1]
    numbers = sum(len(s.added.variant.names) for s in stages if s.added is not None)
    if numbers == 0:
        return 0.0
    independent = worth(problem, last.fitted.innovations)
    likelihood = log_likelihood_gained(first.fitted, first.held_out, last.fitted, last.held_out, independent)
    likelihood += 0.5 * (problem.strangeness(first.fitted.point) - problem.strangeness(last.fitted.point))
    belief = belief_in(problem, last.fitted, independent) - belief_in(problem, first.fitted, independent)
    return likelihood - 0.5 * numbers * float(np.log(np.sum(independent))) + belief


def _is_another_matter(problem: Problem, stages: list[Stage], bent: Judged, independent: FloatArray) -> bool:
    """Whether what was named explains beside the law much of what it explains without, and matters."""
    first, last = stages[0], stages[-1]
    law = set(bent.variant.entries)
    others = [v.effect for v in last.fitted.point.effects if not law & set(v.entries)]
    both = fit(
        problem,
        last.fitted.point.with_only(others).with_effect(bent.variant, tuple(bent.value)),
        bent.fitted.noise,
        tolerance=0.5,
    )

    def gained(before: Fitted, held_before: HeldOut, after: Fitted, held_after: HeldOut) -> float:
        return log_likelihood_gained(before, held_before, after, held_after, independent)

    held = hold_out(problem, both)
    alone = gained(first.fitted, first.held_out, last.fitted, last.held_out)
    beside = gained(bent.fitted, bent.held_out, both, held)
    matters = difference(problem, bent.held_out, held) > _BESIDE * bent.removed
    return matters and beside > min(_BESIDE * alone, _CERTAIN)


def _share(judged: Judged, best: Judged) -> float:
    """Gain beside the best's, 0 to 1."""
    return round(float(np.clip(judged.gain / best.gain, 0.0, 1.0)), 4)
