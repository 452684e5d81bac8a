"""Parameters of servos, instruments and propeller in a simulation along an axis.

Surfaces are those of the pitch axis: delay, lag, rate limit, play and dead band between command and
deflection (``gap.simulator.surface``). Instruments act on the outputs: skew of stamps, a scale error, an arm.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from advisor.gap.simulator.layout import ENTRIES, INDEX
from advisor.gap.simulator.surface import surface
from advisor.model.axis import Axis, Place
from advisor.oem.axis.problem import AxisAssembly, AxisProblem, lay_out
from advisor.oem.lag import lagged
from advisor.oem.rows import Signal
from advisor.oem.surface import LONGEST_STEP_S
from advisor.process.arrays import FloatArray

EXPONENT = ("speed", "exponent")
"""Place of the power of the air speed with which forces and moments grow beyond V²."""
DRIFT = "drift"
"""Second part of a change that grows steadily over the flight: ``mass@drift``."""
THROTTLE = "throttle"
"""First part of the place of the propeller's moment, which is stated as the deflection of a control."""


@dataclass(frozen=True, slots=True)
class Flown:
    """Records of a flight, prepared for the comparison with the simulator."""

    problem: AxisProblem
    """Records, whose servos and instruments are those of a ``Setting``."""
    throttle: tuple[Signal | None, ...]
    """Throttle of each record, 0..1; None where it was not recorded."""
    arm_is_stated: bool = False
    """Whether the aircraft file states the place of the sideslip vane."""
    derivatives: Mapping[str, float] = field(default_factory=dict)
    """Derivatives of the flight's estimate, by name."""

    @property
    def begins_s(self) -> FloatArray:
        """Shape (m,): time of the first sample of each record, s."""
        return np.array([r.outputs[self.axis.needed[0]].t[0] for r in self.problem.records])

    @property
    def ends_s(self) -> FloatArray:
        """Shape (m,): time of the last sample of each record, s."""
        return np.array([r.outputs[self.axis.needed[0]].t[-1] for r in self.problem.records])

    @property
    def axis(self) -> Axis:
        """Axis of the records."""
        return self.problem.axis

    def __len__(self) -> int:
        return len(self.problem.records)

    @property
    def foretold(self) -> np.ndarray:
        """Shape (m,): whether other manoeuvres move every control of the flight, so that they predict the
        manoeuvre."""
        base = self.problem
        each = (tuple(r for r in base.records if r is not left) for left in base.records)
        others = (replace(base, records=records) for records in each)
        return np.array([all(map(r.flies, filter(base.flies, base.axis.inputs))) for r in others])


Setting = Mapping[Place, FloatArray]
"""Parameter values by their place, shape (manoeuvres,) each; an absent value is zero, as in an ideal
aircraft."""


def moved_to(setting: Setting, places: Sequence[Place], values: FloatArray) -> Setting:
    """Return the setting with k values set at k places, equal in all manoeuvres."""
    count = len(next(iter(setting.values())))
    return {**setting, **{place: np.full(count, v) for place, v in zip(places, values, strict=True)}}


def laid_out(flown: Flown, setting: Setting) -> AxisAssembly:
    """Return the records in the memory layout of the simulation kernel, under a setting.

    A servo with lag and delay alone moves exactly, and its derivative by the lag is laid out. Any other servo
    is simulated in small steps, and its deflection is the input.
    """
    axis, values = flown.axis, {place: float(each[0]) for place, each in setting.items()}
    bent = {name for name in axis.inputs if _is_bent(name, setting)}
    records = flown.problem.records
    if bent:
        records = tuple(
            replace(
                r,
                inputs={n: deflection(flown, m, n, setting) if n in bent else s for n, s in r.inputs.items()},
                before={n: s for n, s in r.before.items() if n not in bent},
            )
            for m, r in enumerate(records)
        )
        values |= {(name, entry): 0.0 for name in bent for entry in ("lag_s", "delay_s")}
    # The slope by a delay jumps where a sample lies near a command's corner: a difference passes the corner.
    causes = [(name, "lag_s") for name in axis.inputs if name not in bent]
    laid = lay_out(replace(flown.problem, records=records, values=values), causes)
    factor = _factor(flown, setting, laid)
    return laid if factor is None else replace(laid, grid=laid.grid._replace(factor=factor))


def _factor(flown: Flown, setting: Setting, laid: AxisAssembly) -> FloatArray | None:
    """Return the further factor of each derivative and constant (E, d); None without one."""
    axis, grid = flown.axis, laid.grid
    exponent = setting.get(EXPONENT, np.zeros(1))[0]
    changes = [(place, float(v[0])) for place, v in setting.items() if "@" in place[0] and v[0] != 0.0]
    if not changes and exponent == 0.0:
        return None
    factor = np.repeat(grid.ratio[:, None] ** exponent, len(axis.place), axis=1)
    owner = np.repeat(np.arange(len(flown)), np.diff(grid.first))
    for place, value in changes:
        for k, growth in _grown(flown, place, value).items():
            factor[:, k] *= growth[owner]
    return factor


