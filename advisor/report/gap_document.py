"""The ``advisor.gap/1`` document for scripts, and the next steps. Units are SI; a missing value is None,
never NaN.
"""

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.special import expit

from advisor.gap.alternative import AlternativeEvidence, Contribution, together
from advisor.gap.candidates.distinguish import way_to_distinguish
from advisor.gap.effects import EFFECTS
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
    spelled,
)
from advisor.gap.verdict.text import answers_of, in_words, limits_of
from advisor.oem.estimate import Estimate
from advisor.process.arrays import FloatArray
from advisor.process.parts import FailedPart
from advisor.report.document import terms_of, with_intervals
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
from advisor.report.facts.reasons import in_percent
from advisor.report.facts.sizes import short, sizes_of
from advisor.report.improved import improved_name
from advisor.words.certainty import Answers, doubt_of, is_decided
from advisor.words.plain import picked, plain
from advisor.words.problems import Problem

_PROVE = "Prove the change: {after} again, then on manoeuvres that no fit has used."
_FLY = "fly the same number of manoeuvres again, with another time unit and another amplitude"
_TELLS = 0.1
"""Absolute log odds of the fit, nats, below which repeated manoeuvres would not decide."""


@dataclass(frozen=True, slots=True)
class GapStep:
    """One step to take after a diagnosis."""

    text: str
    command: str = ""
    """Command line for the step; empty without a command."""


def next_steps(
    d: Diagnosis,
    logs: Sequence[str],
    aircraft_file: str | None,
    simulator: str | None = None,
    options: Sequence[str] = (),
    written: str | None = None,
) -> list[GapStep]:
    """Return the steps: a change of the simulator, its proof, and a test against the rival.

    Parameters
    ----------
    aircraft_file
        Aircraft file as the user gave it; None without one.
    simulator
        Specification of the simulator; None if the aircraft file's model is the simulator.
    written
        File of the improved simulator that already exists, so that no step writes it.
    """
    steps = []
    answers = answers_of(d.evidence)
    if doubt_of(answers):
        return [to_decide(answers, _way_of(d), d.why)]
    if what := _to_put(d):
        read = ["advisor", "gap", *logs, *options]
        better = written or improved_name(d, aircraft_file)
        write, proved, formats = _improvement(better, aircraft_file, simulator)
        if written is None:
            command = shlex.join([*read, *write]) if write else ""
            lacks = " what it lacks" if _effects_of(d) else ""
            put = f"Put into the simulator{lacks}" if d.derivatives else "Add to what the file states"
            steps.append(GapStep(f"{put}: {what}.{formats}", command))
        prove = shlex.join([*read, *proved])
        steps.append(GapStep(_PROVE.format(after=short(d.gap.after)), prove))
    if d.missing_law is not None and d.missing_law.term:
        aircraft = ["--aircraft", aircraft_file] if aircraft_file else []
        term = ["advisor", "analyze", *logs, *options, *aircraft, "--term", d.missing_law.term]
        steps.append(GapStep("Estimate the missing law as one more term:", shlex.join(term)))
    rival = _against_the_rival(d) if d.verdict != "none" else ""
    if rival:
        steps.append(GapStep(rival))
    return steps


def _improvement(
    better: str, aircraft_file: str | None, simulator: str | None
) -> tuple[list[str], list[str], str]:
    """Return the options that write and fly the improved simulator, and a sentence about other formats."""
    aircraft = ["--aircraft", aircraft_file] if aircraft_file else []
    kind, _, _ = (simulator or "linear").partition(":")
    if kind == "linear":
        linear = ["--simulator", "linear"] if simulator else []
        write = [*aircraft, *linear, "--out", better]
        return write, [*aircraft, *linear, "--prove"], " --export writes other formats."
    own = [*aircraft, "--simulator", str(simulator)]
    if kind != "jsbsim":
        return [], [*own, "--prove"], ""
    model = str(Path(better).with_suffix(".xml"))
    return [*own, "--export", f"jsbsim:{model}"], [*own, "--prove"], ""


def to_decide(answers: Answers, way: str = "", why: Sequence[Contribution] = ()) -> GapStep:
    """Return the flight that distinguishes the two likeliest answers, with the expected probability.

    Log odds add up, so an equal number of new manoeuvres adds the fit's log odds once more.
    """
    (ours, _), (other, _) = answers[:2]
    step = f"To separate {ours} from {other}: {way or _FLY}."
    fit = sum(part.nats for part in why if part.name == "fit")
    odds = sum(part.nats for part in why) + fit
    if abs(fit) < _TELLS:
        return GapStep(step)
    likelier, p = (ours, expit(odds)) if odds >= 0.0 else (other, expit(-odds))
    return GapStep(
        f"{step} The same number of manoeuvres is expected to raise {likelier} to {in_percent(p)} between "
        f"these two."
    )


def steps_to_decide(d: Diagnosis) -> list[GapStep]:
    """Return the flight that distinguishes the two likeliest answers; empty for a decided answer."""
    answers = answers_of(d.evidence)
    return [to_decide(answers, _way_of(d))] if answers and not is_decided(answers) else []


def _way_of(d: Diagnosis) -> str:
    """Return the measurement that distinguishes the two likeliest effects; empty if none is known."""
    shares = ((e.alternative, e.probability) for e in d.evidence)
    effects = {cause.name: cause.effect for cause in d.causes}
    ours, other = (effects.get(alternative.name, alternative.name) for alternative, _ in together(shares)[:2])
    return way_to_distinguish(ours, other) if {ours, other} <= EFFECTS.keys() else ""


def _to_put(d: Diagnosis) -> str:
    """Return the effects or derivatives to change in the improved simulator; empty if there are none.

    The list omits the air of the day, which no simulator should contain.
    """
    if not d.improves:
        return ""
    effects = [f"{spelled(c.effect)} {', '.join(sizes_of(c.parameters))}" for c in _effects_of(d)]
    numbers = [changed(derivative) for derivative in d.derivatives if derivative.differs]
    in_air = any(c.present and c.block == "air" for c in d.causes)
    return ", ".join(effects or numbers) or ("" if in_air else "the fitted derivatives")


def _effects_of(d: Diagnosis) -> list[Cause]:
    """Return the effects of the answer that a simulator can contain."""
    return [c for c in d.causes if c.present and c.block != "air"] if d.verdict == "effect" else []


def _against_the_rival(d: Diagnosis) -> str:
    """Return the measurement that distinguishes the answer from a similar effect, or shows a hidden one."""
    telling = next((c for c in d.causes if c.present and c.cannot_be_told_from and c.tell_apart_by), None)
    if telling is not None:
        rivals = " or ".join(map(spelled, telling.cannot_be_told_from))
        return f"To exclude {rivals}: {telling.tell_apart_by}."
    if d.verdict == "unknown":
        lists = "; advisor gap --all lists what to log" if d.cannot_see else ""
        return f"To find the cause: fly two more manoeuvres of other amplitude{lists}."
    hidden = next(iter(d.cannot_see), None)
    return f"To see {spelled(hidden.effect)} as well: {hidden.would_need}." if hidden is not None else ""


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
