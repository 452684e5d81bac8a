"""Information that arrives while an input is flown, and the error of each derivative with this information.

S holds the sensitivities of the outputs by the derivatives, at the joint estimate of the manoeuvres before.
The samples up to a moment add the information M = Σ SᵀS/σ². The record's initial states and constants take
their share of M away. Coloured noise lowers M as it has widened the joint estimate. With P for the joint
covariance the covariance becomes (P⁻¹ + M)⁻¹ (Kay, Estimation Theory, 1993, ch. 8).
"""

from collections.abc import Mapping, Sequence

import numpy as np

from advisor.decision.arriving import Arriving
from advisor.decision.axes.lateral_omitted import side_sensitivities
from advisor.decision.axes.lateral_stop import JUDGED
from advisor.decision.envelope import moved_controls
from advisor.decision.omitted import sensitivities
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.oem.axes.lateral.estimate import LateralEstimate
from advisor.oem.estimate import Estimate
from advisor.process.arrays import FloatArray


def arriving(
    flying: Maneuver,
    until_s: float,
    pitch: tuple[Estimate | None, Mapping[str, float | None]],
    side: tuple[LateralEstimate | None, Mapping[str, float | None]],
) -> Arriving:
    """Return the errors with the samples of an input up to a vehicle time.

    Parameters
    ----------
    pitch, side
        Joint estimate of each axis, and the error of each derivative before, % of its tolerance.
    """
    channels = {name: c.cut(flying.span.record_from_s, until_s) for name, c in flying.channels.items()}
    cut = Maneuver(flying.number, flying.boot, flying.span, {n: c for n, c in channels.items() if len(c) > 2})
    moved = moved_controls(cut)
    percent: dict[str, float] = {}
    model, before = pitch
    if model is not None and "elevator" in moved and "q" in cut.channels:
        t, columns = sensitivities(cut, model)
        percent |= _after(cut, model, before, t, columns, [n for n in before if n in model.names])
    lateral, side_before = side
    names = [name for name, control in JUDGED.items() if control in moved and name in side_before]
    if lateral is not None and names and {"p", "airspeed"} <= cut.channels.keys():
        t, columns = side_sensitivities(cut, lateral)
        percent |= _after(cut, lateral, side_before, t, columns, names)
    return Arriving(until_s, percent)


def _after(
    cut: Maneuver,
    model: Estimate,
    before: Mapping[str, float | None],
    t: FloatArray,
    columns: Mapping[str, FloatArray],
    judged: Sequence[str],
) -> dict[str, float]:
    """Return the errors of the judged derivatives that are known before, with the new information."""
    known = [
        k for k, name in enumerate(model.names) if model.covariance[k, k] > 0.0 and not name.endswith("_0")
    ]
    known = [k for k in known if model.names[k] not in model.not_identifiable]
    added = _information(cut, model, t, columns, known)
    own = model.own_covariance[np.ix_(known, known)]
    white = np.diag(model.own_covariance_cr)[known]
    wide = np.sqrt(np.maximum(np.diag(own) / np.maximum(white, 1e-300), 1.0))
    try:
        together = np.linalg.inv(np.linalg.inv(own) + added / np.outer(wide, wide))
    except np.linalg.LinAlgError:
        return {}
    common = np.diag(model.covariance)[known] - np.diag(own)
    ratio = np.sqrt((np.diag(together) + common) / (np.diag(own) + common))
    shares = dict(zip([model.names[k] for k in known], ratio.tolist(), strict=True))
    return {
        name: percent * shares[name]
        for name in judged
        if (percent := before[name]) is not None and name in shares
    }


def _information(
    cut: Maneuver, model: Estimate, t: FloatArray, columns: Mapping[str, FloatArray], known: Sequence[int]
) -> FloatArray:
    """Return the information on the known derivatives, with all other columns unknown."""
    fits = model.fits[-1]
    rows = [
        np.stack([np.interp(cut.channels[name].t, t, c) for c in columns[name].T], axis=1) / fits[name].noise
        for name in fits
        if name in columns and name in cut.channels
    ]
    whole = np.vstack(rows) if rows else np.zeros((1, next(iter(columns.values())).shape[1]))
    others = [k for k in range(whole.shape[1]) if k not in known]
    beside = whole[:, others]
    # The part of each sensitivity that no other column can take up.
    rest = whole[:, known] - beside @ np.linalg.lstsq(beside, whole[:, known], rcond=None)[0]
    return np.asarray(rest.T @ rest)
