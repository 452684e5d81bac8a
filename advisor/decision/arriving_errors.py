"""Information that arrives while an input is flown, and the error of each derivative with this information.

S holds the sensitivities of the outputs by the derivatives, at the joint estimate of the manoeuvres before.
The samples up to a moment add the information M = Σ SᵀS/σ². The record's unknown initial states and constants
reduce M. Coloured noise reduces M by the factor by which it has widened the joint estimate. With P for the
joint covariance the covariance becomes (P⁻¹ + M)⁻¹ (Kay, Estimation Theory, 1993, ch. 8).
"""

from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass, replace
from math import inf

import numpy as np

from advisor.decision.arriving import Arriving
from advisor.decision.axes.influences import PITCH, SIDE, Motion, sensitivities
from advisor.decision.axes.lateral_stop import JUDGED
from advisor.decision.envelope import moved_controls
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.oem.axis.estimate import AxisEstimate
from advisor.oem.estimate import Estimate
from advisor.process.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Known:
    """Knowledge of one axis, to which the samples of an input add."""

    model: Estimate | None
    percent: Mapping[str, float | None]
    """Error of each judged derivative, % of its tolerance. None for an unknown derivative."""
    since_s: float = -inf
    """Vehicle time up to which the input's own samples are in the model, s since boot."""


def arriving(flying: Maneuver, until_s: float, pitch: Known, side: Known) -> Arriving:
    """Return the errors with the samples of an input up to a vehicle time."""
    moved = moved_controls(up_to(until_s, flying))
    percent: dict[str, float] = {}
    judged = [*pitch.percent] if "elevator" in moved else []
    if pitch.model is not None and judged:
        cut = up_to(until_s, flying, pitch.since_s)
        percent |= _added(cut, pitch, PITCH, {"q", "elevator"}, judged)
    names = [name for name, control in JUDGED.items() if control in moved and name in side.percent]
    if isinstance(side.model, AxisEstimate) and names:
        cut = up_to(until_s, flying, side.since_s)
        percent |= _added(cut, side, SIDE, {"p", "airspeed"}, names)
    return Arriving(until_s, percent, tuple(name for name in (*judged, *names) if name not in percent))


def up_to(until_s: float, flying: Maneuver, since_s: float = -inf) -> Maneuver:
    """Return an input with its samples between two vehicle times, s since boot."""
    from_s = max(flying.span.record_from_s, since_s)
    cut = flying.between(from_s, until_s)
    span = replace(flying.span, end_s=until_s, last_step_s=min(flying.span.last_step_s, until_s))
    return replace(cut, span=span, channels={name: c for name, c in cut.channels.items() if len(c) > 2})


def _added(
    cut: Maneuver, before: Known, motion: Motion, needed: Set[str], judged: Sequence[str]
) -> dict[str, float]:
    """Return the errors of the judged derivatives with the samples of a cut input."""
    model = before.model
    assert model is not None
    names = [name for name in judged if name in model.names]
    if not needed <= cut.channels.keys():
        return {name: percent for name in names if (percent := before.percent[name]) is not None}
    t, columns = sensitivities(motion, cut, model)
    return _after(cut, model, before.percent, t, columns, names)


def _after(
    cut: Maneuver,
    model: Estimate,
    before: Mapping[str, float | None],
    t: FloatArray,
    columns: Mapping[str, FloatArray],
    judged: Sequence[str],
) -> dict[str, float]:
    """Return the errors, with the new information, of the judged derivatives that were known before the
    input.
    """
    places = [
        k for k, name in enumerate(model.names) if model.covariance[k, k] > 0.0 and not name.endswith("_0")
    ]
    places = [k for k in places if model.names[k] not in model.not_identifiable]
    added = _information(cut, model, t, columns, places)
    own = model.own_covariance[np.ix_(places, places)]
    white = np.diag(model.own_covariance_cr)[places]
    wide = np.sqrt(np.maximum(np.diag(own) / np.maximum(white, 1e-300), 1.0))
    try:
        together = np.linalg.inv(np.linalg.inv(own) + added / np.outer(wide, wide))
    except np.linalg.LinAlgError:
        return {}
    common = np.diag(model.covariance)[places] - np.diag(own)
    ratio = np.sqrt((np.diag(together) + common) / (np.diag(own) + common))
    shares = dict(zip([model.names[k] for k in places], ratio.tolist(), strict=True))
    return {
        name: percent * shares[name]
        for name in judged
        if (percent := before[name]) is not None and name in shares
    }


def _information(
    cut: Maneuver, model: Estimate, t: FloatArray, columns: Mapping[str, FloatArray], places: Sequence[int]
) -> FloatArray:
    """Return the information on the known derivatives, with all other columns unknown."""
    fits = model.fits[-1]
    rows = [
        np.stack([np.interp(cut.channels[name].t, t, c) for c in columns[name].T], axis=1) / fits[name].noise
        for name in fits
        if name in columns and name in cut.channels
    ]
    whole = np.vstack(rows) if rows else np.zeros((1, next(iter(columns.values())).shape[1]))
    others = [k for k in range(whole.shape[1]) if k not in places]
    beside = whole[:, others]
    # The part of each sensitivity that no other column can take up.
    rest = whole[:, places] - beside @ np.linalg.lstsq(beside, whole[:, places], rcond=None)[0]
    return np.asarray(rest.T @ rest)
