"""Every decision of a diagnosis as a sentence: what was asked, the number, the limit, the answer."""

from collections.abc import Mapping

from advisor.gap.decision import Decision
from advisor.gap.result import spelled

_MEASURED: Mapping[str, str] = {
    "likelihood": "the log likelihood rises by {value} (at least {limit})",
    "change": "the error's mean square falls by {value} times the noise's (at least {limit})",
    "significance": "the size is {value} standard deviations from zero (at least {limit})",
    "hold-out": "held-out manoeuvres improve by {value} standard errors (at least {limit})",
    "place": "the block explains a share of {value} of the residual (at least {limit})",
    "activity": "the residual is {value} times as strong as in quiet flight (at least {limit})",
    "gap": "wrong derivatives make a gap of {value} times the noise (at least {limit})",
    "clear gap": "wrong derivatives make a clear gap of {value} times the noise (at least {limit})",
    "distance": "the six derivatives lie {value} in chi square from the flight's (at least {limit})",
}
"""Name of a decision to its sentence."""
_INSIDE, _AT_THE_EDGE = (
    "the value lies inside the searched range",
    "the value lies at the edge of the searched range",
)


def in_words(decision: Decision) -> str:
    """Return one decision as a line for people: ``structural mode: rejected, the value lies at the edge``."""
    verdict = "passed" if decision.holds else "rejected"
    return f"{spelled(decision.about)}: {verdict}, {_found(decision)}"


def _found(decision: Decision) -> str:
    if decision.name == "range":
        return _INSIDE if decision.holds else _AT_THE_EDGE
    value, limit = f"{decision.statistic:.3g}", f"{decision.limit:.3g}"
    if decision.name in _MEASURED:
        return _MEASURED[decision.name].format(value=value, limit=limit)
    return f"the {decision.name} is {value} {decision.unit} (at least {limit})"
