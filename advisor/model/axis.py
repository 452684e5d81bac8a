"""Description of one axis of the aircraft: states, inputs, outputs, and its table of parameters.

A model of an axis is linear in its parameters. With x the states, u the inputs and s = V/V_ref,

    ẋ_i = Σ_k θ_k·s^{power_k}·z_{column_k} + known terms,    z = (x, u, 1),

where the sum runs over the parameters of row i. The known terms hold kinematics and gravity, such as the
turn of the path and the weight of a banked aircraft. ``axis_response`` solves every such model.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

CONSTANT = "1"
"""Name of the column of a constant."""


@dataclass(frozen=True)
class Names:
    """Names of a model's outputs and parameters, in the order in which the model's vectors hold them."""

    outputs: tuple[str, ...]
    shared: tuple[str, ...]
    """Parameters that all manoeuvres share."""
    local: tuple[str, ...]
    """Parameters with a separate value for each manoeuvre."""
    reported: tuple[str, ...]
    """Parameters in the result of an estimate. The reported value of a local parameter is its mean over the
    manoeuvres."""

    @cached_property
    def places(self) -> tuple[tuple[bool, int], ...]:
        """Position of each reported parameter: whether it is shared, and its index."""
        return tuple(
            (name in self.shared, (self.shared if name in self.shared else self.local).index(name))
            for name in self.reported
        )


@dataclass(frozen=True, slots=True)
class Term:
    """One parameter of an axis."""

    name: str
    state: str
    """State whose time derivative contains the parameter."""
    factor: str
    """State or input that the parameter multiplies, or ``CONSTANT``."""
    power: int
    """Power of the air speed to which the parameter is proportional at constant density."""


@dataclass(frozen=True)
class Axis:
    """Names and indices of all quantities of one axis."""

    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    shared: tuple[Term, ...]
    """Derivatives, which all manoeuvres share."""
    constants: tuple[Term, ...]
    """Constants of trim, with a separate value for each manoeuvre."""
    biases: tuple[str, ...]
    """Outputs with a separate constant error in each manoeuvre."""

    @cached_property
    def names(self) -> Names:
        """Names of outputs and parameters. Local parameters are constants, initial states and biases."""
        derivatives = tuple(term.name for term in self.shared)
        local = (
            *(term.name for term in self.constants),
            *(f"{state}_initial" for state in self.states),
            *(f"{output}_bias" for output in self.biases),
        )
        return Names(self.outputs, derivatives, local, derivatives)

    @cached_property
    def place(self) -> NDArray[np.int64]:
        """Row, column and power of the air speed of each derivative and constant, shape (k, 3)."""
        columns = (*self.states, *self.inputs, CONSTANT)
        return np.array(
            [
                (self.states.index(term.state), columns.index(term.factor), term.power)
                for term in (*self.shared, *self.constants)
            ],
            np.int64,
        )

    @cached_property
    def bias(self) -> NDArray[np.int64]:
        """Index of each output's bias among all parameters, shape (outputs,); -1 without one."""
        first = len(self.shared) + len(self.constants) + len(self.states)
        return np.array(
            [first + self.biases.index(name) if name in self.biases else -1 for name in self.outputs],
            np.int64,
        )
