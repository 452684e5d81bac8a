"""Effects that a planned flight could show, and effects that a past flight could not have shown.

An effect is detectable if its signature has enough likelihood and enough change of the outputs.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from advisor.gap.candidates.distinguish import ONE_IMU, OTHERWISE, hidden_from, need_of, way_to_distinguish
from advisor.gap.decision import LEAST_GAIN
from advisor.gap.effects import EFFECTS
from advisor.gap.fitting.fit import EffectFit
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.foresight.signatures import Signatures
from advisor.gap.inference.explanation import least_apart
from advisor.gap.kit.variant import Variant
from advisor.gap.result import VISIBLE, Unseen, spelled
from advisor.gap.simulator.layout import INDEX
from advisor.process.arrays import FloatArray
from advisor.words.quantiles import NORMAL_95

CONFUSED_AT = 0.95
"""Cosine between two signatures above which one effect is confused with the other."""
_LISTED_AT = 0.8
_MOST_CONFUSIONS = 3
"""Words: least cosine of a listed similar effect, and the largest number of listed effects."""
_GROWTH, _CLOSE = 3.0, 0.02
"""Numerical: factor on a size without a signature, and relative difference of two sizes in a row at which the
refinement ends."""


@dataclass(frozen=True, slots=True)
class Foreseen:
    """Detectability of one effect in a planned flight."""

    effect: str
    parameter: str
    smallest: float
    """Smallest detectable size of the effect, in the parameter's unit; infinite for an undetectable
    effect."""
    confused_with: tuple[tuple[str, float], ...]
    """Effects with a similar signature, each with the cosine between the signatures."""
    add: str = ""
    """Channel or manoeuvre that would distinguish the effect, or make it visible."""
    is_limit: bool = False
    """Whether the effect is a limit, which is detectable if smaller than ``smallest``."""
    share: float | None = None
    """Smallest size of a nonlinear term as a share of the linear term, at the plan's amplitude."""


@dataclass(frozen=True)
class Signature:
    """Change of the outputs by one effect of unit size."""

    effect: str
    parameter: str
    vector: FloatArray
    least: float
    """Least size at which the effect is named."""
    most: float = float("inf")
    """Largest size of the effect that is sought."""
    numbers: int = 1
    """Number of the effect's parameters, each at the price of ½ ln N."""
    inverted: bool = False


def foresee(
    problem: EffectProblem,
    fitted: EffectFit,
    variants: Sequence[Variant],
    noise: FloatArray,
    others: Sequence[Signature] = (),
    rounds: int = 4,
) -> list[Foreseen]:
    """Return the smallest detectable size of every effect, and the effects with similar signatures.

    Parameters
    ----------
    noise
        Shape (channels,): noise of each channel, unless a filter knows the noise.
    others
        Signatures of effects that are no variants of the model.
    rounds
        Number of refinements of a size where the response is not proportional to it.
    """
    signatures = Signatures(problem, fitted, fitted.noise if problem.knows_the_noise else noise)
    present = {e.effect for e in fitted.point.effects}
    excluded = present | {signature.effect for signature in others}
    wanted = [v for v in _one_each(variants) if v.effect not in excluded]
    # Signed sizes at which the responses of the effects are first evaluated.
    sizes = [float(np.copysign(abs(v.starts[0][0]) or v.steps[0], _reach(v))) for v in wanted]
    seen = _responses(problem, fitted, list(zip(wanted, sizes, strict=True)))
    listed = [
        _signature_of(problem, fitted, signatures, variant, size, signatures.of(response), rounds)
        for variant, size, response in zip(wanted, sizes, seen, strict=True)
    ]
    listed += others
    shares = _shares(problem, fitted)
    return [_foreseen(signature, listed, signatures, shares) for signature in listed]


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
    for seen in foresee(problem, fitted, variants, noise, rounds=1):
        twins = [name for name, cosine in seen.confused_with if cosine > CONFUSED_AT]
        if not np.isfinite(seen.smallest):
            out.append(Unseen(seen.effect, *hidden_from(seen.effect, flights)))
        elif twins and seen.effect not in present:
            alike = " or ".join(map(spelled, twins))
            out.append(Unseen(seen.effect, f"when small it looks like {alike}", seen.add))
    if flights.alpha_is_derived:
        out = [unseen for unseen in out if not EFFECTS[unseen.effect].of_one_imu]
        hidden = [name for name, effect in EFFECTS.items() if effect.of_one_imu and name not in present]
        out += [Unseen(effect, *ONE_IMU) for effect in hidden]
    return tuple(out)


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


