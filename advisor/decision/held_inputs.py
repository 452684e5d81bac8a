"""Exact response of a linear system to inputs that are held over each step, by the matrix exponential."""

import numpy as np

from advisor.process.arrays import FloatArray


def held_response(a: FloatArray, b: FloatArray, inputs: FloatArray, step_s: float) -> FloatArray:
    """Return the states of ẋ = A·x + b·u from zero, shape (n + 1, k), at the ends of n steps.

    Parameters
    ----------
    a, b
        Shapes (k, k) and (k,): matrices of the system.
    inputs
        Shape (n,): input u in each step.
    """
    from scipy.linalg import expm  # not on the start path

    k = len(b)
    joined = np.zeros((k + 1, k + 1))
    joined[:k, :k], joined[:k, k] = a, b
    step = expm(step_s * joined)
    states = np.zeros((len(inputs) + 1, k))
    for n, u in enumerate(inputs):
        states[n + 1] = step[:k, :k] @ states[n] + step[:k, k] * u
    return states
