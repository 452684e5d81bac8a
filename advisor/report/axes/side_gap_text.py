"""The gap of roll and yaw as text."""

import math
from collections.abc import Iterator

from advisor.gap.axes.lateral.flight import LIKELY
from advisor.gap.result import Diagnosis, spelled
from advisor.gap.verdict.text import answers_of
from advisor.report.facts.answers import by_flight_alone, title_of
from advisor.report.facts.estimates import structure_lines
from advisor.report.facts.gap import changes, grown_said, shrink_said, size_of_gap
from advisor.report.facts.reasons import how_sure, in_percent
from advisor.report.facts.sizes import WORSE, named, sizes_of, with_error
from advisor.report.gap_steps import steps_to_decide


def side_gap_lines(d: Diagnosis) -> Iterator[str]:
    """Yield the sentence, the causes, each stated derivative with the flight's, instruments, and the gap."""
    yield f"{title_of(d)}: {d.sentence}"
    tested, is_none = d.verdict != "untested", d.verdict == "none"
    if tested:
        yield f"  {how_sure(answers_of(d.evidence), by_flight_alone(d.evidence))}"
        yield from () if is_none else _causes(d)
    yield from structure_lines(d.structured) if d.structured is not None else ()
    yield from (f"! {part.sentence}" for part in d.failed)
    yield from (f"  {line}" for line in changes(d.derivatives))
    if d.instruments:
        yield "Nuisance parameters of the fit, no part of the answer:"
    yield from (f"  {named(name)} {with_error(name, value)}" for name, value in d.instruments.items())
    if tested:
        size = size_of_gap(d.verdict, d.gap)
        yield f"{size[0].upper()}{size[1:]}"
        if d.shrink is not None and not is_none:
            yield f"  {shrink_said(d.shrink, d.gap)}"
        if grown := grown_said(d.verdict, d.gap):
            yield f"  {WORSE} {grown}"
        for name, before in d.gap.by_channel.items():
            after = d.gap.by_channel_after[name]
            yield f"  {name:<5} {before:8.2f} before{'' if math.isnan(after) else f', {after:.2f} after'}"


def _causes(d: Diagnosis) -> Iterator[str]:
    """Yield each likely effect with its size and with the errors that it removes."""
    for cause in d.causes:
        if cause.probability >= LIKELY:
            sizes = "; ".join(sizes_of(cause.parameters))
            yield f"  {cause.named}: {sizes} ({in_percent(cause.probability)})"
            for name, before in d.peaks["simulator"].items():
                left = (cause.peaks, d.peaks["fitted_derivatives"])
                after, least = (math.degrees(peaks[name]) for peaks in left)
                yield (
                    f"    largest error of {name}: {math.degrees(before):.2f} → {after:.2f} deg/s "
                    f"({least:.2f} by fitted derivatives alone)"
                )
    for hidden in d.cannot_see:
        yield f"  cannot be seen: {spelled(hidden.effect)}, for {hidden.because}"
    yield from (step.text for step in steps_to_decide(d))
