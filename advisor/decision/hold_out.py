"""Prediction of a manoeuvre's response from the earlier manoeuvres, with its band."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from advisor.decision.consistency import consensus
from advisor.decision.history import CandidateManeuver
from advisor.decision.pooling import DERIVATIVES, Shared, common_airspeed, posteriors_at_one_speed
from advisor.decision.prediction import PREDICTED, Response, measured, response_to
from advisor.flight.signals.messages import FloatArray
from advisor.flight.signals.record import Channel
from advisor.oem.estimate import Estimate
from advisor.oem.prediction import half_widths
from advisor.words.quantiles import NORMAL_95

FEWEST = 2
"""Fewest manoeuvres behind a prediction. A single manoeuvre has no confirmation of its errors."""


@dataclass(frozen=True, slots=True)
class PredictedOutput:
    """One output over the time of the manoeuvre, SI, at the stamps of its channel."""

    t: FloatArray
    """Stamps, shape (n,), s since boot."""
    measured: FloatArray
    """Measured output, shape (n,)."""
    predicted: FloatArray
    """Response by the earlier manoeuvres' derivatives, from this manoeuvre's own trim, shape (n,)."""
    half: FloatArray
    """Half-width of the 95 % band due to the errors of the derivatives alone, shape (n,)."""
    half_of_samples: FloatArray
    """Half-width of the band that holds 95 % of the samples, which includes their noise, shape (n,)."""


def predict_last(usable: Sequence[CandidateManeuver]) -> Mapping[str, PredictedOutput]:
    """Predict the last of the usable manoeuvres from all earlier ones, which are independent of it.

    Trim, initial state and biases are estimated for each manoeuvre. So they come from its own fit: the fit
    less the response from trim by its own derivatives.

    Parameters
    ----------
    usable
        Manoeuvres, each with an estimate, in the order flown.

    Returns
    -------
    Mapping
        Output to its prediction; empty with fewer than ``FEWEST`` manoeuvres before, and where the earlier
        ones leave a derivative open or the model runs away.
    """
    last = usable[-1] if len(usable) > FEWEST else None
    if last is None or last.maneuver is None or not isinstance(last.estimate, Estimate):
        return {}
    estimates = [flown.estimate for flown in usable if isinstance(flown.estimate, Estimate)]
    *before, own = posteriors_at_one_speed(estimates)
    airspeed_m_s = common_airspeed(estimates)
    known = consensus(before)[0].shared
    predicted = response_to(last, known.theta, airspeed_m_s)
    alone = response_to(last, own.theta[list(DERIVATIVES)], airspeed_m_s)
    if predicted is None or alone is None or not np.all(np.isfinite(known.covariance)):
        return {}
    begun_s = float(last.maneuver.channels["elevator"].t[0])
    return {
        name: _output(name, last, begun_s, known, predicted, alone)
        for name in measured(last)
        if name != "a_z" or _airspeed_m_s(last) is not None
    }


def _output(
    name: str, last: CandidateManeuver, begun_s: float, known: Shared, predicted: Response, alone: Response
) -> PredictedOutput:
    assert isinstance(last.estimate, Estimate)
    k, fit = PREDICTED.index(name), last.estimate.fits[0][name]
    scale = (_airspeed_m_s(last) or 1.0) if name == "a_z" else 1.0
    after_s = fit.t - begun_s
    seen = (after_s >= 0.0) & (after_s <= min(predicted.after_s[-1], alone.after_s[-1]))
    after_s = after_s[seen]
    other = np.interp(after_s, predicted.after_s, predicted.values[k])
    other -= np.interp(after_s, alone.after_s, alone.values[k])
    band = half_widths(predicted.slopes[k], known.covariance)
    half = scale * np.interp(after_s, predicted.after_s, band)
    return PredictedOutput(
        t=fit.t[seen],
        measured=fit.measured[seen],
        predicted=fit.fitted[seen] + scale * other,
        half=half,
        half_of_samples=np.hypot(half, NORMAL_95 * fit.noise),
    )


def _airspeed_m_s(flown: CandidateManeuver) -> float | None:
    channel: Channel | None = flown.maneuver.channels.get("airspeed") if flown.maneuver else None
    return float(np.nanmean(channel.y)) if channel is not None and np.any(np.isfinite(channel.y)) else None
