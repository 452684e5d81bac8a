"""Description of one axis of the aircraft: states, inputs, outputs, and its table of parameters.

A model of an axis is linear in its parameters. With x the states, u the inputs and s = V/V_ref,

    ẋ_i = Σ_k θ_k·s^{power_k}·z_{column_k} + known terms,    z = (x, u, 1),

where the sum runs over the parameters of row i. The known terms hold kinematics and gravity, such as the
turn of the path and the weight of a banked aircraft. ``axis_response`` solves every such model, and the rooms
that estimate and diagnose read everything that they need of an axis from its table.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from advisor.process.arrays import FloatArray

CONSTANT = "1"
"""Name of the column of a constant, and of the known factor one."""
SINE, TURN = "sine", "turn"
"""Names of the columns with the sine of the bank, and with the yaw rate times the cosine of the bank."""
Place = tuple[str, str]
"""Control, output or signal, with the entry of its instrument: ``("aileron", "lag_s")``."""
Around = Mapping[Any, Any]
"""True air speed and other known signals by name, and the values of instruments by their place."""


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


class Known(NamedTuple):
    """A known term of a state's rate: a known factor times a column of z, ``SINE`` or ``TURN``."""

    state: str
    column: str
    factor: str
    number: Place | None = None
    """Open number by which the term is a derivative; None for a part of the rate itself."""
    sign: float = 1.0


class Read(NamedTuple):
    """A term of an output: a known factor times a state, or times the parameters' part of a state's rate."""

    output: str
    state: str
    factor: str = CONSTANT
    of_rate: bool = False
    number: Place | None = None
    """Open number by which the term is a derivative; None for a part of the output itself."""
    sign: float = 1.0


class Moment(NamedTuple):
    """A part of a state's rate that is proportional to a product of known signals."""

    state: str
    signals: tuple[str, ...]
    mean: float = 0.0
    std: float = np.inf
    """Mean and standard deviation of the prior of the factor; infinite for a factor that no aircraft has by
    nature."""


class Change(NamedTuple):
    """An effect that changes derivatives during the flight."""

    effect: str
    names: tuple[str, ...]
    """Parameters of the effect."""
    weights: Callable[[Mapping[str, float]], Sequence[Mapping[str, float]]]
    """Function of the derivatives that returns for each parameter v the derivatives that it multiplies by
    1 + w·v, each with its weight w."""
    std: float
    bounds: tuple[tuple[float, float], ...]
    divides: bool = False
    """Whether the derivatives are divided, as by a larger mass."""
    has_name: bool = True
    """Whether the effect is one of the catalogue; else it is a law without a name."""
    fixed: Mapping[str, float] = {}
    """Further parameters of the effect in the aircraft file."""


class Curve(NamedTuple):
    """A disturbance of one block by functions of the motion, in which the outputs are linear."""

    effect: str
    block: str
    names: tuple[str, ...]
    """Parameters of the effect, one for each function."""
    forms: Callable[[Mapping[str, FloatArray], Mapping[str, float]], Sequence[FloatArray]]
    """Functions of states, inputs, readings and rates relative to trim, and of the derivatives' sizes. A rate
    has the name of its state followed by an apostrophe, and a reading that of its block."""
    std: Callable[[Mapping[str, float], Mapping[str, float]], Sequence[float]]
    """Function of the derivatives' sizes and of the largest motion that returns the prior widths."""
    fixed: Mapping[str, float] = {}
    """Further parameters of the effect, which are not searched for."""
    has_name: bool = True
    """Whether the effect is one of the catalogue; else it is a law without a name."""


class Prior(NamedTuple):
    """Means and standard deviations of the priors of the derivatives, in their order; infinite without."""

    mean: FloatArray
    std: FloatArray


class Linear(NamedTuple):
    """Linear motion of an axis about straight flight, with n states, u inputs and o outputs."""

    matrix: FloatArray
    """Shape (n, n): rates of the states by the states."""
    aerodynamic: FloatArray
    """Shape (n, n + u): part of the rates that the parameters give, by the states and the inputs."""
    seen: FloatArray
    """Shape (o, n): outputs by the states."""
    seen_rates: FloatArray
    """Shape (o, n): outputs by the parameters' part of the rates, which ``seen`` contains already."""


class Reported(NamedTuple):
    """A quantity of the motion, such as the frequency of a mode, with its slope over the derivatives."""

    value: float
    slope: FloatArray


