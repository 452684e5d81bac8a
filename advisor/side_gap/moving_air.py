"""Models of a lateral flight in side gusts, and what the error of every simulator makes up for."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.gap.fitting.prior import ERROR_IF_RIGHT, ERROR_IF_WRONG
from advisor.gap.inference.model_error import form_error, most_nats
from advisor.side_gap.disturbance import courses_of
from advisor.side_gap.fit import Fit
from advisor.side_gap.gusts import Gusts, side_gusts
from advisor.side_gap.models import Case


class Model(NamedTuple):
    """A model of the flight: derivatives alone, or with one effect."""

    fit: Fit
    names: Sequence[str]
    """Numbers of the effect."""
    beyond: tuple[float, float] = (0.0, 0.0)
    """Nats beyond the marginal likelihood, with right and with wrong derivatives."""


def in_moving_air(case: Case, models: Sequence[Model], tried: Sequence[bool]) -> tuple[Gusts, FloatArray]:
    """Return the gusts of the first model, and the evidence of all models in side gusts.

    Parameters
    ----------
    models
        The first one has no effect.
    tried
        Whether each model is tried in gusts.

    Returns
    -------
    gusts, evidence
        Evidence over that of the first model with right derivatives, nats: that model with right and with
        wrong derivatives, then each effect with either.
    """
    courses = courses_of(models[0].fit, case.flown)
    chosen = [k for k, is_tried in enumerate(tried) if is_tried]
    wide = [case.known(ERROR_IF_WRONG, model.fit.free) for model in models]
    gusts = [side_gusts(models[k].fit, courses, wide[k]) for k in chosen]
    highest = [one.highest(wide[k]) for k, one in zip(chosen, gusts, strict=True)]
    made_up = for_model_error([models[k] for k in chosen], highest)
    each = np.full((len(models), 2), -np.inf)
    for k, one, more in zip(chosen, gusts, made_up, strict=True):
        fit, beyond = models[k].fit, models[k].beyond
        known = [case.known(tolerance, fit.free) for tolerance in (ERROR_IF_RIGHT, ERROR_IF_WRONG)]
        each[k] = np.add([one.evidence(fit, prior) + more for prior in known], beyond)
    effects = np.logaddexp(each[1:, 0], each[1:, 1]) - np.log(2.0)
    return gusts[0], np.concatenate([each[0], effects]) - each[0, 0]


def for_model_error(models: Sequence[Model], likelihood: Sequence[float]) -> list[float]:
    """Return the nats of the likelihood that the error of every simulator makes up for, by model.

    Parameters
    ----------
    models
        The first one has no effect.
    likelihood
        Log likelihood of each model, nats.
    """
    best = int(np.argmax(likelihood))
    fits = [model.fit for model in models]
    form = form_error(models[best].names, change_of(fits[0], fits[best]))
    least = [likelihood[best] - most_nats(change_of(fit, fits[best]), form) for fit in fits]
    return [max(0.0, enough - one) for enough, one in zip(least, likelihood, strict=True)]


def change_of(one: Fit, other: Fit) -> float:
    """Return the largest difference between the outputs of two fits, as a share of each output's peak."""
    shares = []
    for channel in np.unique(one.assembly.channel):
        rows = one.assembly.channel == channel
        apart = one.fitted[rows] - other.fitted[rows]
        shares.append(np.sqrt(np.mean(apart**2)) / max(float(np.ptp(one.assembly.z[rows])) / 2.0, 1e-12))
    return float(max(shares))
