"""The reasons: the answer against its strongest rival, in nats that add up to the log odds."""

from collections.abc import Mapping

from advisor.gap.alternative import Contribution
from advisor.gap.evidence.quantities import QUANTITIES, Quantity
from advisor.gap.evidence.rows import Row
from advisor.gap.judge.logit import Logit

MOST_LINES = 7
"""Words: most lines of the reasons, so that they fit one look; the last one holds all smaller
contributions."""


def reasons(logit: Logit, answer: Row, rival: Row, ahead: float) -> tuple[Contribution, ...]:
    """Return the contributions to the log odds of the answer against its rival, the largest first.

    ``ahead`` is the part that no evidence changes, nats. The sum is the log odds. A column that both rows
    lack contributes nothing.
    """
    mine, other = logit.parts(answer), logit.parts(rival)
    nats = {name: mine.get(name, 0.0) - other.get(name, 0.0) for name in {**mine, **other}}
    lines = [
        _line(quantity, nats[quantity.name], answer.values, rival.values)
        for quantity in QUANTITIES
        if quantity.name in nats
    ]
    lines.append(Contribution("prior", ahead, "how often each is right, before the flight is looked at"))
    lines.sort(key=lambda line: -abs(line.nats))
    kept, others = lines[: MOST_LINES - 1], lines[MOST_LINES - 1 :]
    rest = Contribution("rest", sum(line.nats for line in others), "all smaller parts together")
    return (*kept, rest)


def _line(
    quantity: Quantity, nats: float, answer: Mapping[str, float], rival: Mapping[str, float]
) -> Contribution:
    said = quantity.compared(*(values.get(quantity.name, 0.0) for values in (answer, rival)))
    # A value that both share may still be likelier under one of them: their kinds have weights of their own.
    both = "" if " against " in said else f" for both, as expected of the {_favoured(nats)}"
    return Contribution(quantity.name, nats, f"{quantity.words}: {said}{both}")


def _favoured(nats: float) -> str:
    return "answer" if nats > 0.0 else "rival"
