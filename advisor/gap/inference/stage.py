"""One stage of the inference: every explanation that may be added to a model, with its evidence."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Generic, Protocol, TypeVar

from advisor.gap.inference.explanation import E, most_nats
from advisor.gap.inference.residual import Residual
from advisor.process.parts import Parts

LAWS = 2
"""Numerical: number of laws outside the catalogue that are fully fitted."""
AT_THE_FILE = 3
"""Numerical: number of effects that are fully fitted because they are the likeliest with the file's
derivatives. A wrong derivative hides such an effect in a fit with free derivatives."""
_FORMS = 2
"""Numerical: number of variants of one effect that are fully fitted."""
SAME_OPTIMUM = 1.0
"""Numerical: difference of the log posterior density, nats, of two searches that ended in one optimum. In
roll and yaw these are nats of white noise."""
REFINED = 120.0
"""Numerical: evidence deficit to the best explanation, nats, beyond which no explanation is fitted
further."""


@dataclass(frozen=True)
class Stage(Generic[E]):
    """All explanations that one stage of the inference compares."""

    plain: E
    """Model with free derivatives alone."""
    effects: tuple[E, ...]
    laws: tuple[E, ...]
    """Models with a law outside the catalogue."""
    heat: float
    """Number of white-noise nats that count as one nat."""
    mirrored: tuple[E, ...] = ()
    """Models of a user's simulator without effects that the aircraft lacks."""

    @property
    def best(self) -> E:
        """The explanation with the largest evidence next to the simulator as given."""
        return max((self.plain, *self.effects, *self.laws), key=lambda e: e.evidence.either)


Pairs = Iterator[tuple[float, str, str]]
"""Price of a pair of effects, and both names."""


class Quick(Protocol):
    """An effect or law after a quick fit."""

    @property
    def name(self) -> str:
        """Name of the effect."""

    @property
    def price(self) -> float:
        """-2 log likelihood plus the price of the effect's parameters."""


Q = TypeVar("Q", bound=Quick)


class Flight(Protocol[E]):
    """A flight along one axis, as the inference uses it."""

    @property
    def parts(self) -> Parts:
        """Return the guard that confines a numerical fault to the model of one effect."""

    @property
    def is_stated(self) -> bool:
        """Whether the aircraft file states derivatives."""

    @property
    def tried(self) -> tuple[int, int]:
        """Number of candidate effects, and number of distinct names among the laws outside the catalogue."""

    @property
    def maneuvers(self) -> int:
        """Return the number of manoeuvres."""

    def natural_nats(self, lead: E, pair: E) -> float:
        """Return the log prior gain of the lead's size in a pair, if that size is natural to every
        aircraft."""

    def explained(self, base: E | None, most: int) -> tuple[float, list[E]]:
        """Return the temperature, the model ``base`` alone, and ``base`` with each likely effect or law.

        ``most`` is the number of effects that are fully fitted. A model that cannot be fitted, or that a
        numerical fault ends, is left out. The effect None stands for the plain model.
        """

    def at_the_files(self, model: E, plain: E, heat: float) -> E | None:
        """Return an explanation refitted about the file's derivatives; None without such a fit."""

    def apart(self, model: E, other: E) -> float:
        """Return the largest difference between the outputs of two models, as a share of the peaks."""

    def residual(self, model: E, heat: float) -> Residual:
        """Return the disturbance that explains the residual of a model best."""

    def in_moving_air(self, stage: Stage[E]) -> Stage[E] | None:
        """Return the explanations refitted with moving air; None where the models contain no air."""

    def pairs(self, stage: Stage[E], leads: Sequence[E]) -> Pairs:
        """Yield the price of each pair of a lead and another effect, by a quick fit, and both names."""


def stage_of(flight: Flight[E], base: E | None, most: int) -> Stage[E]:
    """Return all explanations that may be added to a model, with their evidence.

    Parameters
    ----------
    base
        Model to which effects are added; None for the plain model.
    most
        Number of effects that are fully fitted.
    """
    heat, everyone = flight.explained(base, most)
    best = max(e.evidence.either for e in everyone)
    everyone = [_at_the_files(flight, e, everyone[0], heat, best) for e in everyone]
    plain, *added = within_model_error(flight, everyone, 0.0 if base is None else base.form_error)
    # A simulator that loses an effect has no added effect, and so no name.
    mirrored = tuple(e for e in added if not e.name)
    added = [e for e in added if e.name]
    effects = tuple(e for e in added if e.alternative is not None and e.alternative.is_effect)
    laws = tuple(e for e in added if e.alternative is None or not e.alternative.is_effect)
    return Stage(plain, effects, laws, heat, mirrored)


def _at_the_files(flight: Flight[E], model: E, plain: E, heat: float, best: float) -> E:
    """Return an explanation refitted about the file's derivatives, if that fit is likelier."""
    if not flight.is_stated or max(model.evidence.wrong, model.evidence.right) < best - REFINED:
        return model
    right = flight.at_the_files(model, plain, heat)
    if right is None:
        return model
    likelihood = right.evidence.right if model.name else max(right.evidence.right, model.evidence.right)
    return replace(
        right if likelihood > model.evidence.wrong else model,
        evidence=replace(model.evidence, right=likelihood),
        natural=replace(model.natural, right=max(right.natural.right, model.natural.right)),
    )


def likeliest(screened: Sequence[Q], most: int) -> Iterator[Q]:
    """Yield the quick fits of the likeliest effects, at most ``_FORMS`` of each effect."""
    kept: dict[str, list[Q]] = {}
    for s_one in sorted(screened, key=lambda s: s.price):
        if s_one.name in kept or len(kept) < most:
            kept.setdefault(s_one.name, []).append(s_one)
    for forms in kept.values():
        yield from forms[:_FORMS]


def within_model_error(flight: Flight[E], everyone: Sequence[E], error: float) -> list[E]:
    """Return all explanations with likelihood differences limited by the error of a simulator.

    Residuals cannot distinguish two models whose outputs differ by less than the simulator's error. More
    samples do not help to distinguish such models. The prior still distinguishes such models.

    Parameters
    ----------
    error
        Error of the outputs due to the forms of effects common to all explanations, as a share of the peaks.
    """
    # What the best model loses on held-out manoeuvres is no advantage over the others.
    best = max(everyone, key=_told)

    def lifted(e: E) -> E:
        least = _told(best) - most_nats(flight.apart(e, best), error, best.form_error)
        return e.lifted(max(0.0, least - e.likelihood))

    return [e if e is best else lifted(e) for e in everyone]


def _told(model: E) -> float:
    """Return a model's log likelihood in the fit and on held-out manoeuvres, nats."""
    return model.likelihood + model.unseen