@dataclass(frozen=True, eq=False, kw_only=True)
class Axis:
    """Names, tables and facts of one axis. Every room that handles an axis is handed this description."""

    key: Literal["pitch", "lateral"] = "lateral"
    """Name of the axis in documents."""
    name: str = ""
    """Name of the axis in sentences."""
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    shared: tuple[Term, ...]
    """Derivatives, which all manoeuvres share."""
    constants: tuple[Term, ...]
    """Constants of trim, with a separate value for each manoeuvre."""
    biases: tuple[str, ...] = ()
    """Outputs with a separate constant error in each manoeuvre."""
    factors: Mapping[str, Callable[[Around], FloatArray | float]] = field(default_factory=dict)
    """Known factors by name, besides the factor one, as functions of the surroundings. A factor of a rate is
    taken in the middle of a step, and a factor of an output at the event."""
    turning: tuple[Known, ...] = ()
    """Known terms of the rates."""
    seen: tuple[Read, ...] = ()
    """Terms of the outputs."""
    open: tuple[Place, ...] = ()
    """Open numbers: errors of known signals. They change the motion, so the kernel computes their columns."""
    instruments: tuple[Place, ...] = ()
    """Places whose values the known factors need: the open numbers, and arms of sensors."""
    bank: str = ""
    """State whose sine and cosine enter; empty for none."""
    yaw: str = ""
    """State that the cosine multiplies."""
    needed: tuple[str, ...] = ()
    """Outputs that every record has."""
    given: tuple[str, ...] = ("airspeed",)
    """Signals of a record that the known factors need."""
    optional: tuple[str, ...] = ()
    """Those of them that are zero where a record lacks them."""
    body: str = ""
    """Specific force along the body, by which the hidden angle turns the measured force across the path."""
    moments: Mapping[Place, Moment] = field(default_factory=dict)
    """Parts of the rates by known signals, by the place of their factors."""
    changes: Mapping[str, Change] = field(default_factory=dict)
    """Effects that change derivatives between manoeuvres, by the first part of their places."""
    curves: tuple[Curve, ...] = ()
    """Nonlinear effects and laws; without them the laws are curves of each state and control."""
    computed: Mapping[Place, tuple[float, tuple[float, float]]] = field(default_factory=dict)
    """Prior standard deviation and bounds of each instrument of a hidden state that an autopilot computes."""
    filters: Mapping[str, float] = field(default_factory=dict)
    """Prior standard deviation of the delay by which an autopilot's filters make an output late, s."""
    relative_to: float = 0.1
    """Least size of a derivative for its relative error, over the derivative's natural size."""
    arms_are_causes: bool = False
    """Whether the arm of a vane is an effect of the diagnosis although the aircraft file states none."""
    blocks: Mapping[str, str] = field(default_factory=dict)
    """Block of the diagnosis of each control; a control without one is a block itself."""
    floor: Mapping[str, float] = field(default_factory=dict)
    """Least standard deviation of each output, SI."""
    letters: Mapping[str, str] = field(default_factory=dict)
    """State of each equation, by the letter with which the equation's derivatives begin."""
    spoken: Mapping[str, str] = field(default_factory=dict)
    """Quantity of the axis for each name in the expressions of added terms: ``phi`` for the bank."""
    hidden: str = ""
    """State that the other outputs show if no vane measures it; empty if every state is measured."""
    force: str = ""
    """Output with the specific force, from which the hidden state follows by integration."""
    clocks: tuple[str, ...] = ()
    """Outputs whose stamps may be late relative to the rates."""
    arms: tuple[str, ...] = ()
    """Outputs of vanes, whose arm is estimated where the aircraft file does not state it, else an effect."""
    errors: Mapping[Place, float] = field(default_factory=dict)
    """Prior standard deviation of the error of each known signal that is estimated."""
    follows: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    """For each input the rate that it may follow, and its moment about that axis."""
    rivals: Mapping[str, str] = field(default_factory=dict)
    """For an input the damping with whose pole the servo's lag can be exchanged: the roll mode's."""
    example: str = ""
    """Derivative that advice on the aircraft file names."""
    words: Mapping[str, str] = field(default_factory=dict)
    """Channels that every manoeuvre must have, each with its name in words."""
    inputs_to_fly: Mapping[str, str] = field(default_factory=dict)
    """Test input of each control in words."""
    equations: Mapping[str, str] = field(default_factory=dict)
    """State whose equation each block of the diagnosis belongs to, by the block's name."""
    sensors: Mapping[str, str] = field(default_factory=dict)
    """Output that each sensor block measures, by the block's name."""
    readings: Mapping[str, tuple[str, str, str]] = field(default_factory=dict)
    """For each output its name in words, the effect of late stamps, and the block of its scale error."""
    propeller: tuple[str, str, str] = ("", "", "")
    """Control whose deflection states the propeller's moment, the moment in words, and its sentence."""
    gust: tuple[str, str, str] = ("", "", "")
    """Moving air in words, in documents, and the name of its size, m/s."""
    natural_size: Callable[[FloatArray], Mapping[str, float]] = lambda _: {}
    """Function that returns the typical size of each derivative on an aircraft with given derivatives."""
    prior: Callable[[FloatArray, Sequence[str], bool, float], Prior] | None = None
    """Function that returns the priors for derivatives near given ones. It takes the inputs that are flown,
    whether an output shows the force, and the air speed, m/s."""
    weak: Mapping[str, float] = field(default_factory=dict)
    """Derivatives with a prior of their own, and its standard deviation."""
    qualities: Callable[[FloatArray, Around], tuple[Mapping[str, Reported], Mapping[str, str]]] | None = None
    """Function that returns the modes at a trim with their slopes, and the reason for each missing one."""

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
    def count(self) -> int:
        """Number of parameters of a manoeuvre, shared and local."""
        return len(self.names.shared) + len(self.names.local)

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

    @cached_property
    def initial(self) -> tuple[int, ...]:
        """Index of each state's first value among all parameters."""
        return tuple(range(len(self.place), len(self.place) + len(self.states)))

    @cached_property
    def turning_rows(self) -> NDArray[np.int64]:
        """Known terms of the rates as numbers, shape (a, 5), for ``axis_response.AxisGrid``."""
        columns = (*self.states, *self.inputs, CONSTANT, SINE, TURN)
        rows = [
            (self.states.index(k.state), columns.index(k.column), *self._numbered(k)) for k in self.turning
        ]
        return np.array(rows, np.int64).reshape(-1, 5)

    @cached_property
    def seen_rows(self) -> NDArray[np.int64]:
        """Terms of the outputs as numbers, shape (b, 5), for ``axis_response.AxisGrid``."""
        n = len(self.states)
        rows = [
            (self.outputs.index(r.output), self.states.index(r.state) + n * r.of_rate, *self._numbered(r))
            for r in self.seen
            if r.number is None or r.number in self.open
        ]
        return np.array(rows, np.int64).reshape(-1, 5)

    def _numbered(self, term: Known | Read) -> tuple[int, int, int]:
        number = -1 if term.number is None else self.count + self.open.index(term.number)
        return (CONSTANT, *self.factors).index(term.factor), number, int(term.sign)

    @cached_property
    def of_outputs(self) -> frozenset[str]:
        """Names of the known factors of the outputs."""
        return frozenset(read.factor for read in self.seen) - {CONSTANT}

    @cached_property
    def least(self) -> FloatArray:
        """Least standard deviation of each output, shape (outputs,), SI."""
        return np.array([self.floor[name] for name in self.outputs])

    @cached_property
    def controls(self) -> Mapping[str, str]:
        """Name of each input, by the ending of its derivatives."""
        return {t.name.partition("_")[2]: t.factor for t in self.shared if t.factor in self.inputs}

    def linear(self, theta: FloatArray, around: Around) -> Linear:
        """Return the linear motion about straight flight with derivatives ``theta`` (s,) at its air speed."""
        n, u = len(self.states), len(self.inputs)
        columns = (*self.states, *self.inputs)
        aerodynamic = np.zeros((n, n + u))
        for value, (row, column, _) in zip(theta, self.place, strict=False):
            if column < n + u:
                aerodynamic[row, column] += value
        matrix = aerodynamic[:, :n].copy()
        # About wings-level flight the sine is the bank itself, and the cosine is one.
        level = {SINE: self.bank, TURN: self.yaw}
        for k in self.turning:
            column = level.get(k.column, k.column)
            if k.number is None and column in self.states:
                matrix[self.states.index(k.state), columns.index(column)] += self._factor(k.factor, around)
        seen, rates = np.zeros((2, len(self.outputs), n))
        for r in self.seen:
            if r.number is None:
                into = rates if r.of_rate else seen
                into[self.outputs.index(r.output), self.states.index(r.state)] += self._factor(
                    r.factor, around
                )
        return Linear(matrix, aerodynamic, seen + rates @ aerodynamic[:, :n], rates)

    def _factor(self, name: str, around: Around) -> float:
        return 1.0 if name == CONSTANT else float(self.factors[name](around))
