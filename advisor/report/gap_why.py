"""The reasons of a diagnosis on a terminal: what speaks for the answer, and every decision on the way."""

from collections.abc import Iterator

from rich.console import Group, RenderableType
from rich.panel import Panel
from rich.text import Text

from advisor.gap.result import Diagnosis
from advisor.gap.verdict.text import in_words
from advisor.report.gap_decisions import decision_in_words
from advisor.report.gap_reasons import heading, weighed


def why_of(d: Diagnosis) -> Iterator[RenderableType]:
    """Yield the answer against its strongest rival, then every statistic with its limit."""
    if d.answer is not None:
        *reasons, total = weighed((reason.nats, reason.sentence) for reason in d.why)
        lines = [Text(f"{nats:>6s}  {said}") for nats, said in reasons]
        lines.append(Text(f"{total[0]:>6s}  {total[1]}", style="bold"))
        stated = {one.alternative.label: one.alternative for one in d.evidence}
        title = heading(in_words(d.answer), in_words(stated[d.rival]))
        yield Panel(Group(*lines), title=title, title_align="left")
    if d.decisions:
        decided = [Text(decision_in_words(decision)) for decision in d.decisions]
        yield Panel(Group(*decided), title="every decision on the way", title_align="left")
