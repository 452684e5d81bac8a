"""The ``advisor.gap/1`` document for scripts. Units are SI; a missing value is None, never NaN."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from advisor.gap.alternative import AlternativeEvidence
from advisor.gap.result import (
    Cause,
    ComparedDerivative,
    Diagnosis,
    Gap,
    InSimulator,
    MissingLaw,
    Qualification,
    Shrink,
    Trace,
    Where,
)
from advisor.gap.verdict.text import answers_of, in_words, limits_of
from advisor.oem.estimate import Estimate
from advisor.process.arrays import FloatArray
from advisor.process.parts import FailedPart
from advisor.report.axis_document import terms_of, with_intervals
from advisor.report.facts.answers import sure_of, title_of
from advisor.report.facts.gap import (
    changed,
    grown_said,
    heading,
    law_said,
    shrink_said,
    size_of_gap,
    where_said,
)
from advisor.report.facts.sizes import sizes_of
from advisor.report.gap_steps import steps_to_decide
from advisor.words.certainty import is_decided
from advisor.words.plain import picked, plain
from advisor.words.problems import Problem

SCHEMA = "advisor.gap/1"
NOTHING: Mapping[str, Any] = {
    "verdict": None, "title": None, "sentence": None, "limits": [], "maneuvers": [], "gap": None,
    "where": None, "causes": [], "shrink": None, "waterfall": [], "cannot_see": [], "model": None,
    "reference_airspeed_m_s": None, "alpha_check": None, "yardsticks": None, "notes": [],
    "improved_model": None, "parameters_changed": [], "traces": [], "share_irreducible": None,
    "decisions": [], "simulator": None, "qualification": None, "static": [], "trims": [],
    "probabilities": None, "evidence": [], "why": [], "answer": None, "decided": None,
    "rival": None, "missing_law": None, "how_sure": "", "why_heading": "",
}  # fmt: skip
"""Keys and values of a document without a diagnosis."""


def gap_document(
    diagnosis: Diagnosis | None,
    problems: Sequence[Problem] = (),
    failed: Sequence[FailedPart] = (),
) -> dict[str, Any]:
    """Return the document of ``advisor gap --json``; without a diagnosis it contains only problems.

    A log whose diagnosis failed because of a program error (``failed``) is still usable.
    """
    document: dict[str, Any] = {
        "schema": SCHEMA,
        "usable": not problems and (diagnosis is not None or bool(failed)),
        "problems": [*plain(problems), *(part.entry for part in failed)],
        "exports": [],
        "next": [],
    }
    if diagnosis is None:
        return {**document, **NOTHING}
    document["problems"] += [part.entry for part in diagnosis.failed]
    if diagnosis.axis == "lateral":
        return {**document, **NOTHING, "lateral": axis_document(diagnosis)}
    return document | axis_document(diagnosis) | {"improved_model": None}


def axis_document(d: Diagnosis) -> dict[str, Any]:
    """Return the document part about one axis. Without a fit the part has no evidence."""
    tested = d.verdict != "untested"
    document: dict[str, Any] = NOTHING | plain({
        "verdict": d.verdict if tested else None,
        "title": title_of(d),
        **picked(d, "sentence maneuvers cannot_see notes reference_airspeed_m_s share_irreducible"),
        "causes": [cause_document(c) for c in d.causes],
        "waterfall": [{"effect": e, "after": a} for e, a in d.waterfall],
        "missing_law": d.missing_law and missing_law_document(d.missing_law),
        "parameters_changed": [changed_document(c) for c in d.derivatives if c.differs],
        "traces": traces_document(d.traces),
    })  # fmt: skip
    if d.gap.by_channel:
        document |= plain(numbers_document(d.verdict, d.gap, d.where, d.shrink)) | plain(weighed_document(d))
    document |= plain(_of_pitch(d) if d.axis == "pitch" else _of_the_sides(d))
    if d.structured is not None:
        document["model"] = (document["model"] or {}) | structure_of(d.structured)
    if d.shrink is not None:
        document["shrink"]["in_simulator"] = plain(_in_simulator(d.in_simulator))
    return document


def _of_pitch(d: Diagnosis) -> dict[str, Any]:
    """Return the keys about the user's simulator, the air data and the fidelity measures."""
    return {
        "limits": list(limits_of(d)),
        "model": d.model,
        **_of_the_simulator(d),
        "alpha_check": d.kinematics and {
            **picked(d.kinematics, "finding lag_s lag_std_s scale"),
            "text": d.kinematics.sentence, "bias_rad": d.kinematics.offset.rad,
        },
        "yardsticks": {c: {"before": a, "after": b} for c, (a, b) in d.yardsticks.items()},
    }  # fmt: skip


def _of_the_sides(d: Diagnosis) -> dict[str, Any]:
    """Return the keys about the nuisance parameters and the derivatives that no manoeuvre shows."""
    return {
        **picked(d, "not_identifiable instruments"),
        "next": steps_to_decide(d),
        "parameters_compared": [changed_document(c) for c in d.derivatives],
        "peaks": d.peaks or None,
    }


