"""Effects that a flight could not have shown.

An effect is detectable if its signature has enough likelihood and enough change of the outputs.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from advisor.gap.candidates.distinguish import ONE_IMU, OTHERWISE, hidden_from, need_of, way_to_distinguish
from advisor.gap.decision import LEAST_GAIN
from advisor.gap.effects import EFFECTS
from advisor.gap.fitting.fit import EffectFit
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.foresight.signatures import Signatures
from advisor.gap.inference.explanation import least_apart
from advisor.gap.kit.effect import Variant
from advisor.gap.result import VISIBLE, Unseen, spelled
from advisor.process.arrays import FloatArray
from advisor.words.quantities import NORMAL_95

CONFUSED_AT = 0.95
"""Cosine between two signatures above which one effect is confused with the other."""
_MOST_CONFUSIONS = 3
"""Words: largest number of effects that are listed as similar to one effect."""


@dataclass(frozen=True, slots=True)
class _Signature:
    """Change of the outputs by one effect of unit size, in a flight."""

    effect: str
    vector: FloatArray
    is_visible: bool
    """Whether the flight would show the effect at its largest size."""


def unseen_effects(
    problem: EffectProblem,
    fitted: EffectFit,
    variants: Sequence[Variant],
    noise: FloatArray,
    present: set[str],
) -> tuple[Unseen, ...]:
    """Return the effects that this flight could not have shown, each with the reason."""
    flights = problem.flights
    tried = {v.effect for v in variants} | present
    tried |= {e.name for e in EFFECTS.values() if e.outside_fits is not None and e.outside_fits(flights)}
    needed = {
        name: need_of(name, flights)
        for name, effect in EFFECTS.items()
        if effect.need is not None and name not in tried
    }
    out = [Unseen(effect, need.because, need.add) for effect, need in needed.items()]
    signatures = _signatures(problem, fitted, variants, noise)
    for signature in signatures:
        twins = _twins(signature, signatures)
        if not signature.is_visible:
            out.append(Unseen(signature.effect, *hidden_from(signature.effect, flights)))
        elif twins and signature.effect not in present:
            alike = " or ".join(map(spelled, twins))
            ways = [way for twin in twins if (way := way_to_distinguish(signature.effect, twin))]
            would_need = "; ".join(dict.fromkeys(ways)) or OTHERWISE
            out.append(Unseen(signature.effect, f"when small it looks like {alike}", would_need))
    if flights.alpha_is_derived:
        out = [unseen for unseen in out if not EFFECTS[unseen.effect].of_one_imu]
        hidden = [name for name, effect in EFFECTS.items() if effect.of_one_imu and name not in present]
        out += [Unseen(effect, *ONE_IMU) for effect in hidden]
    return tuple(out)


def _signatures(
    problem: EffectProblem, fitted: EffectFit, variants: Sequence[Variant], noise: FloatArray
) -> list[_Signature]:
    """Return the signature of every effect that the fitted model lacks.

    ``noise``, shape (channels,), is the noise of each channel unless a filter knows the noise.
    """
    signatures = Signatures(problem, fitted, fitted.noise if problem.knows_the_noise else noise)
    in_model = {e.effect for e in fitted.point.effects}
    wanted = [v for v in _one_each(variants) if v.effect not in in_model]
    # Signed sizes at which the responses of the effects are evaluated.
    sizes = [float(np.copysign(abs(v.starts[0][0]) or v.steps[0], _reach(v))) for v in wanted]
    responses = _responses(problem, fitted, list(zip(wanted, sizes, strict=True)))
    listed = []
    for variant, response in zip(wanted, responses, strict=True):
        vector = signatures.of(response)
        smallest = signatures.smallest(vector, _needed(signatures, len(variant.names)))
        is_visible = bool(np.isfinite(smallest)) and smallest <= abs(_reach(variant))
        listed.append(_Signature(variant.effect, vector, is_visible))
    return listed


def _twins(one: _Signature, signatures: Sequence[_Signature]) -> list[str]:
    """Return the effects with which an effect is confused, the most similar first."""
    cosines = [(_cosine(one.vector, x.vector), x.effect) for x in signatures if x is not one]
    alike = sorted((pair for pair in cosines if pair[0] > CONFUSED_AT), key=lambda pair: -pair[0])
    return [effect for _, effect in alike[:_MOST_CONFUSIONS]]


def _one_each(variants: Sequence[Variant]) -> list[Variant]:
    """Return one variant of each effect; among steps at several places, the middle one."""
    groups: dict[str, list[Variant]] = {}
    for v in variants:
        groups.setdefault(v.effect, []).append(v)
    steps = {effect: [v for v in group if "at_s" in v.fixed] for effect, group in groups.items()}
    return [
        steps[effect][len(steps[effect]) // 2] if steps[effect] else group[0]
        for effect, group in groups.items()
    ]


def _reach(variant: Variant) -> float:
    """Return the largest signed size for which an effect is sought."""
    low, high = variant.bounds[0]
    return high if high >= -low or variant.starts[0][0] > 0.0 else low


def _responses(
    problem: EffectProblem, fitted: EffectFit, sized: Sequence[tuple[Variant, float]]
) -> list[list[FloatArray]]:
    """Return for each effect the change of every manoeuvre's channels, shape (rows,), per unit of size."""
    driving = []
    for variant, size in sized:
        sides = np.zeros(len(problem.flights)) if variant.sides is not None else None
        rest = variant.starts[0][1:]
        driving += [
            problem.driving(fitted.point.with_effect(variant, (value, *rest), sides)) for value in (size, 0.0)
        ]
    changes: list[list[FloatArray]] = [[] for _ in sized]
    for i, flight in enumerate(problem.flights.flights):
        # All effects at once, because the simulations of a manoeuvre share packs.
        seen = problem.fly_and_read(flight, np.stack([p[i] for p in driving]))
        for k, (_, size) in enumerate(sized):
            changes[k].append((seen[:, 2 * k] - seen[:, 2 * k + 1]) / size)
    return changes


def _needed(signatures: Signatures, numbers: int) -> float:
    """Return the least power of a signature for near-sure detection and enough change of the outputs."""
    price = numbers * float(np.log(signatures.rows))
    # A filter of moving air leaves far less of a change than the outputs show.
    change = 0.0 if signatures.filtered else _least_change(signatures.problem) * signatures.rows
    return max(float(np.sqrt(2.0 * LEAST_GAIN) + NORMAL_95) ** 2, 2.0 * LEAST_GAIN + price, change)


def _cosine(a: FloatArray, b: FloatArray) -> float:
    lengths = float(np.linalg.norm(a) * np.linalg.norm(b))
    return abs(float(a @ b)) / lengths if lengths > 0.0 else 0.0


def _least_change(problem: EffectProblem) -> float:
    """Return the least mean square change of the outputs for a named effect, over the noise."""
    # A low-order effect describes an output only within a share of the channel's peak.
    if problem.instruments is None:
        return VISIBLE
    least = least_apart(LEAST_GAIN)
    return max(VISIBLE, float(least**2 / np.mean((problem.instruments / problem.flights.peaks) ** 2)))
