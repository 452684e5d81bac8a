"""Prediction of a lateral manoeuvre with given derivatives, and with refitted trims, initial states and
biases."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.messages import FloatArray
from advisor.model.axes.lateral import LATERAL
from advisor.oem.axes.lateral.estimate import LateralEstimate
from advisor.oem.axes.lateral.instruments import nuisances_of
from advisor.oem.axes.lateral.motion import outputs_of, simulate
from advisor.oem.axes.lateral.prepare import prepare_lateral
from advisor.oem.axes.lateral.problem import LateralAssembly, LateralProblem, assemble_lateral
from advisor.oem.axes.lateral.start import lateral_start
from advisor.oem.estimate import ChannelFit, NoEstimate

ROUNDS = 12
"""Number of Gauss-Newton steps of the refit. The outputs are nearly linear in trims, initial states and
biases."""


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
    assembly = assemble_lateral(problem)
    noise = {name: fit.noise for name, fit in model.fits[0].items()}
    chosen = model.theta if theta is None else theta
    fitted = _refitted(assembly, problem, chosen, noise)
    return {
        name: ChannelFit(name, assembly.t[rows], assembly.z[rows], fitted[rows], noise[name])
        for name, rows in assembly.rows[0].items()
    }


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


def _refitted(
    assembly: LateralAssembly, problem: LateralProblem, theta: FloatArray, noise: Mapping[str, float]
) -> FloatArray:
    """Return the outputs (N,) at the best trims, initial states and biases."""
    n = len(LATERAL.names.shared)
    own = assembly.own
    weight = np.array([1.0 / noise[LATERAL.outputs[c]] for c in assembly.channel])
    local = lateral_start(problem)[1]
    local[0, : len(LATERAL.constants)] = 0.0
    for _ in range(ROUNDS):
        found = simulate(assembly, theta, local)
        if found is None:
            break
        y, g, _motion = found
        step = np.linalg.lstsq(g[:, own] * weight[:, None], (assembly.z - y) * weight, rcond=None)[0]
        local[0, own - n] += step
    return outputs_of(assembly, theta, local)
