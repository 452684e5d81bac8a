"""Prediction of a manoeuvre's response from the earlier manoeuvres, with its 95 % band."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from advisor.decision.consistency import consensus
from advisor.decision.history import CandidateManeuver
from advisor.decision.pooling import DERIVATIVES, Shared, common_airspeed, posteriors_at_one_speed
from advisor.decision.prediction import PREDICTED, Response, airspeed_in, measured, response_to
from advisor.oem.estimate import ChannelFit, Estimate
from advisor.oem.prediction import half_widths
from advisor.process.arrays import FloatArray
from advisor.words.quantiles import NORMAL_95

FEWEST = 2
"""Least number of earlier manoeuvres for a prediction. No other manoeuvre confirms the errors of a single
one.
"""


@dataclass(frozen=True, slots=True)
class PredictedOutput:
    """One output over the time of the manoeuvre, SI, at the stamps of its channel."""

    t: FloatArray
    """Shape (n,): stamps of the channel, s since boot."""
    measured: FloatArray
    """Shape (n,): measured values of the output."""
    predicted: FloatArray
    """Shape (n,): response from the earlier manoeuvres' derivatives and this manoeuvre's trim."""
    half: FloatArray
    """Shape (n,): half-width of the 95 % band due to errors of the derivatives alone."""
    half_of_samples: FloatArray
    """Shape (n,): half-width of the band that contains 95 % of the samples, including noise."""


def predict_last(usable: Sequence[CandidateManeuver]) -> Mapping[str, PredictedOutput]:
    """Return the prediction of the last usable manoeuvre from all earlier ones.

    Trim, initial state and biases are estimated for each manoeuvre. These parameters come from the
    manoeuvre's own fit, minus the response of its own derivatives.

    Parameters
    ----------
    usable
        Manoeuvres, each with an estimate, in the order flown.

    Returns
    -------
    Mapping
        Prediction of each output by its name; empty with too few earlier manoeuvres, or for a diverging
        model.
    """
    last = usable[-1] if len(usable) > FEWEST else None
    if last is None or last.maneuver is None or not isinstance(last.estimate, Estimate):
        return {}
    estimates = [flown.estimate for flown in usable if isinstance(flown.estimate, Estimate)]
    *before, own = posteriors_at_one_speed(estimates)
    airspeed_m_s = common_airspeed(estimates)
    shared = consensus(before)[0].shared
    predicted = response_to(last, shared.theta, airspeed_m_s)
    alone = response_to(last, own.theta[list(DERIVATIVES)], airspeed_m_s)
    if predicted is None or alone is None or not np.all(np.isfinite(shared.covariance)):
        return {}
    begun_s = float(last.maneuver.channels["elevator"].t[0])
    scales = {"a_z": airspeed_in(last.maneuver)}
    return {
        name: _output(last.estimate.fits[0][name], scale, begun_s, shared, predicted, alone)
        for name in measured(last)
        if (scale := scales.get(name, 1.0)) is not None
    }


def _output(
    fit: ChannelFit, scale: float, begun_s: float, shared: Shared, predicted: Response, alone: Response
) -> PredictedOutput:
    k = PREDICTED.index(fit.name)
    after_s = fit.t - begun_s
    seen = (after_s >= 0.0) & (after_s <= min(predicted.after_s[-1], alone.after_s[-1]))
    after_s = after_s[seen]
    other = np.interp(after_s, predicted.after_s, predicted.values[k])
    other -= np.interp(after_s, alone.after_s, alone.values[k])
    band = half_widths(predicted.slopes[k], shared.covariance)
    half = scale * np.interp(after_s, predicted.after_s, band)
    return PredictedOutput(
        t=fit.t[seen],
        measured=fit.measured[seen],
        predicted=fit.fitted[seen] + scale * other,
        half=half,
        half_of_samples=np.hypot(half, NORMAL_95 * fit.noise),
    )
