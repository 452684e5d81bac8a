"""Minimisation of J = det R, Eq. (7), by Gauss-Newton steps with R re-estimated at every step.

R = diag(σ_c²) at its own maximum-likelihood value makes minimising Σ n_c·log σ_c² equal to minimising det R.
The gradient equals that of the weighted sum of squares at the present R, so the weights are 1/σ_c². The
source is Maine & Iliff, *Formulation and implementation of a practical algorithm for parameter estimation
with process and measurement noise*, 1981. Levenberg's damping is used only after a rejected step, and begins
far below the usual size. A diverging aircraft's record has directions with 1e-9 of the information of others,
which larger damping would freeze.
"""

from typing import NamedTuple

import numpy as np

from advisor.model.response import Grid, Index, respond
from advisor.oem.arrow import arrow_step, normal_equations
from advisor.process.arrays import FloatArray
from advisor.process.compiled import kernel

FLAT = 1e-11
"""Promised change of log J below which a step ends the search. Further steps would change log J far less."""
MOST_ITERATIONS = 120
FIRST_DAMPING = 1e-8
"""First damping relative to the diagonal. Damping of this size does not hide a step that promises a
decrease."""
LEAST_DAMPING = 1e-12
DAMPING_FACTOR = 10.0
LEAST_NOISE = 1e-10
"""Least σ relative to the spread of the channel, for data without noise."""

WITHOUT_NOISE = 1e4
"""Factor on the least noise below which residuals are rounding errors of noise-free data."""

CONVERGED, EXHAUSTED, OVERFLOW, SINGULAR = 0, 1, 2, 3


class Optimum(NamedTuple):
    """Result of a search for the least cost."""

    status: int
    """``CONVERGED``, ``EXHAUSTED`` (too many iterations), ``OVERFLOW`` or ``SINGULAR``."""
    shared: FloatArray
    """Shape (s,): parameters that all manoeuvres share."""
    local: FloatArray
    """Shape (m, l): local parameters of each manoeuvre."""
    noise: FloatArray
    """Shape (outputs,): noise σ of each output; 0 for an unmeasured output."""
    log_likelihood_cost: float
    """Cost Σ n_c·log σ_c² at the optimum."""
    iterations: int
    fitted: FloatArray
    """Shape (N,): outputs of the model at the optimum."""
    sensitivities: FloatArray
    """Shape (N, s + l): derivatives of the outputs by the parameters of the row's manoeuvre."""


@kernel()
def weigh(z: FloatArray, y: FloatArray, channel: Index, floor: FloatArray) -> tuple[FloatArray, float]:
    """Return σ of each output from its residuals, Eq. (8), and the cost Σ n_c·log σ_c²."""
    outputs = len(floor)
    power = np.zeros(outputs)
    count = np.zeros(outputs)
    for i in range(len(z)):
        power[channel[i]] += (z[i] - y[i]) ** 2
        count[channel[i]] += 1.0
    noise = np.zeros(outputs)
    cost = 0.0
    for c in range(outputs):
        if count[c] > 0.0:
            noise[c] = max(np.sqrt(power[c] / count[c]), floor[c])
            cost += 2.0 * count[c] * np.log(noise[c])
    return noise, cost


@kernel()
def descend(
    grid: Grid,
    z: FloatArray,
    channel: Index,
    owner: Index,
    free: Index,
    floor: FloatArray,
    prior: FloatArray,
    shared: FloatArray,
    local: FloatArray,
    flat: float,
) -> Optimum:
    """Minimise Σ n_c·log σ_c² from a start. Shapes are as in ``Laid``; ``floor`` (outputs,) is the least σ.

    ``prior`` (s,) holds the inverse prior variances of the shared parameters about zero.
    """
    shared, local = shared.copy(), local.copy()
    maneuvers, parameters = len(local), len(shared) + local.shape[1]
    y, g = np.empty(len(z)), np.empty((len(z), parameters))
    y_trial, g_trial = np.empty(len(z)), np.empty((len(z), parameters))
    if not respond(grid, shared, local, y, g):
        return Optimum(OVERFLOW, shared, local, np.zeros(len(floor)), np.inf, 0, y, g)
    noise, cost = weigh(z, y, channel, floor)
    cost += np.sum(prior * shared**2)
    damping = 0.0
    status = EXHAUSTED
    iteration = 0
    while iteration < MOST_ITERATIONS:
        iteration += 1
        information, gradient = normal_equations(maneuvers, z - y, g, channel, owner, free, noise)
        for j in range(len(free)):
            if free[j] < len(shared):
                information[0, j, j] += prior[free[j]]
                gradient[0, j] -= prior[free[j]] * shared[free[j]]
        accepted = False
        for _ in range(16):
            fine, shared_step, local_step, promise = arrow_step(
                information, gradient, free, damping, len(shared), local.shape[1]
            )
            if fine:
                trial, trial_local = shared + shared_step, local + local_step
                if respond(grid, trial, trial_local, y_trial, g_trial):
                    trial_noise, trial_cost = weigh(z, y_trial, channel, floor)
                    trial_cost += np.sum(prior * trial**2)
                    if trial_cost <= cost:
                        accepted = True
                        break
                if promise < flat * len(z):
                    return Optimum(CONVERGED, shared, local, noise, cost, iteration, y, g)
            damping = max(FIRST_DAMPING, DAMPING_FACTOR * damping)
        if not accepted:
            # Not even a tiny step lowers the cost: only round-off remains.
            status = CONVERGED if fine else SINGULAR
            break
        shared, local, noise, cost = trial, trial_local, trial_noise, trial_cost
        y, y_trial = y_trial, y
        g, g_trial = g_trial, g
        if promise < flat * len(z) and damping <= FIRST_DAMPING:
            status = CONVERGED
            break
        damping = damping / DAMPING_FACTOR if damping > LEAST_DAMPING else 0.0
    if status == EXHAUSTED and np.all(noise <= WITHOUT_NOISE * floor):
        status = CONVERGED
    return Optimum(status, shared, local, noise, cost, iteration, y, g)