def _signature_of(
    problem: EffectProblem,
    fitted: EffectFit,
    signatures: Signatures,
    variant: Variant,
    size: float,
    vector: FloatArray,
    rounds: int,
) -> Signature:
    """Return the model's response to an effect, per unit of its first parameter."""
    # An effect whose search starts at zero is linear there; others are evaluated at their smallest size.
    reach = _reach(variant)
    numbers = len(variant.names)
    needed = _needed(signatures, numbers)
    for _ in range(rounds - 1 if variant.starts[0][0] else 0):
        just = max(signatures.smallest(vector, needed), variant.smallest)
        wanted = min(just if np.isfinite(just) else _GROWTH * abs(size), abs(reach))
        if abs(wanted - abs(size)) < _CLOSE * abs(size):
            break
        size = float(np.copysign(wanted, reach))
        vector = signatures.of(_responses(problem, fitted, [(variant, size)])[0])
    least, most = variant.smallest, abs(reach)
    return Signature(variant.effect, variant.names[0], vector, least, most, numbers, variant.inverted)


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


def _foreseen(
    signature: Signature,
    all_signatures: Sequence[Signature],
    signatures: Signatures,
    shares: Mapping[str, float],
) -> Foreseen:
    smallest = max(
        signatures.smallest(signature.vector, _needed(signatures, signature.numbers)), signature.least
    )
    if smallest > signature.most:
        smallest = float("inf")
    confused = sorted(
        (
            (other.effect, _cosine(signature.vector, other.vector))
            for other in all_signatures
            if other is not signature
        ),
        key=lambda pair: -pair[1],
    )
    confused = [pair for pair in confused if pair[1] > _LISTED_AT][:_MOST_CONFUSIONS]
    twins = [other for other, cosine in confused if cosine > CONFUSED_AT]
    ways = [way for way in (way_to_distinguish(signature.effect, other) for other in twins) if way]
    add = "; ".join(dict.fromkeys(ways)) or (OTHERWISE if twins else "")
    if not np.isfinite(smallest):
        add = "; ".join(dict.fromkeys([hidden_from(signature.effect, signatures.problem.flights)[1], *ways]))
    share = None
    if signature.parameter in shares and np.isfinite(smallest):
        share = smallest * shares[signature.parameter]
    size = 1.0 / smallest if signature.inverted and np.isfinite(smallest) else smallest
    return Foreseen(
        signature.effect, signature.parameter, size, tuple(confused), add, signature.inverted, share
    )


def _shares(problem: EffectProblem, fitted: EffectFit) -> Mapping[str, float]:
    """Return each nonlinear term as a share of its linear term, per size, at the plan's largest motion."""
    p = problem.driving(fitted.point)
    flights = problem.flights.flights
    reached = {
        "delta_e": max(float(np.max(np.abs(f.u - f.u_trim))) for f in flights),
        "alpha": max(
            float(np.max(np.abs(problem.fly(f, p[i])[0] - f.alpha_trim))) for i, f in enumerate(flights)
        ),
    }
    shares: dict[str, float] = {}
    for curve in [effect.curve for effect in EFFECTS.values() if effect.curve is not None]:
        for square in [term for term, power in curve.powers.items() if power == 2]:
            linear = abs(float(p[0, INDEX[curve.slope]]))
            shares |= {square: reached[curve.variable] / linear} if linear > 0.0 else {}
    return shares


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
