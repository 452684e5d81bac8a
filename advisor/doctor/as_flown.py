"""Conditions of the expected errors from the flown manoeuvres: amplitude, noise, colour and lag.

A joint estimate's errors also contain the scatter between the manoeuvres and the model's error. Noise and
colour therefore come from the manoeuvres' own estimates.
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
    """Return the assumptions with amplitude, noise, colour and lag of the flown manoeuvres.

    Parameters
    ----------
    maneuvers
        Manoeuvres in the order flown, at least one.
    joint
        Joint estimate of the manoeuvres, which determines the servo's lag best.
    """
    newest = maneuvers[-NEWEST:]
    singles = [one for m in newest if isinstance(one := estimate(m, assumed.aircraft), Estimate)] or [joint]
    noise = {name: _median([single.fits[0][name].noise for single in singles if name in single.fits[0]])
             for name in singles[-1].fits[0]}  # fmt: skip
    with np.errstate(divide="ignore", invalid="ignore"):
        ratios = np.array([single.std / single.std_cr for single in singles])
    colour = np.maximum(1.0, np.median(np.where(np.isfinite(ratios), ratios, 1.0), axis=0))
    amplitudes = [0.5 * float(np.degrees(np.ptp(flown_values(m, "elevator")))) for m in newest]
    return replace(
        assumed,
        noise=NOISE | noise,
        colour=colour,
        amplitude_deg=_median(amplitudes),
        lag_s=joint.servo_lag_s,
    )


def _median(values: Sequence[float]) -> float:
    return float(np.median(values))
