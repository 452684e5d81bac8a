"""How soon a changed aircraft is noticed, and how often an unchanged one is suspected."""

from dataclasses import dataclass, replace

import numpy as np

from advisor.decision.change import find_change
from advisor.decision.history import Flown
from advisor.flight.messages import FloatArray
from advisor.oem.estimate import Estimate
from advisor.study.estimating import Advance, estimate_copies
from advisor.study.flying import Scene, fly_named, noise_scale
from advisor.study.paper import NOISE_PERCENT, ORDER

LOSS = 0.15
"""Share of the derivative that is lost."""
LOST = ("M_alpha", "Z_alpha")
BEFORE = 3
"""Manoeuvres flown before the change."""


@dataclass(frozen=True, slots=True)
class Detection:
    """All campaigns at one noise level."""

    noise_percent: float
    lost: str | None
    """The derivative that lost `LOSS`; None: nothing changed."""
    suspected_percent: float
    """Warned of after the first manoeuvre that followed (nothing changed: at any time)."""
    confirmed_percent: float
    """Confirmed after the second, with the right derivative named first (nothing changed: at any time)."""
    sigma: float
    """Median of how many standard deviations the derivative moved, as told; NaN without a change."""


def measure(campaigns: int, seed: int, advance: Advance | None = None) -> list[Detection]:
    """Fly campaigns with and without a change, at the paper's noise levels."""
    found = []
    for noise in NOISE_PERCENT:
        rng = np.random.default_rng([seed, round(1000 * noise)])
        scene = Scene()
        level = 0.01 * noise * noise_scale(fly_named(scene, ORDER[0]), "std")
        sound = _columns(scene, ORDER, level, campaigns, rng)
        found.append(_unchanged(sound, noise))
        for parameter in LOST:
            value = (1.0 - LOSS) * scene.aircraft.as_dict()[parameter]
            damaged = replace(scene, aircraft=replace(scene.aircraft, **{parameter: value}))
            after = _columns(damaged, ORDER[BEFORE : BEFORE + 2], level, campaigns, rng)
            found.append(_changed(sound, after, noise, parameter))
        if advance is not None:
            advance(1)
    return found


def _columns(
    scene: Scene, order: tuple[str, ...], noise: FloatArray, campaigns: int, rng: np.random.Generator
) -> list[list[Flown]]:
    """Return manoeuvres of each campaign."""
    columns: list[list[Estimate]] = [
        estimate_copies(fly_named(scene, name), noise, campaigns, rng) for name in order
    ]
    return [[Flown(estimate) for estimate in campaign] for campaign in zip(*columns, strict=True)]


def _unchanged(campaigns: list[list[Flown]], noise: float) -> Detection:
    """Return false alarms: looked for after every manoeuvre, as in flight."""
    suspected = confirmed = 0
    for campaign in campaigns:
        changes = [find_change(campaign[: n + 1]) for n in range(len(campaign))]
        suspected += any(change is not None for change in changes)
        confirmed += any(change is not None and change.confirmed for change in changes)
    share = 100.0 / len(campaigns)
    return Detection(noise, None, share * suspected, share * confirmed, float("nan"))


def _changed(before: list[list[Flown]], after: list[list[Flown]], noise: float, parameter: str) -> Detection:
    suspected, confirmed, sigma = 0, 0, []
    for early, late in zip(before, after, strict=True):
        suspected += find_change([*early[:BEFORE], late[0]]) is not None
        change = find_change([*early[:BEFORE], *late])
        if change is not None and change.confirmed and change.moved[0].parameter == parameter:
            confirmed += 1
            sigma.append(abs(change.moved[0].sigma))
    share = 100.0 / len(before)
    return Detection(
        noise,
        parameter,
        share * suspected,
        share * confirmed,
        float(np.median(sigma)) if sigma else float("nan"),
    )
