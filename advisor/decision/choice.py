"""Choice of the next input: candidates as large as the limits allow, compared by their information."""

from collections.abc import Callable, Iterator

import numpy as np

from advisor.decision.conditions import Conditions
from advisor.decision.foresight import expect
from advisor.decision.inputs import ORDERS, StepInput, units_to_try
from advisor.flight.signals.messages import FloatArray
from advisor.model.short_period import ShortPeriod

Choice = tuple[StepInput, FloatArray]
"""An input, and the (8, 8) covariance of the errors expected from flying the input."""


def best_input(
    conditions: Conditions, measured_std: FloatArray, distance_to_stop: Callable[[FloatArray], float]
) -> Choice | None:
    """Return the input whose expected errors leave the least ``distance_to_stop``; None without a prediction.

    Parameters
    ----------
    measured_std
        (8,) standard deviations of the last manoeuvre's estimate. Their causes (coloured residuals,
        further outputs) persist in the next manoeuvre. The prediction supplies the ratio between inputs.
    distance_to_stop
        Covariance of the next manoeuvre's errors to a measure of the distance to the stop.
    """
    repeated = expect(conditions.theta, conditions.flown, conditions.instruments)
    if repeated is None:
        return None
    ratio = measured_std / repeated.std
    scale = np.outer(ratio, ratio)
    expected = [(option, covariance * scale) for option, covariance in _options(conditions)]
    return min(expected, key=lambda choice: distance_to_stop(choice[1])) if expected else None


def _options(conditions: Conditions) -> Iterator[Choice]:
    """Yield inputs in the direction that was not flown last, with their expected errors."""
    frequency = ShortPeriod(conditions.theta).natural_frequency
    if not np.isfinite(frequency) or frequency <= 0.0:
        return
    for order in ORDERS:
        for unit in units_to_try(frequency):
            option = StepInput(order, float(unit), conditions.largest_rad, not conditions.nose_up_first)
            choice = _as_large_as_allowed(option, conditions)
            if choice is not None:
                yield choice


def _as_large_as_allowed(option: StepInput, conditions: Conditions) -> Choice | None:
    """Return the input scaled so that α stays within its limit; the model is linear, so scaling is exact."""
    length = conditions.lead_s + option.duration_s + conditions.free_s
    elevator = option.elevator(conditions.trim_rad, conditions.lead_s, length)
    full = expect(conditions.theta, elevator, conditions.instruments)
    if full is None or not full.alpha_excursion > 0.0:
        return None
    amplitude = min(1.0, conditions.alpha_rad / full.alpha_excursion) * option.amplitude_rad
    allowed = StepInput(option.order, option.unit_s, amplitude, option.nose_up_first).rounded(
        conditions.travel_rad
    )
    return allowed, full.covariance * (option.amplitude_rad / allowed.amplitude_rad) ** 2
