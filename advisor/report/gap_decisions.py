"""Every decision of a diagnosis as a sentence: what was asked, the number, the limit, the answer."""

from collections.abc import Mapping

from advisor.gap.alternative import Alternative, Kind
from advisor.gap.decision import Decision
from advisor.gap.verdict.text import BLOCKS, in_words

_SAID: Mapping[str, str] = {
    "against its rival": "its log odds against the next answer are {value} nats (at least {limit})",
    "decided": "its probability is {value} (at least {limit})",
    "likelihood": "it raises the log likelihood of the flight by {value} nats (at least {limit})",
}
"""Name of a decision to its sentence."""


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
