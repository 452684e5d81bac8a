"""What a plan can detect, before it is flown; and what a flight could not have shown.

An effect's sensitivity, projected off what the model's own numbers can mimic, divided by the noise: its
length is one over the smallest size that can be told from nothing, its angle to another effect's how
easily the two are confused.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.gap.fit import Fitted, factor
from advisor.gap.linear import shared_columns
from advisor.gap.normal import solved
from advisor.gap.problem import Problem, row_weights
from advisor.gap.result import Unseen
from advisor.gap.ties import breaking
from advisor.gap.variant import Variant

DETECTED_AT = 5.0
"""Standard deviations at which a size counts as detectable."""
CONFUSED_AT = 0.95
_NO_A_Z = ("no vertical acceleration in this log", "RAW_IMU at 50 Hz")
_NO_THETA = ("no attitude in this log", "ATTITUDE at 50 Hz")
_FEW = ("too few manoeuvres to see a change", "repeat the same manoeuvre early and late")
_NEEDS = {
    "thrust_moment": (
        "the throttle did not move, or is not logged",
        "move the throttle once; VFR_HUD at 10 Hz",
    ),
    "ground_effect": ("the height above ground did not change", "fly low and high; a range finder"),
    "alpha_bias": ("no climb rate in this log", "VFR_HUD at 10 Hz"),
    "accelerometer_offset": _NO_A_Z,
    "accelerometer_skew": _NO_A_Z,
    "alpha_scale": _NO_A_Z,
    "attitude_skew": _NO_THETA,
    "pitch_rate_bias": _NO_THETA,
    "airspeed_variation": ("the air speed is not logged, or hardly moved", "VFR_HUD at 10 Hz; two speeds"),
    "cg_shift": _FEW,
    "mass_change": _FEW,
    "icing": _FEW,
}


@dataclass(frozen=True, slots=True)
class Foreseen:
    """What a plan can do for one effect."""

    effect: str
    parameter: str
    smallest: float
    """Smallest size that can be told from nothing, in the parameter's unit; infinite when invisible."""
    confused_with: tuple[tuple[str, float], ...]
    """Other effects and the cosine between their marks in the data."""
    add: str = ""
    """Channel or manoeuvre that would tell it apart, or show it at all."""


def foresee(
    problem: Problem, fitted: Fitted, variants: Sequence[Variant], noise: FloatArray
) -> list[Foreseen]:
    """Smallest detectable size and confusions of every effect, at the fitted (or believed) model."""
    weights = 1.0 / noise
    marks: dict[str, FloatArray] = {}
    scale: dict[str, tuple[str, float]] = {}
    inverted: dict[str, bool] = {}
    shared = [
        _own_removed(problem, fitted, i, b.measured.shared, weights) for i, b in enumerate(fitted.linear)
    ]
    inverse = np.linalg.pinv(np.sum([J.T @ J for J in shared], axis=0), rcond=1e-12, hermitian=True)
    for variant in variants:
        if variant.effect in marks or variant.effect in {e.effect for e in fitted.point.effects}:
            continue
        start = tuple(variant.starts[0])
        point = fitted.point.with_effect(
            variant, start, np.zeros(len(problem.flights)) if variant.sides is not None else None
        )
        p = problem.driving(point)
        grids = [problem.fly(f, p[i]) for i, f in enumerate(problem.flights.flights)]
        k = len(fitted.point.shared)
        column = shared_columns(problem, point, p, grids, range(k, k + 1))
        mark = _projected(problem, fitted, [c[:, 0] for c in column], weights, shared, inverse)
        marks[variant.effect] = mark
        inverted[variant.effect] = variant.inverted
        scale[variant.effect] = (variant.names[0], float(np.linalg.norm(mark)))
    found = []
    for effect, (parameter, length) in scale.items():
        confused = [
            (other, float(abs(marks[effect] @ marks[other]) / (length * scale[other][1] + 1e-300)))
            for other in marks
            if other != effect and scale[other][1] > 0.0
        ]
        confused = sorted((c for c in confused if c[1] > 0.8), key=lambda c: -c[1])
        twins = [breaking(effect, other) for other, cosine in confused if cosine > CONFUSED_AT]
        add = "; ".join(dict.fromkeys(way for way in twins if way))
        smallest = DETECTED_AT / length if length > 1e-9 else float("inf")
        if inverted[effect]:
            smallest = 1.0 / smallest
        found.append(Foreseen(effect, parameter, smallest, tuple(confused[:3]), add))
    return found


def unseen_effects(
    problem: Problem, fitted: Fitted, variants: Sequence[Variant], noise: FloatArray, present: set[str]
) -> tuple[Unseen, ...]:
    """Effects this flight could not have shown, and why."""
    tried = {v.effect for v in variants} | {"alpha_bias", "airspeed_variation", "turbulence", "gust"}
    out = []
    if "climb_rate" not in problem.flights.has:
        tried.discard("alpha_bias")
    if not problem.flights.speed_measured or problem.flights.speed_moves < 0.03:
        tried.discard("airspeed_variation")
    for effect, (because, need) in _NEEDS.items():
        if effect not in tried and effect not in present:
            out.append(Unseen(effect, because, need))
    for seen in foresee(problem, fitted, variants, noise):
        twins = [name for name, cosine in seen.confused_with if cosine > CONFUSED_AT]
        if not np.isfinite(seen.smallest):
            because, need = _NEEDS.get(
                seen.effect, ("these channels do not show it", "ATTITUDE, RAW_IMU and VFR_HUD at 50 Hz")
            )
            out.append(Unseen(seen.effect, because, need))
        elif twins and seen.effect not in present:
            out.append(
                Unseen(seen.effect, f"looks like {', '.join(t.replace('_', ' ') for t in twins)} when small",
                       "another time unit, another amplitude, or the measured surface position")
            )  # fmt: skip
    return tuple(out)


def _own_removed(
    problem: Problem, fitted: Fitted, i: int, columns: FloatArray, weights: FloatArray
) -> FloatArray:
    """Weighted columns with what the manoeuvre's own numbers can mimic taken out."""
    block = fitted.linear[i]
    w = row_weights(problem, i, weights)[:, None]
    A, X = block.own * w, problem.innovations(i, columns) * w
    return np.asarray(X - A @ solved(factor(problem, i, block.own, block.prior, weights), A.T @ X))


def _projected(
    problem: Problem,
    fitted: Fitted,
    columns: Sequence[FloatArray],
    weights: FloatArray,
    shared: Sequence[FloatArray],
    inverse: FloatArray,
) -> FloatArray:
    """An effect's mark, with what the model's own numbers can mimic taken out."""
    parts = [_own_removed(problem, fitted, i, c[:, None], weights)[:, 0] for i, c in enumerate(columns)]
    step = inverse @ np.sum([J.T @ x for J, x in zip(shared, parts, strict=True)], axis=0)
    return np.concatenate([x - J @ step for J, x in zip(shared, parts, strict=True)])
