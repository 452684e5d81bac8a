"""The ``advisor.gap/1`` document for scripts. Units are SI; a missing value is None, never NaN."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from advisor.gap.decision import Decision
from advisor.gap.result import Cause, Diagnosis, InSimulator, Qualification, Value, Yardsticks
from advisor.words.problems import Problem

SCHEMA = "advisor.gap/1"
_NOTHING: Mapping[str, Any] = {
    "verdict": None, "sentence": None, "maneuvers": [], "gap": None, "where": None, "causes": [],
    "shrink": None, "waterfall": [], "cannot_see": [], "model": None, "reference_airspeed_m_s": None,
    "alpha_check": None, "yardsticks": None, "notes": [], "improved_model": None,
    "share_irreducible": None, "decisions": [], "simulator": None, "qualification": None,
}  # fmt: skip
"""Keys and values of a document without a diagnosis."""


def gap_document(
    diagnosis: Diagnosis | None, problems: Sequence[Problem] = (), improved_model: str | None = None
) -> dict[str, Any]:
    """Build the document of ``advisor gap --json``; without a diagnosis it holds the problems alone."""
    document: dict[str, Any] = {
        "schema": SCHEMA,
        "usable": diagnosis is not None and not problems,
        "problems": [{"code": p.code, "text": p.text, "fix": p.fix} for p in problems],
        "exports": [],
    }
    if diagnosis is None:
        return {**document, **_NOTHING}
    d, gap = diagnosis, diagnosis.gap
    document |= {
        "verdict": None if d.verdict == "untested" else d.verdict,
        "sentence": d.sentence,
        "maneuvers": list(d.maneuvers),
        "gap": {
            "before": gap.before, "after": gap.after, "floor": dict(gap.floor), "floor_note": gap.floor_note,
            "by_channel": dict(gap.by_channel), "by_channel_after": dict(gap.by_channel_after),
            "by_maneuver": [{"number": n, "before": b, "after": a} for n, b, a in gap.by_maneuver],
            "by_phase": dict(gap.by_phase),
            "by_band_hz": [{"from_hz": a, "to_hz": b, "share": s} for a, b, s in gap.by_band_hz],
        },
        "where": {
            "block": d.where.block, "share": d.where.share,
            "ranking": [{"block": b, "score": s} for b, s in d.where.ranking],
        },
        "causes": [_cause(c) for c in d.causes],
        "shrink": None if d.shrink is None else {
            "holdout": list(d.shrink.holdout), "before": d.shrink.before, "after": d.shrink.after,
            "percent": d.shrink.percent, "ci95_percent": list(d.shrink.ci95_percent),
            "beyond_air_percent": d.shrink.beyond_air_percent,
            "by_numbers_percent": d.shrink.by_numbers_percent,
            "in_simulator": _in_simulator(d.in_simulator),
        },
        **_with_simulator(d.in_simulator),
        "waterfall": [{"effect": e, "after": a} for e, a in d.waterfall],
        "cannot_see": [
            {"effect": u.effect, "because": u.because, "would_need": u.would_need} for u in d.cannot_see
        ],
        "model": _values(d.model),
        "reference_airspeed_m_s": d.reference_airspeed_m_s,
        "alpha_check": {
            "finding": d.kinematics.finding, "text": d.kinematics.sentence, "lag_s": d.kinematics.lag_s,
            "lag_std_s": d.kinematics.lag_std_s, "scale": d.kinematics.scale,
            "bias_rad": d.kinematics.offset.rad,
        },
        "yardsticks": {
            c: {"before": _yardsticks(a), "after": _yardsticks(b)} for c, (a, b) in d.yardsticks.items()
        },
        "notes": list(d.notes),
        "improved_model": improved_model,
        "share_irreducible": d.share_irreducible,
        "decisions": [_decision(one) for one in d.decisions],
    }  # fmt: skip
    return {key: _without_nan(value) for key, value in document.items()}


def _decision(one: Decision) -> dict[str, Any]:
    return {
        "name": f"{one.about} {one.name}", "about": one.about, "statistic": one.statistic,
        "limit": one.limit, "margin": one.margin, "unit": one.unit, "holds": one.holds,
    }  # fmt: skip


def _cause(c: Cause) -> dict[str, Any]:
    return {
        "effect": c.effect, "block": c.block, "probability": c.probability,
        "parameters": _values(c.parameters),
        "cannot_be_told_from": list(c.cannot_be_told_from), "tell_apart_by": c.tell_apart_by,
        "gap_after": c.gap_after, "in_model": c.present,
    }  # fmt: skip


def _with_simulator(found: InSimulator | None) -> dict[str, Any]:
    """Return the user's simulator and its tolerances by channel, both None without a simulator."""
    if found is None:
        return {"simulator": None, "qualification": None}
    by_channel = {q.channel: _qualification(q) for q in found.qualification}
    return {"simulator": found.simulator, "qualification": by_channel}


def _in_simulator(found: InSimulator | None) -> dict[str, Any] | None:
    if found is None or found.after is None:
        return None
    return {
        "before": found.before, "after": found.after, "percent": found.percent,
        "on_paper": list(found.on_paper),
    }  # fmt: skip


def _qualification(q: Qualification) -> dict[str, Any]:
    return {
        "limit": q.limit, "before": q.before, "after": q.after, "pass_before": q.passes_before,
        "pass": q.passes_before if q.after is None else q.passes_after,
        "theil_before": q.theil[0], "theil_after": q.theil[1],
    }  # fmt: skip


def _values(values: Mapping[str, Value]) -> dict[str, dict[str, float]]:
    return {name: {"value": v.value, "std": v.std} for name, v in values.items()}


def _yardsticks(y: Yardsticks) -> dict[str, float | None]:
    return {"theil": y.theil, "bias": y.bias, "variance": y.variance, "covariance": y.covariance,
            "r2": y.r2, "within_tolerance": y.within_tolerance}  # fmt: skip


def _without_nan(value: Any) -> Any:
    if isinstance(value, dict):
        return {k: _without_nan(v) for k, v in value.items()}
    if isinstance(value, list):
        return [_without_nan(v) for v in value]
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    return value
