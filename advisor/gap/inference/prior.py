"""The field prior: how often each kind of answer is right before a flight is looked at."""

from dataclasses import dataclass

from advisor.words.problems import ConfigurationError


@dataclass(frozen=True, slots=True)
class FieldPrior:
    """Shares of the four kinds of answers, which sum to 1."""

    none: float
    parameters: float
    effect: float
    unknown: float


FIELD = FieldPrior(none=0.4, parameters=0.2, effect=0.3, unknown=0.1)
"""Prior: shares that are assumed without a statement of the user. Most flights of a simulator in use show no
gap, or wrong numbers; the flights of the fit have far more effects."""


def field_prior(text: str) -> FieldPrior:
    """Read shares as people write them: ``none=40,parameters=20,effect=30,unknown=10``.

    Raises
    ------
    ConfigurationError
        A share is missing, unknown, not a number, or not above zero.
    """
    names = FieldPrior.__slots__
    example = "none=40,parameters=20,effect=30,unknown=10"
    try:
        shares = {name: float(share) for name, share in (part.split("=") for part in text.split(","))}
    except ValueError:
        shares = {}
    if sorted(shares) != sorted(names) or not all(0.0 < share < float("inf") for share in shares.values()):
        raise ConfigurationError(f"--prior {text}: give four shares above zero, as in --prior {example}.")
    total = sum(shares.values())
    return FieldPrior(**{name: share / total for name, share in shares.items()})
