"""The paper's campaign flown many times: when each rule stops, and how far off it is then."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from advisor.aircraft import CampaignPlan, Rule
from advisor.decision.acceptance import MANEUVER_RULES
from advisor.decision.history import Flown
from advisor.decision.information import knowledge
from advisor.decision.scatter import scatter_percent, window
from advisor.flight.maneuver import Maneuver
from advisor.flight.messages import FloatArray
from advisor.oem.estimate import Estimate
from advisor.study.estimating import Advance, estimate_copies
from advisor.study.flying import NoiseReading, Scene, fly_named, noise_scale
from advisor.study.paper import ORDER

RULES: tuple[Rule, ...] = ("continuous", "separate", "information")


@dataclass(frozen=True, slots=True)
class Outcome:
    """One campaign under one rule."""

    needed: int | None
    """Manoeuvres flown when the rule first said stop; None: not within the campaign."""
    theta: FloatArray
    """(8,) the values then reported (or at the campaign's end)."""
    tolerance: FloatArray
    """(8,) what the rule ``information`` allowed then; NaN under the other rules."""
    history_percent: tuple[float | None, ...]
    """The criterion after each manoeuvre; for ``information`` as far as the stop."""
    rejected: int
    """Manoeuvres that the rule rejected, of all flown."""


def fly_campaigns(
    scene: Scene,
    noise_percent: float,
    campaigns: int,
    seed: int,
    reading: NoiseReading = "std",
    order: Sequence[str] = ORDER,
    advance: Advance | None = None,
) -> list[list[Estimate]]:
    """Return estimates of every manoeuvre of ``campaigns`` repetitions, campaign by campaign.

    The noise is that of the first manoeuvre for all, as one set of instruments has one noise.
    """
    rng = np.random.default_rng([seed, round(1000 * noise_percent)])
    first = noise_scale(fly_named(scene, order[0]), reading)
    columns = []
    for name in order:
        columns.append(estimate_copies(fly_named(scene, name), 0.01 * noise_percent * first, campaigns, rng))
        if advance is not None:
            advance(campaigns)
    return [list(campaign) for campaign in zip(*columns, strict=True)]


def outcome(
    campaign: Sequence[Estimate], rule: Rule, plan: CampaignPlan, maneuvers: Sequence[Maneuver] = ()
) -> Outcome:
    """When ``rule`` stops one campaign, by the same functions that judge in flight.

    Parameters
    ----------
    maneuvers
        What was flown, for the response that the rule ``information`` predicts; without it that rule asks
        for the named derivatives alone.
    """
    accepted = [r.accepted for r in MANEUVER_RULES[rule]([e.cost for e in campaign])]
    taken: list[Estimate] = []
    flown = [
        Flown(estimate, maneuver=maneuvers[i] if maneuvers else None) for i, estimate in enumerate(campaign)
    ]
    history: list[float | None] = []
    needed = None
    for number, (estimate, good) in enumerate(zip(campaign, accepted, strict=True), start=1):
        if good:
            taken.append(estimate)
        if rule == "information":
            known = knowledge(flown[:number], plan)
            history.append(known.percent)
            if known.sufficient or number == len(campaign):
                needed = number if known.sufficient else None
                return Outcome(needed, known.posterior.theta, known.tolerance, tuple(history), 0)
            continue
        members = window(taken, plan)
        history.append(None if members is None else scatter_percent(members, plan.criterion))
        value = history[-1]
        if needed is None and value is not None and value < plan.limit_percent:
            needed = number
            theta = reported(taken, plan)
    if needed is None:
        theta = reported(taken, plan)
    return Outcome(needed, theta, np.full(8, np.nan), tuple(history), len(campaign) - len(taken))


def reported(taken: Sequence[Estimate], plan: CampaignPlan) -> FloatArray:
    """Return the value a campaign of the paper ends with: the mean over the criterion's window."""
    mean: FloatArray = np.mean([e.theta for e in taken[-plan.window :]], axis=0)
    return mean
