"""Every decision of a diagnosis as a sentence: what was asked, the number, the limit, the answer."""

from collections.abc import Mapping

from advisor.gap.decision import Decision
from advisor.gap.result import spelled
from advisor.gap.verdict.text import BLOCKS, place
from advisor.report.gap_sizes import in_units, named

_OF_AN_EFFECT: Mapping[str, str] = {
    "likelihood": "it raises the log likelihood of the flight by {value} (at least {limit})",
    "change": "it changes the motion by {value} times the noise, as mean squares (at least {limit})",
    "significance": "its size is {value} standard deviations from zero (at least {limit})",
    "size": "its size is {value} (at least {limit})",
    "hold-out": "it improves held-out manoeuvres by {value} standard errors (at least {limit})",
}
_OF_A_BLOCK: Mapping[str, str] = {
    "likelihood": "a disturbance there raises the log likelihood of the flight by {value} (at least {limit})",
    "place": "a disturbance there explains a share of {value} of the residual (at least {limit})",
    "activity": "the residual is {value} times as strong as in quiet flight (at least {limit})",
    "size": "the unexplained residual has {value} times the power of the noise (at least {limit})",
}
_OF_THE_NUMBERS: Mapping[str, str] = {
    "gap": "the given derivatives leave a gap of {value} times the noise (at least {limit})",
    "odds": "log odds of wrong against right numbers in the file: {value} nats (at least {limit})",
}
"""Name of a decision to its sentence."""
_OF_THE_ANSWER: Mapping[str, str] = {
    "against its rival": "its log odds against the next answer are {value} nats (at least {limit})",
    "decided": "its probability is {value} (at least {limit})",
}
"""Name of a decision on the whole answer to its sentence."""


def decision_in_words(decision: Decision) -> str:
    """Return one decision as a line: ``structural mode: rejected, its frequency lies at the edge``."""
    verdict = "passed" if decision.holds else "rejected"
    return f"{_about(decision.about)}: {verdict}, {_found(decision)}"


def _about(name: str) -> str:
    if name == "parameters":
        return "wrong numbers"
    if name == "none":
        return "no gap"
    return f"something without a name {place(name)}" if name in BLOCKS else spelled(name)


def _found(decision: Decision) -> str:
    if decision.name == "range":
        return _of_the_range(decision)
    if decision.name == "size" and decision.parameter:
        return _of_the_size(decision)
    table = _OF_AN_EFFECT
    if decision.name in _OF_THE_ANSWER:
        table = _OF_THE_ANSWER
    elif decision.about in BLOCKS:
        table = _OF_A_BLOCK
    elif decision.about == "parameters":
        table = _OF_THE_NUMBERS
    return table[decision.name].format(value=f"{decision.statistic:.3g}", limit=f"{decision.limit:.3g}")


def _of_the_size(decision: Decision) -> str:
    factor, unit = in_units(decision.parameter)
    value, limit = (f"{factor * x:.3g} {unit}".rstrip() for x in (decision.statistic, decision.limit))
    return f"its {named(decision.parameter)} is {value} (at least {limit})"


def _of_the_range(decision: Decision) -> str:
    if decision.searched is None:
        return "its values lie inside the searched range"
    factor, unit = in_units(decision.parameter)
    low, high = (f"{factor * x:.2g}" for x in decision.searched)
    return (
        f"its {named(decision.parameter)} lies at the edge of the searched range "
        f"({low} to {f'{high} {unit}'.rstrip()})"
    )
