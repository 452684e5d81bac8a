"""Solution and errors at one setting of all parameters, next to unknown forces."""

from dataclasses import replace

import numpy as np

from advisor.oem.arrow import inverse_of
from advisor.oem.driven_motion.noise import Noise
from advisor.oem.driven_motion.normal_equations import System
from advisor.oem.driven_motion.setting import Model, Setting
from advisor.oem.evaluation import errors_of
from advisor.oem.rows import Laid
from advisor.oem.solution import Solution, reported
from advisor.process.arrays import FloatArray

SCALE = 0.03 / 3.0**0.5
"""Standard deviation of the scale of an instrument, relative. Data sheets of autopilots' gyros and
accelerometers allow 3 % to either side. Residuals show a part of it, and the derivatives absorb the rest."""


def _scaled(laid: Laid, y: FloatArray) -> FloatArray:
    """Return the change (N, o) of the outputs ``y`` by a standard deviation of each output's scale."""
    columns = np.zeros((len(y), len(laid.names.outputs)))
    for named in laid.rows:
        for name, rows in named.items():
            columns[rows, laid.names.outputs.index(name)] = SCALE * (y[rows] - y[rows].mean())
    return columns


def solution_at(model: Model, start: Solution, setting: Setting, noise: Noise) -> Solution | None:
    """Return the solution at a setting, with Cramér-Rao errors and errors for coloured innovations."""
    laid, fitted = setting.assembly, setting.assembly.z - setting.residual
    unsure = np.column_stack([model.motion.unsure(laid, fitted), _scaled(laid, fitted)])
    white, _ = setting.whitened(
        np.column_stack([setting.residual, setting.sensitivities, setting.extra.columns, unsure]), noise
    )
    size, split = unsure.shape[1], 1 + setting.sensitivities.shape[1]
    left, g, extra, unsure = np.split(white, [1, split, white.shape[1] - size], axis=1)
    prior = model.prior(setting)
    errors = errors_of(
        laid,
        left[:, 0],
        g,
        np.ones(len(laid.names.outputs)),
        setting.extra.whitened(extra),
        np.asarray(prior.std**-2.0),
        prior_share=prior.share,
    )
    if errors is None:
        return None
    # The estimate keeps the scales at 1: their posterior second moment is the error.
    ordered = np.column_stack([left, g[:, laid.own], g[:, laid.common], extra, unsure])
    system = System.of(setting, ordered, prior, size)
    shown = system.step({})[-size:]
    moment = inverse_of(system.information)[0][-size:, -size:] + np.outer(shown, shown)
    pulled = errors["influence"].rows.T @ unsure
    # Dynamics that the model lacks do not stand out in innovations: their error is that of output error.
    systematic, kept = pulled @ moment @ pulled.T, min(len(pulled), len(start.systematic))
    systematic[:kept, :kept] += start.systematic[:kept, :kept]
    errors["systematic"] = systematic
    optimum = start.optimum._replace(
        shared=setting.shared, local=setting.local, fitted=fitted, sensitivities=setting.sensitivities
    )
    return replace(
        start,
        problem=setting.problem,
        assembly=laid,
        optimum=optimum,
        theta=reported(setting.shared, setting.local, laid.names),
        extra=setting.extra,
        parameters=model.parameters,
        modes=None,
        alike=None,
        **errors,
    )
