"""The error of every simulator: two models that differ by less cannot be told apart by any number of
samples."""

from collections.abc import Sequence

import numpy as np

_MODEL = 0.005
"""Prior: error of every simulator, as a share of the peak."""
_FORM, _PLAY = 0.03, 0.1
"""Prior: error of an effect's form, as a share of its change; of play, dead bands and friction, which
differ from servo to servo."""
_INDEPENDENT = 40.0
"""Prior: number of independent numbers that such an error has."""


def form_error(names: Sequence[str], change: float) -> float:
    """Return the error of the outputs by the form of an effect, as a share of the peaks.

    Parameters
    ----------
    names
        Numbers of the effect.
    change
        Change of the outputs by the effect, as a share of the peaks.
    """
    return change * (_PLAY if "half_width_rad" in names else _FORM)


def most_nats(apart: float, *forms: float) -> float:
    """Return by how many nats two models differ at most.

    Parameters
    ----------
    apart
        Difference of their outputs, as a share of the peaks.
    forms
        Errors of the forms of their effects, as shares of the peaks.
    """
    error = float(np.linalg.norm((_MODEL, *forms)))
    return 0.5 * _INDEPENDENT * (apart / error) ** 2
