"""Prediction of a lateral manoeuvre with given derivatives, and with refitted trims, initial states and
biases."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.model.axes.lateral import LATERAL
from advisor.oem.axes.lateral.estimate import LateralEstimate
from advisor.oem.axes.lateral.instruments import nuisances_of
from advisor.oem.axes.lateral.motion import LateralMotion
from advisor.oem.axes.lateral.prepare import prepare_lateral
from advisor.oem.axes.lateral.problem import LateralProblem
from advisor.oem.axes.lateral.start import lateral_start
from advisor.oem.descent import descended
from advisor.oem.estimate import ChannelFit, NoEstimate
from advisor.oem.estimator import channel_fits
from advisor.oem.prior import Priors
from advisor.process.arrays import FloatArray

HELD = 1e-6
"""Numerical: standard deviation of the given derivatives in the refit, SI."""


def predicted_lateral(
    maneuver: Maneuver, model: LateralEstimate, aircraft: Aircraft, theta: FloatArray | None = None
) -> Mapping[str, ChannelFit] | NoEstimate:
    """Return measured and predicted values of a manoeuvre, by the output's name.

    Parameters
    ----------
    model
        Estimate from other manoeuvres, including the instruments.
    theta
        Derivatives (15,) at the model's speed; None for the model's own derivatives.
    """
    prepared = prepare_lateral([maneuver], aircraft)
    if isinstance(prepared, NoEstimate):
        return prepared
    problem = _as_in(prepared, model, aircraft)
    chosen = model.theta if theta is None else theta
    local = lateral_start(problem)[1]
    local[0, : len(LATERAL.constants)] = 0.0
    held = Priors(chosen, np.full(len(chosen), HELD))
    fit = descended(LateralMotion(), problem, (), held, (chosen, local))
    return fit if isinstance(fit, NoEstimate) else channel_fits(fit.assembly, fit.optimum)[0]


def _as_in(problem: LateralProblem, model: LateralEstimate, aircraft: Aircraft) -> LateralProblem:
    """Return the problem with the air speed, outputs and instruments of the model."""
    outputs = model.fits[0]
    (record,) = problem.records
    kept = {name: signal for name, signal in record.outputs.items() if name in outputs}
    problem = replace(problem, records=(replace(record, outputs=kept),))
    if model.scales_with_speed:
        problem = replace(problem, reference_airspeed_m_s=model.airspeed_m_s)
    for x in nuisances_of(problem, aircraft):
        if x.name in model.nuisances:
            problem = x.write(problem, model.nuisances[x.name][0])
    return problem
