"""The gap of roll and yaw: its document in SI units, and its text."""

import math
from collections.abc import Iterator
from typing import Any

from advisor.gap.axes.lateral.comparison import SideGap
from advisor.gap.axes.lateral.diagnosis import SideDiagnosis
from advisor.gap.axes.lateral.flight import LIKELY
from advisor.gap.candidates.distinguish import way_to_distinguish
from advisor.gap.result import spelled
from advisor.report.facts.answers import by_flight_alone, title_of_verdict
from advisor.report.facts.gap import changes, grown_said, shrink_said, size_of_gap
from advisor.report.facts.reasons import how_sure, in_percent
from advisor.report.facts.sizes import WORSE, named, sizes_of, with_error
from advisor.report.gap_document import (
    NOTHING,
    cause_document,
    changed_document,
    gap_document,
    numbers_document,
    traces_document,
    weighed_document,
)
from advisor.report.gap_steps import GapStep, to_decide
from advisor.words.certainty import is_decided
from advisor.words.plain import picked, plain


def side_gap_lines(found: SideGap) -> Iterator[str]:
    """Yield the sentence, the causes, each stated derivative with the flight's, instruments, and the gap."""
    yield f"{_title(found)}: {found.sentence}"
    is_none = found.verdict == "none"
    if found.diagnosis is not None and found.verdict is not None:
        yield f"  {how_sure(found.diagnosis.answers, by_flight_alone(found.diagnosis.evidence))}"
        yield from () if is_none else _diagnosis_lines(found.diagnosis)
    yield from (f"! {part.sentence}" for part in (found.diagnosis.failed if found.diagnosis else ()))
    yield from (f"  {line}" for line in changes(found.derivatives))
    if found.instruments:
        yield "Nuisance parameters of the fit, no part of the answer:"
    yield from (f"  {named(name)} {with_error(name, one)}" for name, one in found.instruments.items())
    if found.diagnosis is not None and found.verdict is not None:
        gap, shrink = found.diagnosis.gap, found.diagnosis.shrink
        size = size_of_gap(found.verdict, gap)
        yield f"{size[0].upper()}{size[1:]}"
        if shrink is not None and not is_none:
            yield f"  {shrink_said(shrink, gap)}"
        if grown := grown_said(found.verdict, gap):
            yield f"  {WORSE} {grown}"
        for name, before in gap.by_channel.items():
            after = gap.by_channel_after[name]
            yield f"  {name:<5} {before:8.2f} before{'' if math.isnan(after) else f', {after:.2f} after'}"


def _title(found: SideGap) -> str:
    return title_of_verdict(
        found.verdict or "untested", found.diagnosis.evidence if found.diagnosis is not None else ()
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
    for hidden in found.cannot_see:
        yield f"  cannot be seen: {spelled(hidden.effect)}, for {hidden.because}"
    if step := _to_decide(found):
        yield step.text


def whole_document(found: SideGap) -> dict[str, Any]:
    """Return the document ``advisor.gap/1`` of roll and yaw alone, with its other blocks empty."""
    failed = found.diagnosis.failed if found.diagnosis is not None else ()
    return gap_document(None, failed=failed) | {"usable": True, "lateral": side_gap_document(found)}


def side_gap_document(found: SideGap) -> dict[str, Any]:
    """Return the block ``lateral`` of ``advisor gap --json``, in SI units, with the keys of pitch."""
    document: dict[str, Any] = NOTHING | plain({
        **picked(found, "verdict sentence maneuvers not_identifiable"),
        "title": _title(found),
        "next": [] if (step := _to_decide(found.diagnosis)) is None else [step],
        "parameters_changed": [changed_document(one) for one in found.derivatives if one.differs],
        "parameters_compared": [changed_document(one) for one in found.derivatives],
        "instruments": {n: {"value": v.value, "std": v.std} for n, v in found.instruments.items()},
        "peaks": None,
        **_diagnosis_document(found),
    })  # fmt: skip
    if found.verdict is None:  # nothing was weighed against a simulator
        document["how_sure"] = ""
    return document | {"traces": traces_document(found.traces)}


def _diagnosis_document(found: SideGap) -> dict[str, Any]:
    """Return the gap, probabilities, causes and largest errors, rad/s; nothing without a diagnosis."""
    d = found.diagnosis
    if d is None:
        return {}
    return {
        **numbers_document(found.verdict or "untested", d.gap, d.where, d.shrink),
        **weighed_document(d),
        "causes": [
            {
                **cause_document(one.cause),
                **picked(one, "of name sentence peaks"), "present": one.cause.present,
                "gap_after": dict(d.waterfall).get(one.name),
                "held_out_nats": {"value": one.gain.total, "std": one.gain.std},
            }
            for one in d.causes
        ],
        "waterfall": [{"effect": name, "after": after} for name, after in d.waterfall],
        "peaks": {"simulator": d.peaks, "fitted_derivatives": d.peaks_by_numbers},
        "cannot_see": d.cannot_see,
    }  # fmt: skip
