"""Detection of a changed aircraft, and false alarms of an unchanged one."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from advisor.bundled.study.campaigns import (
    NOISE_PERCENT,
    ORDER,
    Scene,
    blocks,
    estimate_copies,
    fly_named,
    noise_scale,
)
from advisor.decision.change import find_change
from advisor.decision.history import CandidateManeuver
from advisor.oem.estimate import Estimate
from advisor.process.arrays import FloatArray

LOSS = 0.15
"""Share of the derivative that is lost."""
LOST = ("M_alpha", "Z_alpha")
BEFORE = 3
"""Manoeuvres flown before the change."""
BLOCK = 25
"""Number of campaigns in a task: half a second of work."""


@dataclass(frozen=True, slots=True)
class Detection:
    """All campaigns at one noise level."""

    noise_percent: float
    lost: str | None
    """Derivative that lost `LOSS`. None: nothing changed."""
    suspected_percent: float
    """Share of campaigns with a warning after the first manoeuvre that followed (nothing changed: at any
    time)."""
    confirmed_percent: float
    """Share of campaigns that confirmed after the second, with the right derivative first (nothing changed:
    at any time)."""
    sigma: float
    """Median of the reported move of the derivative, in standard deviations. NaN without a change."""


@dataclass(frozen=True, slots=True)
class ChangedBlock:
    """Campaigns of an aircraft that loses a derivative, or none."""

    noise_percent: float
    lost: str | None
    campaigns: int
    seed: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Noticed:
    """Results of a block of campaigns."""

    suspected: int
    """Number of campaigns that warned."""
    confirmed: int
    """Number of campaigns that confirmed the change and named the right derivative first."""
    sigma: tuple[float, ...]
    """Reported moves of the derivative in standard deviations, one for each confirmed campaign."""


def change_blocks(campaigns: int, seed: int) -> list[ChangedBlock]:
    """Return campaigns with and without a change at the paper's noise levels, each block with its own
    seed."""
    return [
        ChangedBlock(noise, lost, count, (seed, round(1000 * noise), kind, number))
        for noise in NOISE_PERCENT
        for kind, lost in enumerate((None, *LOST))
        for number, count in blocks(campaigns, BLOCK)
    ]


def notice(block: ChangedBlock) -> Noticed:
    """Fly a block, and look for the change as in flight."""
    scene, rng = Scene(), np.random.default_rng(block.seed)
    noise = 0.01 * block.noise_percent * noise_scale(fly_named(scene, ORDER[0]), "std")
    if block.lost is None:
        return _unchanged(_columns(scene, ORDER, noise, block.campaigns, rng))
    value = (1.0 - LOSS) * scene.aircraft.as_dict()[block.lost]
    damaged = replace(scene, aircraft=replace(scene.aircraft, **{block.lost: value}))
    before = _columns(scene, ORDER[:BEFORE], noise, block.campaigns, rng)
    after = _columns(damaged, ORDER[BEFORE : BEFORE + 2], noise, block.campaigns, rng)
    return _changed(before, after, block.lost)


def detections(flown: Sequence[ChangedBlock], noticed: Sequence[Noticed]) -> list[Detection]:
    """Return the joint results of the campaigns of each noise level and change."""
    cases: dict[tuple[float, str | None], list[tuple[ChangedBlock, Noticed]]] = {}
    for block, found in zip(flown, noticed, strict=True):
        cases.setdefault((block.noise_percent, block.lost), []).append((block, found))
    return [_together(*case, several) for case, several in cases.items()]


def _together(
    noise_percent: float, lost: str | None, several: Sequence[tuple[ChangedBlock, Noticed]]
) -> Detection:
    share = 100.0 / sum(block.campaigns for block, _ in several)
    sigma = [value for _, found in several for value in found.sigma]
    return Detection(
        noise_percent,
        lost,
        share * sum(found.suspected for _, found in several),
        share * sum(found.confirmed for _, found in several),
        float(np.median(sigma)) if sigma else float("nan"),
    )


def _columns(
    scene: Scene, order: tuple[str, ...], noise: FloatArray, campaigns: int, rng: np.random.Generator
) -> list[list[CandidateManeuver]]:
    """Return the manoeuvres of each campaign."""
    columns: list[list[Estimate]] = [
        estimate_copies(fly_named(scene, name), noise, campaigns, rng) for name in order
    ]
    return [[CandidateManeuver(estimate) for estimate in campaign] for campaign in zip(*columns, strict=True)]


def _unchanged(campaigns: Sequence[Sequence[CandidateManeuver]]) -> Noticed:
    """Return the false alarms, looked for after every manoeuvre as in flight."""
    suspected = confirmed = 0
    for campaign in campaigns:
        changes = [find_change(campaign[: n + 1]) for n in range(len(campaign))]
        suspected += any(change is not None for change in changes)
        confirmed += any(change is not None and change.confirmed for change in changes)
    return Noticed(suspected, confirmed, ())


def _changed(
    before: Sequence[Sequence[CandidateManeuver]], after: Sequence[Sequence[CandidateManeuver]], lost: str
) -> Noticed:
    """Return the changes suspected after the first manoeuvre that follows, and confirmed after the second."""
    suspected, sigma = 0, []
    for early, late in zip(before, after, strict=True):
        suspected += find_change([*early, late[0]]) is not None
        change = find_change([*early, *late])
        if change is not None and change.confirmed and change.moved[0].parameter == lost:
            sigma.append(abs(change.moved[0].sigma))
    return Noticed(suspected, len(sigma), tuple(sigma))
