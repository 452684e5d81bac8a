"""Roll and yaw of the improved simulator on manoeuvres that no fit has used."""

from collections.abc import Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import SIDE_PARAMETERS
from advisor.analysis.side_gap import SideCompared
from advisor.exports.models.from_logs import behind_found
from advisor.exports.models.proof import Proof, parted, refuse_unimproved
from advisor.flight.instruments.atmosphere import air_flown
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.messages import FloatArray
from advisor.gap.inference.prior import FIELD, FieldPrior
from advisor.oem.estimate import NoEstimate
from advisor.oem.lateral_estimate import LateralEstimate
from advisor.oem.lateral_estimator import estimate_lateral
from advisor.side_gap.comparison import compare_side, gap_on
from advisor.words.problems import UnusableInputError


def prove_side(
    compared: SideCompared, fresh: Sequence[Maneuver] | None = None, prior: FieldPrior = FIELD
) -> Proof:
    """Improve roll and yaw by some manoeuvres, and fly others.

    Parameters
    ----------
    compared
        The comparison of the whole flight.
    fresh
        Manoeuvres of other logs; None keeps the last third apart.

    Raises
    ------
    UnusableInputError
        There are too few manoeuvres, nothing was improved, or the fit does not fly every control.
    """
    aircraft = compared.against
    fitted, kept = (compared.maneuvers, fresh) if fresh is not None else parted(compared.maneuvers)
    first = _answered(compare_side(fitted, aircraft, prior))
    refuse_unimproved(first.verdict, first.sentence, len(fitted))
    behind = behind_found(first.diagnosis, aircraft)
    plain, found = (_answered(estimate_lateral(fitted, one)) for one in (aircraft, behind))
    given = np.array(
        [aircraft.model.get(n, x) for n, x in zip(SIDE_PARAMETERS, plain.estimate.theta, strict=True)]
    )
    by_maneuver = tuple(
        (m.number, _gap(m, plain, aircraft, given), _gap(m, found, behind, found.estimate.theta))
        for m in kept
    )
    second = _answered(compare_side(kept, _with(found, behind, fitted), prior))
    present = [one.name for one in (first.diagnosis.causes if first.diagnosis else ()) if one.cause.present]
    return Proof(
        maneuvers=tuple(m.number for m in kept),
        before=float(np.mean([before for _, before, _ in by_maneuver])),
        after=float(np.mean([after for _, _, after in by_maneuver])),
        floor={name: fit.noise for name, fit in found.estimate.fits[0].items()},
        by_maneuver=by_maneuver,
        first=" + ".join(present) or str(first.verdict),
        second=second.verdict,
        sentence=second.sentence,
    )


def _gap(maneuver: Maneuver, model: LateralEstimate, aircraft: Aircraft, theta: FloatArray) -> float:
    by_output = gap_on([maneuver], model, aircraft, theta)
    return float(np.mean(list(by_output.values()))) if by_output else 0.0


def _with(found: LateralEstimate, aircraft: Aircraft, flown: Sequence[Maneuver]) -> Aircraft:
    """Return the aircraft file with the derivatives found, at an air speed as read."""
    estimate = found.estimate
    told = zip(SIDE_PARAMETERS, estimate.theta.tolist(), strict=True)
    model = {name: value for name, value in told if name not in estimate.not_identifiable}
    speed = estimate.airspeed_m_s
    read = None if speed is None else air_flown(flown).read_speed(speed)
    return replace(aircraft, model=model, reference_airspeed_m_s=read)


_Found = TypeVar("_Found")


def _answered(found: _Found | NoEstimate) -> _Found:
    """Return an answer, or refuse manoeuvres that gave none."""
    if isinstance(found, NoEstimate):
        raise UnusableInputError(
            found.code, f"--prove: {found.text}", "Fly aileron and rudder in both parts of the flight."
        )
    return found
