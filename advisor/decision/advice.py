"""What next: how many more manoeuvres, which parameter holds the stop back, which input helps most."""

from collections.abc import Sequence

import numpy as np

from advisor.aircraft import PARAMETERS, Aircraft, CampaignPlan
from advisor.decision.conditions import Conditions, find_conditions
from advisor.decision.foresight import Expectation, expect
from advisor.decision.history import Flown
from advisor.decision.information import Knowledge, knowledge
from advisor.decision.inputs import ORDERS, StepInput, units_to_try
from advisor.decision.judge import accepted_estimates
from advisor.decision.remaining import by_information, by_scatter, share_after, usable_share
from advisor.decision.scatter import scatter_by_parameter, window
from advisor.decision.verdict import NextInput, Remaining
from advisor.flight.messages import FloatArray
from advisor.model.short_period import ShortPeriod

PASSING = {"separate": 0.5}
"""Share of equally good manoeuvres that pass the rule: Eq. (11) rejects half, Eq. (10) hardly any."""


def next_input(history: Sequence[Flown], aircraft: Aircraft, stopped: bool) -> NextInput:
    """What to fly next, as of the last manoeuvre of ``history``."""
    plan = aircraft.campaign
    if stopped:
        return NextInput("no further manoeuvre needed", Remaining(0, 0))
    usable = [e for flown in history if (e := flown.usable)]
    conditions = find_conditions(history, aircraft)
    if conditions is None:
        return NextInput(_first_input(aircraft), _without_a_model(history, plan))
    known = knowledge(usable, plan)
    repeated = expect(conditions.theta, conditions.flown, conditions.instruments)
    measured = np.sqrt(np.mean([np.diag(e.covariance) for e in usable], axis=0))
    options = _options(conditions)
    if repeated is None or not options:
        spoken = "the same again"
        return NextInput(
            f"next: {spoken}", _remaining(history, plan, known, measured), _held_by(history, plan, known)
        )
    # What the present record says of errors (colour of the residuals, further outputs) holds for the
    # next one too; the prediction supplies the ratio between inputs.
    expected = [(option, measured * e.std / repeated.std) for option, e in options]
    best, std = min(expected, key=lambda pair: _unrest(pair[1], plan, known))
    return NextInput(
        f"next: {best.spoken(conditions.travel_rad)}",
        _remaining(history, plan, known, std),
        _held_by(history, plan, known),
    )


def _unrest(std: FloatArray, plan: CampaignPlan, known: Knowledge) -> float:
    """What remains in the way of the stop after one more manoeuvre with these errors; smaller is better."""
    if plan.rule == "information":
        return float(np.max(share_after(known, std, 1)))
    size = np.maximum(np.abs(known.belief.theta), known.belief.std)
    return float(np.linalg.norm(std / size))


def _remaining(
    history: Sequence[Flown], plan: CampaignPlan, known: Knowledge, next_std: FloatArray
) -> Remaining:
    share = usable_share(history)
    if plan.rule == "information":
        return by_information(known, next_std, share)
    members = np.array([e.theta for e in accepted_estimates(history, plan.rule)]).reshape(-1, len(PARAMETERS))
    return by_scatter(members, known.belief, next_std, plan, share * PASSING.get(plan.rule, 1.0))


def _held_by(history: Sequence[Flown], plan: CampaignPlan, known: Knowledge) -> str:
    if plan.rule != "information":
        members = window(accepted_estimates(history, plan.rule), plan)
        if members is not None:
            return PARAMETERS[int(np.nanargmax(scatter_by_parameter(members, plan.criterion)))]
    return known.holding_back


def _options(conditions: Conditions) -> list[tuple[StepInput, Expectation]]:
    """Every input worth trying, as large as the limits allow, in the direction not flown last."""
    model = ShortPeriod(conditions.theta)
    frequency = model.natural_frequency
    if not np.isfinite(frequency) or frequency <= 0.0:
        return []
    nose_up_first = conditions.last.span.steps[0][1] > 0.0
    found = []
    for order in ORDERS:
        for unit in units_to_try(frequency):
            option = _as_large_as_allowed(
                StepInput(order, float(unit), conditions.largest_rad, nose_up_first), conditions
            )
            if option is not None:
                found.append(option)
    return found


def _as_large_as_allowed(option: StepInput, conditions: Conditions) -> tuple[StepInput, Expectation] | None:
    """The input scaled so that α stays within its limit; the model is linear, so scaling is exact."""
    length = conditions.lead_s + option.duration_s + conditions.free_s
    full = expect(
        conditions.theta,
        option.elevator(conditions.trim_rad, conditions.lead_s, length),
        conditions.instruments,
    )
    if full is None:
        return None
    scale = min(1.0, conditions.alpha_rad / full.alpha_excursion)
    scaled = StepInput(option.order, option.unit_s, scale * option.amplitude_rad, option.nose_up_first)
    return scaled, Expectation(full.std / scale, scale * full.alpha_excursion)


def _first_input(aircraft: Aircraft) -> str:
    """Before anything is known: the textbook's 3-2-1-1, small, timed by the prior model if there is one."""
    unit = 0.5
    if set(PARAMETERS) <= set(aircraft.model):
        frequency = ShortPeriod.from_mapping(aircraft.model).natural_frequency
        if np.isfinite(frequency) and frequency > 0.0:
            unit = max(round(0.5 * np.pi / frequency, 1), 0.2)
    return f"next: 3-2-1-1, {unit:.1f} s steps, 10 % stick, to begin gently"


def _without_a_model(history: Sequence[Flown], plan: CampaignPlan) -> Remaining:
    """At least as many as the rule needs at best."""
    least = 2 if plan.rule == "information" else plan.window
    return Remaining(least, int(np.ceil(least / usable_share(history))) + 1)
