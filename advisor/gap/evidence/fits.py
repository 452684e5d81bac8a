"""The columns of full fits: of single effects, and of sets that were fitted together."""

import numpy as np

from advisor.gap.evidence.measured import FullFit, Measured

Values = dict[str, float]
WEIGHTY = 20.0
"""Numerical: least gain in log likelihood, nats, to which others are relative. Chance decides below it."""


def of_fit(m: Measured, effect: str) -> Values:
    """Return the full fit of an effect, and its part in the final model."""
    fit = m.fitted.get(effect, m.added.get(effect))
    return {} if fit is None else _fitted(m, fit) | _of_model(m, effect)


def of_set(m: Measured, effects: tuple[str, str]) -> Values:
    """Return the joint fit of a set, and the part of its effects in the final model."""
    return _fitted(m, m.sets[effects]) | _of_model(m, *effects)


def _of_model(m: Measured, *effects: str) -> Values:
    """Return the gain of effects of the final model, and their share in what all of its effects remove."""
    if not (inside := [m.added[name] for name in effects if name in m.added]):
        return {}
    removed, total = (sum(max(one.removed, 1e-6) for one in some) for some in (inside, m.added.values()))
    return {"model_gain": sum(one.gain for one in inside), "model_share": removed / total}


def _fitted(m: Measured, fit: FullFit) -> Values:
    gain, error = _held_out_gain(m, fit)
    misfit = np.maximum(fit.power - 1.0, 0.0)
    best = max([*(other.gain for other in (*m.fitted.values(), *m.sets.values())), WEIGHTY])
    removed = float(np.clip(1.0 - fit.gap / m.base_gap, -1.0, 1.0)) if m.base_gap > 0 else 0.0
    return {f"misfit_{name}": float(x) for name, x in zip(m.channels, misfit, strict=True)} | {
        "fit_gain": fit.gain, "fit_share": max(fit.gain, 0.0) / best,
        "heldout_gain": gain, "heldout_sigmas": gain / max(error, 1e-9),
        "support": float(np.clip(fit.support, -1e3, 1e3)), "gap_removed": removed, "change": fit.change,
        "size_sigmas": fit.sigmas, "size": fit.size, "at_bound": float(fit.at_bound),
        "misfit": float(np.max(misfit)),
    }  # fmt: skip


def _held_out_gain(m: Measured, fit: FullFit) -> tuple[float, float]:
    """Return the gain in log likelihood on held-out manoeuvres, and its standard error over manoeuvres."""
    noise = np.maximum(np.average(fit.by_maneuver, axis=0, weights=np.maximum(m.samples, 1e-9)), 1e-12)
    each = np.sum(0.5 * m.samples * (m.base_held - fit.by_maneuver) / noise, axis=1)
    n = len(each)
    error = float(np.std(each, ddof=1)) * np.sqrt(n) if n > 1 else float(abs(each[0]))
    return float(np.sum(each)), error
