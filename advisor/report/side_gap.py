"""The gap of roll and yaw: its document in SI units, and its text."""

import math
from collections.abc import Iterator
from typing import Any

from advisor.gap.alternative import Weighed
from advisor.gap.axes.lateral.comparison import SideGap
from advisor.gap.axes.lateral.diagnosis import SideDiagnosis
from advisor.gap.axes.lateral.flight import LIKELY
from advisor.gap.candidates.distinguish import way_to_distinguish
from advisor.gap.verdict.text import title_of_verdict
from advisor.report.facts.gap import changes, counted
from advisor.report.facts.reasons import how_sure, in_percent
from advisor.report.facts.sizes import named, sizes_of, with_error
from advisor.report.gap_document import changed_document, gap_document, traces_document, weighed_document
from advisor.report.gap_steps import GapStep, to_decide
from advisor.words.certainty import is_decided
from advisor.words.plain import picked, plain


def side_gap_lines(found: SideGap) -> Iterator[str]:
    """Yield the sentence, the causes, each stated derivative with the flight's, instruments, and the gap."""
    yield f"{_title(found)}: {found.sentence}"
    if found.diagnosis is not None and found.verdict is not None:
        yield f"  {how_sure(found.diagnosis.answers)}"
        yield from _diagnosis_lines(found.diagnosis)
    yield from (f"! {part.sentence}" for part in (found.diagnosis.failed if found.diagnosis else ()))
    yield from (f"  {line}" for line in changes(found.derivatives))
    if found.instruments:
        yield "Nuisance parameters of the fit, no part of the answer:"
    yield from (f"  {named(name)} {with_error(name, one)}" for name, one in found.instruments.items())
    gap = found.diagnosis
    if gap is not None and gap.after and found.verdict is not None:
        numbers = counted(found.maneuvers)
        yield f"Gap on manoeuvres {numbers}, each held out in turn, mean square over noise, minus 1:"
        for name, before in gap.before.items():
            yield f"  {name:<5} {before:8.2f} before, {gap.after[name]:.2f} after"


def _title(found: SideGap) -> str:
    return title_of_verdict(
        found.verdict or "untested", found.diagnosis.answers if found.diagnosis is not None else ()
    )


def _to_decide(found: SideDiagnosis | None) -> GapStep | None:
    """Return the flight that separates the two likeliest answers; None for a decided answer."""
    if found is None or is_decided(found.answers):
        return None
    named = {one.named: one.cause.effect for one in found.causes}
    ours, other = (named.get(words) for words, _ in found.answers[:2])
    return to_decide(found.answers, way_to_distinguish(ours, other) if ours and other else "")


def _diagnosis_lines(found: SideDiagnosis) -> Iterator[str]:
    """Yield each likely effect with its size and with the errors that it removes."""
    for one in found.causes:
        if one.cause.probability >= LIKELY:
            sizes = "; ".join(sizes_of(one.cause.parameters))
            yield f"  {one.named}: {sizes} ({in_percent(one.cause.probability)})"
            for name, before in found.peaks.items():
                after, least = (math.degrees(peaks[name]) for peaks in (one.peaks, found.peaks_by_numbers))
                yield (
                    f"    largest error of {name}: {math.degrees(before):.2f} → {after:.2f} deg/s "
                    f"({least:.2f} by fitted derivatives alone)"
                )
    for what, why in found.cannot_see.items():
        yield f"  cannot be seen: {what}, for {why}"
    if step := _to_decide(found):
        yield step.text


def whole_document(found: SideGap) -> dict[str, Any]:
    """Return the document ``advisor.gap/1`` of roll and yaw alone, with its other blocks empty."""
    failed = found.diagnosis.failed if found.diagnosis is not None else ()
    return gap_document(None, failed=failed) | {"usable": True, "lateral": side_gap_document(found)}


def side_gap_document(found: SideGap) -> dict[str, Any]:
    """Return the block ``lateral`` of ``advisor gap --json``, in SI units."""
    gap = found.diagnosis
    mean = gap and gap.mean_gap
    size = {"before": mean and mean[0], "after": mean and mean[1]}
    document: dict[str, Any] = plain({
        **picked(found, "verdict sentence maneuvers not_identifiable"),
        "title": _title(found),
        "next": [] if (step := _to_decide(found.diagnosis)) is None else [step],
        "gap": {
            "before": size["before"],
            "by_channel": gap.before if gap and mean else {},
            "by_channel_after": gap.after if gap and mean else {},
            "floor": gap.floor if gap else {},
            "by_maneuver": [
                {"number": number, "before": before, "after": after}
                for number, (before, after) in zip(found.maneuvers, gap.by_maneuver, strict=True)
            ]
            if gap
            else [],
        },
        "parameters_changed": [changed_document(one) for one in found.derivatives if one.differs],
        "parameters_compared": [changed_document(one) for one in found.derivatives],
        "instruments": {n: {"value": v.value, "std": v.std} for n, v in found.instruments.items()},
        "shrink": mean and {"holdout": list(found.maneuvers), **size, "percent": gap and gap.shrink_percent},
        **_diagnosis_document(found.diagnosis),
    })  # fmt: skip
    if found.verdict is None:  # nothing was weighed against a simulator
        document["how_sure"] = ""
    return document | {"traces": traces_document(found.traces)}


def _diagnosis_document(found: SideDiagnosis | None) -> dict[str, Any]:
    """Return probabilities, causes and largest errors, rad/s; without a diagnosis only the keys."""
    if found is None:
        return {
            **weighed_document(Weighed()), "where": None, "causes": [], "waterfall": [], "peaks": None,
            "cannot_see": {},
        }  # fmt: skip
    where = found.where
    return {
        **weighed_document(found),
        "where": where
        and {
            **picked(where, "block share"),
            "ranking": [{"block": block, "score": score} for block, score in where.ranking],
        },
        "causes": [
            {
                **picked(one.cause, "effect block probability present parameters"),
                **picked(one, "of name sentence peaks"),
                "held_out_nats": {"value": one.gain.total, "std": one.gain.std},
            }
            for one in found.causes
        ],
        "waterfall": [{"effect": name, "after": after} for name, after in found.waterfall],
        "peaks": {"simulator": found.peaks, "fitted_derivatives": found.peaks_by_numbers},
        "cannot_see": found.cannot_see,
    }
