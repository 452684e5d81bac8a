"""Field prior: probability of each kind of answer before the flight."""

from dataclasses import dataclass

from advisor.words.problems import ConfigurationError


@dataclass(frozen=True, slots=True)
class FieldPrior:
    """Prior probabilities of the four kinds of answers, which sum to 1."""

    none: float
    parameters: float
    effect: float
    unknown: float


FIELD = FieldPrior(none=0.4, parameters=0.2, effect=0.3, unknown=0.1)
"""Prior: probabilities that are assumed without a statement of the user. Most flights of a simulator in use
show no gap or wrong derivatives, unlike the flights used for tuning."""


def field_prior(text: str) -> FieldPrior:
    """Read prior shares from text: ``none=40,parameters=20,effect=30,unknown=10``.

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