def _grown(flown: Flown, place: Place, value: float) -> Mapping[int, FloatArray]:
    """Return the factor of each changed derivative in each manoeuvre (m,), by the derivative's index."""
    change, moved = change_at(flown, place), share_of(flown, place) * value
    names = flown.axis.names.shared
    grown = {names.index(n): np.maximum(1.0 + w * moved, 0.1) for n, w in change.items()}
    divides = flown.axis.changes[place[0].partition("@")[0]].divides
    return {k: 1.0 / growth for k, growth in grown.items()} if divides else grown


def change_at(flown: Flown, place: Place) -> Mapping[str, float]:
    """Return the derivatives that a change multiplies, each with its weight."""
    change = flown.axis.changes[place[0].partition("@")[0]]
    return change.weights(flown.derivatives)[change.names.index(place[1])]


def share_of(flown: Flown, place: Place) -> FloatArray:
    """Return the share of a change in each manoeuvre, shape (m,).

    A change begins with a manoeuvre, or grows with the time since the first record.
    """
    _, _, since = place[0].partition("@")
    if since == DRIFT:
        passed = flown.begins_s - flown.begins_s[0]
        return np.asarray(passed / max(float(passed[-1]), 1.0))
    return (np.arange(len(flown)) >= int(since)).astype(float)


def column_of_change(
    flown: Flown, setting: Setting, place: Place, derivatives: FloatArray, g: FloatArray, owner: np.ndarray
) -> FloatArray:
    """Return the derivative of the outputs (N,) by a change, from those (N, d) by the derivatives."""
    value = float(setting[place][0]) if place in setting else 0.0
    share, change = share_of(flown, place), change_at(flown, place)
    names = flown.axis.names.shared
    sign = -1.0 if flown.axis.changes[place[0].partition("@")[0]].divides else 1.0
    column = np.zeros(len(g))
    for name, w in change.items():
        k = names.index(name)
        column += (
            (sign * w * share / np.maximum(1.0 + w * share * value, 0.1))[owner] * derivatives[k] * g[:, k]
        )
    return column


def filtered(laid: AxisAssembly, setting: Setting, columns: FloatArray) -> FloatArray:
    """Return outputs (N,), or columns (N, k) of their derivatives, behind the first-order filters of a
    setting."""
    lags = {of: float(v[0]) for (of, entry), v in setting.items() if entry == "filter_s"}
    lags = {of: lag for of, lag in lags.items() if lag > 0.0}
    if not lags:
        return columns
    passed = columns.reshape(len(columns), -1).copy()
    for named in laid.rows:
        for of, rows in ((of, named[of]) for of in lags if of in named):
            step = np.diff(laid.t[rows])
            for k in range(passed.shape[1]):
                y = np.ascontiguousarray(passed[rows, k])
                passed[rows, k] = lagged(step, y[:-1], y[1:], lags[of], y[0])
    return passed.reshape(columns.shape)


def _is_bent(name: str, setting: Setting) -> bool:
    """Return whether a servo does more than lag behind its command, or the propeller turns the aircraft."""
    entries = {entry for (of, entry), each in setting.items() if of == name and np.any(each)}
    turned = np.any(setting.get((THROTTLE, f"{name}_rad"), 0.0))
    return bool(entries - {"lag_s", "delay_s"}) or bool(turned)


def deflection(flown: Flown, m: int, control: str, setting: Setting) -> Signal:
    """Return the deflection of a surface in record ``m``, without the delay that all commands share."""
    p = np.zeros(len(ENTRIES))
    for (of, entry), values in setting.items():
        if of == control:
            p[INDEX[entry]] = values[m]
    record = flown.problem.records[m]
    moved = _deflected(record.command(control), float(record.inputs[control].y[0]), p)
    throttle, share = flown.throttle[m], setting.get((THROTTLE, f"{control}_rad"))
    if throttle is None or share is None or share[m] == 0.0:
        return moved
    t = np.union1d(moved.t, throttle.t)
    return Signal(t, moved.at(t) + share[m] * (throttle.at(t) - throttle.y[0]))


def _deflected(command: Signal, trim: float, p: FloatArray) -> Signal:
    """Return the deflection that follows from a command; ``p`` (entries,) holds the servo's parameters."""
    late = float(p[INDEX["delay_s"]])
    if np.ptp(command.y) == 0.0:
        return Signal(command.t[[0, -1]], command.y[[0, -1]])
    if np.count_nonzero(p) == (late != 0.0):
        return Signal(command.t + late, command.y)
    begin = float(command.t[0])
    n = int(np.ceil((command.t[-1] - begin) / LONGEST_STEP_S)) + 1
    mean = surface(LONGEST_STEP_S, n, command.t - begin, command.y, False, trim, p)
    t = begin + LONGEST_STEP_S * (np.arange(n, dtype=np.float64) + 0.5)
    return Signal(t, trim + mean)
