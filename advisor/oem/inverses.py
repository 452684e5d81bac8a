"""The inverse of an information matrix that may leave parameters undetermined."""

import numpy as np

from advisor.flight.signals.messages import FloatArray

LEAST_EIGENVALUE = 1e-13
"""Eigenvalue of an information matrix with unit diagonal at which a direction counts as undetermined."""


def inverse_of(information: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the inverse of a symmetric matrix (n, n), and the undetermined share of each unknown (n,), 0 to
    1.

    The matrix is scaled to a unit diagonal, so that units do not matter. Directions in which the matrix is
    singular to working precision are left out.
    """
    diagonal = np.diag(information)
    scale = np.where(diagonal > 0.0, 1.0 / np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0)), 0.0)
    values, vectors = np.linalg.eigh(information * np.outer(scale, scale))
    dead = values <= LEAST_EIGENVALUE
    kept = np.where(dead, 0.0, 1.0 / np.where(dead, 1.0, values))
    result: FloatArray = (vectors * kept) @ vectors.T * np.outer(scale, scale)
    return result, np.sum(vectors[:, dead] ** 2, axis=1)
