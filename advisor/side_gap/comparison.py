"""The gap of the lateral axis: the simulator's derivatives and effects against those of the flight.

Derivatives are compared with their intervals, servos and clocks as the estimate tells them. ``diagnosis``
weighs right derivatives, wrong ones and effects. The gap is measured on manoeuvres that the fit has not seen,
of which only trims, initial states and biases are refitted.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import SIDE_PARAMETERS
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.messages import FloatArray
from advisor.gap.inference.prior import FIELD, FieldPrior
from advisor.gap.result import ComparedDerivative, Value
from advisor.oem.estimate import NoEstimate
from advisor.oem.lateral_estimate import LateralEstimate
from advisor.oem.lateral_estimator import estimate_lateral
from advisor.oem.lateral_prediction import predicted_lateral
from advisor.side_gap.diagnosis import Kind, SideDiagnosis, diagnose_side
from advisor.side_gap.models import case_of
from advisor.words.certainty import as_sure

LEVEL = 0.95
"""Level of the joint test that the simulator's numbers are those of the flight: that of every interval."""
HELD_OUT = 3
"""One in so many manoeuvres is held out, from the end."""


@dataclass(frozen=True, slots=True)
class SideGap:
    """Comparison of the aircraft file's lateral derivatives with the flight."""

    verdict: Kind | None
    """None: the file states no derivative that the flight tells, and no effect was found."""
    sentence: str
    derivatives: tuple[ComparedDerivative, ...]
    statistic: float
    """Square of the distance of all stated derivatives together, in standard deviations."""
    limit: float
    """Largest ``statistic`` at which the numbers are those of the flight."""
    instruments: Mapping[str, Value]
    """Lag or delay of servos and clocks, as the fit tells it."""
    not_identifiable: Mapping[str, str]
    maneuvers: tuple[int, ...]
    holdout: tuple[int, ...]
    """Numbers of the manoeuvres that the fit for the gap has not seen; empty where too few were flown."""
    before: Mapping[str, float]
    """Output to the simulator's gap on those manoeuvres."""
    after: Mapping[str, float]
    """Output to the gap with the derivatives of the flight."""
    diagnosis: SideDiagnosis | None
    """Probabilities of all explanations; None where no model fits."""


def compare_side(
    maneuvers: Sequence[Maneuver], aircraft: Aircraft, prior: FieldPrior = FIELD
) -> SideGap | NoEstimate:
    """Compare roll and yaw of the aircraft file with accepted manoeuvres.

    A derivative that the file does not state counts as that of the flight. ``prior`` holds the shares of the
    answers before the flight.
    """
    model = estimate_lateral(maneuvers, aircraft)
    if isinstance(model, NoEstimate):
        return model
    estimate = model.estimate
    stated = [
        k
        for k, name in enumerate(SIDE_PARAMETERS)
        if name in aircraft.model and name not in estimate.not_identifiable
    ]
    derivatives = tuple(
        ComparedDerivative(
            SIDE_PARAMETERS[k],
            aircraft.model[SIDE_PARAMETERS[k]],
            Value(float(estimate.theta[k]), float(estimate.std[k])),
        )
        for k in stated
    )
    off = np.array([one.given - one.found.value for one in derivatives])
    covariance = estimate.covariance[np.ix_(stated, stated)]
    statistic = float(off @ np.linalg.pinv(covariance, hermitian=True) @ off) if stated else 0.0
    limit = float(chi2.ppf(LEVEL, len(stated))) if stated else 0.0
    case = case_of(maneuvers, aircraft, estimate.theta)
    diagnosis = None if isinstance(case, NoEstimate) else diagnose_side(case, prior)
    verdict = _verdict(diagnosis, bool(stated), statistic > limit)
    sentence = (
        diagnosis.sentence
        if diagnosis and verdict in ("effect", "unknown")
        else _sentence(verdict, derivatives)
    )
    holdout, before, after = _held_out(maneuvers, aircraft, model)
    return SideGap(
        verdict,
        as_sure(sentence, diagnosis.answers) if verdict and diagnosis else sentence,
        derivatives,
        statistic,
        limit,
        {name: Value(*told) for name, told in model.nuisances.items()},
        estimate.not_identifiable,
        tuple(m.number for m in maneuvers),
        holdout,
        before,
        after,
        diagnosis,
    )


def _verdict(diagnosis: SideDiagnosis | None, stated: bool, off: bool) -> Kind | None:
    """Return the likeliest answer; by the joint region of the derivatives alone where no model fits."""
    likeliest = diagnosis.verdict if diagnosis else "parameters" if off else "none"
    return likeliest if stated or likeliest in ("effect", "unknown") else None


def _held_out(
    maneuvers: Sequence[Maneuver], aircraft: Aircraft, whole: LateralEstimate
) -> tuple[tuple[int, ...], Mapping[str, float], Mapping[str, float]]:
    """Return the manoeuvres held out, and their gap by output before and after; empty where the others do
    not fly every control."""
    kept = maneuvers[: -(len(maneuvers) // HELD_OUT)] if len(maneuvers) >= HELD_OUT else maneuvers[:0]
    unseen = maneuvers[len(kept) :]
    model = estimate_lateral(kept, aircraft)
    if isinstance(model, NoEstimate) or set(model.flown) != set(whole.flown):
        return (), {}, {}
    given = np.array(
        [
            aircraft.model.get(name, value)
            for name, value in zip(SIDE_PARAMETERS, model.estimate.theta, strict=True)
        ]
    )
    return (
        tuple(m.number for m in unseen),
        gap_on(unseen, model, aircraft, given),
        gap_on(unseen, model, aircraft, model.estimate.theta),
    )


def gap_on(
    maneuvers: Sequence[Maneuver], model: LateralEstimate, aircraft: Aircraft, theta: FloatArray
) -> Mapping[str, float]:
    """Return by output the mean square of the error over that of the noise, minus 1 and at least 0."""
    squares: dict[str, list[float]] = {}
    for maneuver in maneuvers:
        fits = predicted_lateral(maneuver, model, aircraft, theta)
        if not isinstance(fits, NoEstimate):
            for name, fit in fits.items():
                squares.setdefault(name, []).append((fit.rms / fit.noise) ** 2)
    return {name: max(0.0, float(np.mean(values)) - 1.0) for name, values in squares.items()}


def _sentence(verdict: str | None, derivatives: Sequence[ComparedDerivative]) -> str:
    if verdict is None:
        return (
            "The aircraft file states no derivative of roll and yaw that the flight tells: give model.L_p "
            "and the like."
        )
    if verdict == "none":
        return (
            "The simulator's derivatives of roll and yaw are those of the flight, and no effect is missing."
        )
    wrong = [one.name for one in derivatives if one.differs]
    listed = f": {', '.join(wrong)}" if wrong else " together, though none alone"
    return f"The simulator's derivatives of roll and yaw are not those of the flight{listed}."
