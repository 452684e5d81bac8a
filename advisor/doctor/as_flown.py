"""Assumed aircraft of the expected errors: amplitude, noise, lag and errors come from flown manoeuvres.

A joint estimate's errors also contain the scatter between the manoeuvres. Noise and errors therefore come
from the manoeuvres' own estimates. These errors contain the colour of the noise, the uncertain instruments
and moving air, because the estimator computes them.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import PARAMETERS
from advisor.campaign.joint_estimate import NEWEST
from advisor.decision.envelope import flown as flown_values
from advisor.decision.first_unit import frequency
from advisor.doctor.expectation import NOISE, TYPICAL, Assumed
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.model.short_period import ShortPeriod
from advisor.oem.estimate import Estimate
from advisor.oem.estimator import estimate, estimate_jointly

_PLAUSIBLE_RAD_S = (0.5, 40.0)
_EXPLAINED = 0.5
_KNOWN_SHARE = 0.3
_LEAST_EFFECT = 0.02  # of M_delta_e beside the square of the natural frequency


def assumed_of(maneuvers: Sequence[Maneuver], aircraft: Aircraft) -> Assumed:
    """Return the assumed aircraft and noise, from the file's model, the flown manoeuvres, or typical
    values.
    """
    flown = estimate_jointly(maneuvers, aircraft) if maneuvers else None
    seen = Assumed(TYPICAL, NOISE, "a typical aircraft of 10 kg (yours: model in the aircraft file)")
    seen = replace(seen, aircraft=aircraft)
    if isinstance(flown, Estimate):
        seen = as_flown(seen, maneuvers, flown)
    if {"Z_alpha", "M_alpha", "M_q", "M_delta_e"} <= aircraft.model.keys():
        model = ShortPeriod.from_mapping(aircraft.model)
        return replace(seen, model=model, source="the model in the aircraft file")
    if isinstance(flown, Estimate) and is_believable(flown):
        number = len(maneuvers)
        source = f"an estimate from {number} manoeuvre{'s' if number > 1 else ''} flown"
        return replace(seen, model=ShortPeriod(flown.theta), source=source)
    return seen


def as_flown(assumed: Assumed, maneuvers: Sequence[Maneuver], joint: Estimate) -> Assumed:
    """Return the assumptions with amplitude, noise, lag and errors of the flown manoeuvres.

    Parameters
    ----------
    maneuvers
        Manoeuvres in the order flown, at least one.
    joint
        Joint estimate of the manoeuvres, which determines the servo's lag best.
    """
    newest = maneuvers[-NEWEST:]
    singles = [(m, alone) for m in newest if isinstance(alone := estimate(m, assumed.aircraft), Estimate)]
    singles = singles or [(newest[-1], joint)]
    fits = [single.fits[0] for _, single in singles]
    noise = {name: _median([fit[name].noise for fit in fits if name in fit]) for name in fits[-1]}
    amplitudes = [0.5 * float(np.degrees(np.ptp(flown_values(m, "elevator")))) for m, _ in singles]
    amplitude = _median(amplitudes)
    # Errors fall with the amplitude.
    shares = np.array(amplitudes)[:, None] / amplitude
    return replace(
        assumed,
        noise=NOISE | noise,
        amplitude_deg=amplitude,
        lag_s=joint.servo_lag_s,
        flown_std=np.median(shares * np.array([single.std for _, single in singles]), axis=0),
    )


def is_believable(flown: Estimate) -> bool:
    """Return whether an estimate may represent the aircraft. It must explain the motion, and M_α and the
    control derivative must be significant.
    """
    low, high = _PLAUSIBLE_RAD_S
    pace = frequency(ShortPeriod(flown.theta))
    moved = low < pace < high and abs(flown.value("M_delta_e")) > _LEAST_EFFECT * pace**2
    explained = all(fit.r2 > _EXPLAINED for fits in flown.fits for fit in fits.values())
    judged = [PARAMETERS.index(name) for name in ("M_alpha", "M_delta_e")]
    sharp = bool(np.all(flown.std[judged] < _KNOWN_SHARE * np.abs(flown.theta[judged])))
    return moved and explained and sharp and not {"M_alpha", "M_delta_e"} & flown.not_identifiable.keys()


def _median(values: Sequence[float]) -> float:
    return float(np.median(values))
