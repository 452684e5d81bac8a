"""Causes of the gap as text: ranking with sizes, similar effects, undetectable effects, and reasons."""

from collections.abc import Iterator, Mapping, Sequence

from rich import box
from rich.console import Group, RenderableType
from rich.padding import Padding
from rich.panel import Panel
from rich.table import Table
from rich.text import Text

from advisor.gap.alternative import Alternative, Kind, Weighed
from advisor.gap.decision import Decision
from advisor.gap.result import Cause, Unseen, spelled
from advisor.gap.verdict.text import BLOCKS, in_words
from advisor.report.facts.gap import heading
from advisor.report.facts.reasons import in_percent, weighed
from advisor.report.facts.sizes import marked, sizes_of

_LIKELY = 0.01
"""Probability below which all alternatives stand on one line."""
PRESENT = "●"


def ranking(causes: Sequence[Cause], before: float, what: str = "simulator") -> Iterator[RenderableType]:
    """Yield a table of the likely causes, one line with the unlikely causes, and sentences about similar
    effects.

    Parameters
    ----------
    before
        Gap of the simulator as given. A cause whose gap is larger has a mark.
    what
        Noun for the thing that is improved: the simulator, or without a simulator the model of the flight.
    """
    likely = [c for c in causes if c.present or c.probability >= _LIKELY]
    if likely:
        yield _table(likely, before)
        kept = f"{PRESENT} in the improved {what}; " if any(c.present for c in likely) else ""
        several = sum(c.present for c in likely) > 1
        asked = "that it acts with the causes above" if several else "that this is the main cause"
        yield Text(f"{kept}prob.: {asked}; ±: 95 %", style="dim")
    unlikely = [called(c) for c in causes if c not in likely]
    if unlikely:
        yield Text(f"Below 1 %: {', '.join(unlikely)}.", style="dim")
    for c in likely:
        if c.cannot_be_told_from:
            yield Text(confusion_sentence(c))


def called(c: Cause) -> str:
    """Return the name of a cause for people. On an axis with several controls or sensors, the name contains
    the control or sensor.
    """
    return c.named or spelled(c.effect)


def confusion_sentence(c: Cause) -> str:
    """Return a sentence about effects with similar responses, and the way to distinguish them."""
    others = [spelled(name) for name in c.cannot_be_told_from]
    listed = others[0] if len(others) == 1 else f"{', '.join(others[:-1])} or {others[-1]}"
    way = f" To distinguish them, {c.tell_apart_by}." if c.tell_apart_by else ""
    return f"{called(c).capitalize()} cannot be distinguished from {listed} here.{way}"


def unseen(effects: Sequence[Unseen]) -> Table:
    """Yield lines with the undetectable effects and the data that would show them, grouped by reason."""
    table = Table.grid(padding=(0, 2))
    table.add_column(max_width=26)
    table.add_column()
    for (because, needed), names in by_reason(effects).items():
        listed = Padding(Text(", ".join(names)), (0, 0, 0, 2))
        table.add_row(listed, Text(f"{because} → {needed}"))
    return table


def by_reason(effects: Sequence[Unseen]) -> dict[tuple[str, str], list[str]]:
    """Return the names of the effects that share a reason and a remedy."""
    groups: dict[tuple[str, str], list[str]] = {}
    for u in effects:
        groups.setdefault((u.because, u.would_need), []).append(spelled(u.effect))
    return groups


def _table(causes: Sequence[Cause], before: float) -> Table:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False)
    table.add_column("cause", no_wrap=True)
    table.add_column("prob.", justify="right", no_wrap=True)
    table.add_column("size")
    table.add_column("gap after", justify="right", no_wrap=True)
    for c in causes:
        mark = PRESENT if c.present else " "
        table.add_row(
            Text(f"{mark} {called(c)}", style="bold" if c.present else ""),
            in_percent(c.probability), Text("\n".join(sizes_of(c.parameters))),
            marked(c.gap_after, before),
        )  # fmt: skip
    return table


def why_of(d: Weighed) -> Iterator[RenderableType]:
    """Yield the evidence against the answer's strongest rival, then every statistic with its limit."""
    if d.answer is not None:
        *reasons, total = weighed((reason.nats, reason.sentence) for reason in d.why)
        lines = [Text(f"{nats:>6s}  {said}") for nats, said in reasons]
        lines.append(Text(f"{total[0]:>6s}  {total[1]}", style="bold"))
        yield Panel(Group(*lines), title=heading(d), title_align="left")
    if d.decisions:
        decided = [Text(decision_in_words(decision)) for decision in d.decisions]
        yield Panel(
            Group(*decided), title="statistics of the decision, with their limits", title_align="left"
        )


_SAID: Mapping[str, str] = {
    "against its rival": "its log odds against the next answer are {value} nats (at least {limit})",
    "decided": "its probability is {value} (at least {limit})",
    "likelihood": "it raises the log likelihood of the flight by {value} nats (at least {limit})",
}
"""Sentence about each kind of decision, by its name."""


def decision_in_words(decision: Decision) -> str:
    """Return one decision as a line: ``transport delay: passed, its probability is 0.97 (at least 0.6)``."""
    verdict = "passed" if decision.holds else "rejected"
    said = _SAID[decision.name].format(value=f"{decision.statistic:.3g}", limit=f"{decision.limit:.3g}")
    return f"{_about(decision.about)}: {verdict}, {said}"


def _about(name: str) -> str:
    if name in BLOCKS:
        return in_words(Alternative("unknown", "unknown", name))
    kinds: dict[str, Kind] = {"none": "none", "parameters": "parameters"}
    return in_words(Alternative(kinds.get(name, "effect"), name))
