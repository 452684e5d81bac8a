"""The reasons of a diagnosis on a terminal: what speaks for the answer, and every decision on the way."""

import math
from collections.abc import Iterator

from rich.console import Group, RenderableType
from rich.panel import Panel
from rich.text import Text

from advisor.gap.result import Diagnosis, spelled
from advisor.gap.verdict.as_judged import answered
from advisor.report.gap_decisions import in_words

_SAYABLE_NATS = 12.0
"""Log odds, nats, above which odds are no longer written as a number: 160,000 to 1."""


def why_of(d: Diagnosis) -> Iterator[RenderableType]:
    """Yield the answer against its strongest rival, then every statistic with its limit."""
    if d.why:
        lines = [Text(f"{reason.nats:+6.1f}  {reason.sentence}") for reason in d.why]
        total = sum(reason.nats for reason in d.why)
        lines.append(Text(f"{total:+6.1f}  together: {_odds(total)}", style="bold"))
        title = f"why: {spelled(answered(d).label)} against {spelled(d.rival)}, in nats of the log odds"
        yield Panel(Group(*lines), title=title, title_align="left")
    if d.decisions:
        decided = [Text(in_words(decision)) for decision in d.decisions]
        yield Panel(Group(*decided), title="every decision on the way", title_align="left")


def _odds(nats: float) -> str:
    if abs(nats) > _SAYABLE_NATS:
        return "as good as certain" if nats > 0.0 else "as good as excluded"
    odds = math.exp(abs(nats))
    return f"{odds:.1f} to 1 for the answer" if nats >= 0.0 else f"{odds:.1f} to 1 against the answer"