def missing_law_document(law: MissingLaw) -> dict[str, Any]:
    """Return the document part about the missing force or moment that no candidate explains, SI."""
    return {
        "text": law_said(law),
        **picked(law, "equation variable share nearest runner_up term"),
        "coefficient": picked(law.coefficient, "value std"),
        "curve": [[x, y] for x, y, _ in law.curve],
        "band": [[y - half, y + half] for _, y, half in law.curve],
    }


def structure_of(estimate: Estimate) -> dict[str, Any]:
    """Return the entries of the parameters that the user holds and of the terms that the user adds."""
    held = {name: entry for name, entry in with_intervals(estimate).items() if name in estimate.fixed}
    return held | terms_of(estimate)


def numbers_document(verdict: str, gap: Gap, where: Where, shrink: Shrink | None) -> dict[str, Any]:
    """Return the document part about the size, the place and the reduction of a gap, for every axis."""
    return {
        "gap": {
            "text": size_of_gap(verdict, gap),
            "grown": grown_said(verdict, gap),
            **picked(gap, "before after floor floor_note by_channel by_channel_after by_phase"),
            "by_maneuver": [{"number": n, "before": b, "after": a} for n, b, a in gap.by_maneuver],
            "by_band_hz": [{"from_hz": a, "to_hz": b, "share": s} for a, b, s in gap.by_band_hz],
        },
        "where": None
        if not where.block
        else {
            "text": where_said(where, shrink),
            **picked(where, "block share"),
            "ranking": [{"block": b, "score": s} for b, s in where.ranking],
        },
        "shrink": shrink and {**plain(shrink), "text": shrink_said(shrink, gap), "in_simulator": None},
    }


def weighed_document(d: Diagnosis) -> dict[str, Any]:
    """Return the document part with the probability and the evidence of each alternative, and with the
    reasons.
    """
    answers = answers_of(d.evidence)
    return {
        "how_sure": sure_of(d),
        "probabilities": d.probabilities,
        "evidence": [_evidence(e) for e in d.evidence],
        "why_heading": heading(d),
        "why": [{"name": c.name, "nats": c.nats, "text": c.sentence} for c in d.why],
        "answer": d.answer and d.answer.label,
        "decided": is_decided(answers),
        "rival": d.rival or None,
        "decisions": [
            {"name": f"{test.about} {test.name}", **picked(test, "about statistic limit margin unit holds")}
            for test in d.decisions
        ],
    }


def _of_the_simulator(d: Diagnosis) -> dict[str, Any]:
    """Return the document part about the simulator: description, trim and qualification."""
    inside = d.in_simulator
    return {
        "simulator": inside and inside.simulator,
        "qualification": inside and {q.channel: _qualification(q) for q in inside.qualification},
        **picked(d, "static trims"),
    }


def changed_document(derivative: ComparedDerivative) -> dict[str, Any]:
    """Return the document part about one derivative, with the simulator's and the flight's value."""
    return {
        "text": changed(derivative),
        "derivative": derivative.name,
        "simulator": derivative.given,
        "found": derivative.found.value,
        "ci95": [derivative.found.value - derivative.half, derivative.found.value + derivative.half],
        "percent": derivative.percent,
    }


def traces_document(traces: Sequence[Trace]) -> list[dict[str, Any]]:
    """Return the document part ``traces``: the curves of every output and manoeuvre, SI."""
    return [
        {
            **picked(trace, "number channel t"),
            **{name: _as_logged(getattr(trace, name)) for name in ("measured", "before", "after")},
        }
        for trace in traces
    ]


def _as_logged(samples: FloatArray) -> list[float]:
    """Return samples rounded to the digits that a log stores."""
    return [float(str(value)) for value in samples.astype(np.float32)]


def cause_document(c: Cause) -> dict[str, Any]:
    """Return the document part about one candidate cause, for every axis."""
    said = picked(c, "effect block probability parameters cannot_be_told_from tell_apart_by gap_after")
    placed = {}
    if c.named:
        placed = {**picked(c, "of name sentence peaks present"), "held_out_nats": plain(c.gain)}
    return {**said, "text": ", ".join(sizes_of(c.parameters)), "in_model": c.present, **placed}


def _evidence(evidence: AlternativeEvidence) -> dict[str, Any]:
    return {
        "alternative": evidence.alternative.label, **picked(evidence.alternative, "kind name block"),
        "text": in_words(evidence.alternative),
        "probability": evidence.probability,
        "columns": [picked(column, "name value unit") for column in evidence.columns],
    }  # fmt: skip


def _in_simulator(in_simulator: InSimulator | None) -> Any:
    if in_simulator is None or in_simulator.after is None:
        return None
    return picked(in_simulator, "before after percent on_paper maneuvers after_air_and_instruments")


def _qualification(q: Qualification) -> dict[str, Any]:
    return {
        **picked(q, "limit before after"),
        "pass_before": q.passes_before,
        "pass": q.passes_before if q.after is None else q.passes_after,
        "theil_before": q.theil[0], "theil_after": q.theil[1],
    }  # fmt: skip
