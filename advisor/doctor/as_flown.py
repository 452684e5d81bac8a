"""Conditions of the expected errors from the flown manoeuvres: amplitude, noise, lag and stated errors.

A joint estimate's errors also contain the scatter between the manoeuvres. Noise and errors therefore come
from the manoeuvres' own estimates. These errors contain the colour of the noise, the uncertain instruments
and moving air, because the estimator computes them.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from advisor.campaign.joint_estimate import NEWEST
from advisor.decision.envelope import flown as flown_values
from advisor.doctor.expectation import NOISE, Assumed
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.oem.estimate import Estimate
from advisor.oem.estimator import estimate


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


def _median(values: Sequence[float]) -> float:
    return float(np.median(values))
