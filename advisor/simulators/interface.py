"""Signs and units of a simulator, from the kinematics of its own replay, without aerodynamics.

In still air and in the vertical plane

    θ̇ = q        α̇ = q + (a_z·cos α − a_x·sin α + g·cos γ)/V        a_z = −g·cos θ in steady level flight

(Klein and Morelli, *Aircraft System Identification*, chapter 10). A factor of −1 or 180/π between both sides
is a wrong sign or unit, if the motion is consistent without it. The tests of the interface need neither a
flight nor a model of the simulator. A control must have the convention's sign, and a control in degrees has
57 times less effect.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import degrees, log
from typing import Any

import numpy as np

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.flight.signals.derived_alpha import integrated
from advisor.flight.signals.record import rms
from advisor.process.arrays import FloatArray
from advisor.simulators.protocol import Replay
from advisor.words.problems import UnusableInputError

_PER_RAD = degrees(1.0)
_NEAR = log(1.5)
"""Largest absolute logarithm of the ratio between a factor and a unit's factor that identifies the unit.
Units differ by a factor of 3 or more."""
_MOVES_RAD = 1e-4
"""Least range of ∫q dt, rad, for a test of the units. A real test input moves the nose by a hundred times
this range."""
_MENDS = 0.5
"""Largest share of the motion's inconsistency that may remain after correction of a sign or unit. Without a
fault, a change of sign or unit increases the inconsistency."""
_SMALL_RAD = 0.7
"""Largest angle of attack or pitch angle, rad, of a test manoeuvre: 40 deg."""


_NAMES = {"alpha": "α", "theta": "θ"}


@dataclass(frozen=True)
class InterfaceFault:
    """Wrong sign or unit of one quantity of a simulator."""

    quantity: str
    observed: str
    """Sign or unit of the quantity, in words."""
    fix: str

    def refuse(self, description: str) -> UnusableInputError:
        return UnusableInputError(
            "simulator_interface", f"{description} gives {self.quantity} {self.observed}.", self.fix
        )


def interface_fault(replay: Replay) -> InterfaceFault | None:
    """Return the first wrong sign or unit of a replay's outputs; None if they are consistent."""
    a_z = float(replay.a_z[0])
    if _is(a_z, GRAVITY_M_S2):
        return _sign("a_z", f"as {a_z:+.2f} m/s² in steady flight, where body z down gives -9.81")
    if _is(a_z, 1.0) or _is(a_z, -1.0):
        observed = f"as {a_z:+.2f} in steady flight, which is a number of g, where -9.81 m/s² is expected"
        return InterfaceFault("a_z", observed, "Multiply by 9.80665 (scale: {a_z: ...}), negative in flight.")
    if abs(a_z) < 0.1 * GRAVITY_M_S2:
        observed = f"as {a_z:+.2f} m/s² in steady flight, an acceleration without the weight"
        return InterfaceFault("a_z", observed, "Give the specific force, which an accelerometer reads.")
    large = [name for name in _NAMES if np.max(np.abs(getattr(replay, name))) > _SMALL_RAD]
    if large:
        # A large angle may also be that of a simulator that departs.
        observed = " and ".join(_NAMES[name] for name in large)
        in_degrees = any(_agrees(_in_radians(replay, names)) for names in (large, [*large, "q"]))
        mend = "Give angles in rad, and check q, which is in rad/s."
        return InterfaceFault(observed, "in degrees", mend) if in_degrees else None
    turned = integrated(replay.t, replay.q)
    if np.ptp(turned) < _MOVES_RAD:
        return None
    fault = _of_the_angles(replay, turned)
    # Parallel motions of θ and α leave the slopes open: a fault must also mend the motion.
    mended = fault is not None and _misfit(_mended(replay, fault)) < _MENDS * _misfit(replay)
    return fault if mended else None


def _mended(replay: Replay, fault: InterfaceFault) -> Replay:
    """Return the replay with a wrong sign or unit of α, q or θ corrected."""
    factor = -1.0 if "reversed" in fault.observed else 1.0 / _PER_RAD
    changed: dict[str, Any] = {
        name: factor * getattr(replay, name)
        for name in ("alpha", "q", "theta")
        if _NAMES.get(name, name) in fault.quantity
    }
    return replace(replay, **changed)


def _misfit(replay: Replay) -> float:
    """Return the inconsistency of θ with ∫q dt, and of α with the path, as shares of these motions."""
    turned = integrated(replay.t, replay.q)
    pairs = (
        (replay.theta - replay.theta[0], turned),
        (replay.alpha - replay.alpha[0], turned + _path_turning(replay)),
    )
    return sum(rms(a - b) / max(rms(a) + rms(b), 1e-300) for a, b in pairs)


def _of_the_angles(replay: Replay, turned: FloatArray) -> InterfaceFault | None:
    """Return the first fault of θ, q and α; ``turned`` is ∫q dt."""
    pitch, by_q, by_force = _slopes(replay, turned)
    if _is(by_force, _PER_RAD) and _is(by_q, 1.0) and _is(pitch, 1.0):
        return InterfaceFault("α, q and θ", "in degrees", "Give angles in rad and rates in rad/s.")
    if _is(pitch, -1.0):
        culprit = "q" if _is(by_q, -1.0) else "θ"
        return _sign(culprit, "with the sign reversed: positive is nose up")
    if _is(pitch, 1.0 / _PER_RAD):
        return InterfaceFault("q", "in deg/s", "Give the pitch rate in rad/s.")
    if _is(pitch, _PER_RAD):
        return InterfaceFault("θ", "in degrees", "Give the pitch angle in rad.")
    if _is(by_q, _PER_RAD) and _is(by_force, _PER_RAD):
        return InterfaceFault("α", "in degrees", "Give the angle of attack in rad.")
    if _is(by_q, -1.0) and _is(by_force, -1.0):
        return _sign("α", "with the sign reversed: positive is nose up")
    return None


def _slopes(replay: Replay, turned: FloatArray) -> tuple[float, float, float]:
    """Return the slopes of θ on ∫q dt, and of α on ∫q dt and on the path's turning, each 1 in SI units."""
    columns = np.column_stack([turned, _path_turning(replay)])
    by_q, by_force = np.linalg.lstsq(columns, replay.alpha - replay.alpha[0])[0]
    return _slope(turned, replay.theta - replay.theta[0]), float(by_q), float(by_force)


def _agrees(replay: Replay) -> bool:
    """Return whether the outputs of a replay are consistent with each other."""
    return all(_is(slope, 1.0) for slope in _slopes(replay, integrated(replay.t, replay.q)))


def _in_radians(replay: Replay, names: Sequence[str]) -> Replay:
    """Return the replay with some of its series converted from degrees."""
    changed: dict[str, Any] = {name: np.radians(getattr(replay, name)) for name in names}
    return replace(replay, **changed)


_POSITIVE = {
    "elevator": (
        "it pitches up where the aircraft pitches down",
        "trailing edge down is positive and pitches down (on a canard, trailing edge up)",
    ),
    "aileron": ("it rolls to the other side", "a positive aileron rolls to the left"),
    "rudder": ("it yaws to the other side", "a positive rudder yaws to the left"),
}
"""Sentences about a control with a wrong sign: the fault and the convention, by the control."""


_LEAST = {"elevator": 0.1, "aileron": 0.6, "rudder": 0.1}
"""Least response to a control: change of α per elevator, steady roll rate per aileron (1/s), sideslip per
rudder. Recorded aircraft have 0.3 to 3, 3 to 11 and 0.4 to 2; a control read in degrees gives 57 times less.
An aileron response is at most 57 times the least; α and β may exceed that with low stability."""


def control_fault(control: str, turns: float, answer: float) -> InterfaceFault | None:
    """Return the wrong sign or unit of a control; None if the simulator responds like an aircraft.

    Parameters
    ----------
    control
        Name of the control: ``elevator``, ``aileron`` or ``rudder``.
    turns
        Derivative M_δe, L_δa or N_δr, 1/s².
    answer
        Size of the response as in ``_LEAST``.
    """
    if answer < _LEAST[control]:
        size = f"{_LEAST[control] / max(answer, 1e-6):.0f} times less effect than the weakest of an aircraft"
        mend = "It expects degrees: convert the deflection, which is sent in rad, into degrees."
        return InterfaceFault(f"the {control}", size, mend)
    if control == "aileron" and answer > _LEAST[control] * _PER_RAD:
        size = f"{answer / _LEAST[control]:.0f} times the effect of the weakest of an aircraft"
        return InterfaceFault(
            "the aileron",
            size,
            "It treats the deflection as degrees, but it is sent in rad: use it without conversion.",
        )
    if turns <= 0.0:
        return None
    wrong, convention = _POSITIVE[control]
    return InterfaceFault(
        f"the {control}", f"the wrong direction: {wrong}", f"Reverse the {control}'s input; {convention}."
    )


def side_fault(replay: Replay) -> InterfaceFault | None:
    """Return the first wrong sign or unit of p, r, bank and β; None if they are consistent.

    φ̇ = p + tan θ·(q·sin φ + r·cos φ)        β̇ = a_y/V + (g/V)·cos θ·sin φ + sin α·p − cos α·r
    """
    p, r, bank, a_y, beta = (getattr(replay, name) for name in ("p", "r", "bank", "a_y", "beta"))
    if p is None or r is None or bank is None:
        return None
    if np.max(np.abs(bank)) > np.pi:
        return InterfaceFault("the bank angle", "in degrees", "Give angles in rad and rates in rad/s.")
    rolled = integrated(replay.t, p)
    if np.ptp(rolled) > _MOVES_RAD:
        swept = np.tan(replay.theta) * (replay.q * np.sin(bank) + r * np.cos(bank))
        by_p = _slope(rolled, bank - bank[0] - integrated(replay.t, swept))
        if _is(by_p, -1.0):
            return _sign("p", "with the sign reversed: positive is right wing down")
        if _is(by_p, 1.0 / _PER_RAD):
            return InterfaceFault("p", "in deg/s", "Give the roll rate in rad/s.")
    if a_y is None or beta is None:
        return None
    weight = GRAVITY_M_S2 * np.cos(replay.theta) * np.sin(bank)
    pushed = integrated(replay.t, (a_y + weight) / replay.airspeed_m_s + np.sin(replay.alpha) * p)
    turned = integrated(replay.t, -np.cos(replay.alpha) * r)
    if np.ptp(turned) < _MOVES_RAD:
        return None
    by_push, by_turn = np.linalg.lstsq(np.column_stack([pushed, turned]), beta - beta[0])[0]
    if _is(by_turn, -1.0):
        mend = "positive is wind from the right" if _is(by_push, -1.0) else "positive is nose right"
        return _sign("β" if _is(by_push, -1.0) else "r", f"with the sign reversed: {mend}")
    if _is(by_turn, 1.0 / _PER_RAD):
        return InterfaceFault("r", "in deg/s", "Give the yaw rate in rad/s.")
    in_degrees = _is(by_turn, _PER_RAD) and _is(by_push, _PER_RAD)
    return InterfaceFault("β", "in degrees", "Give the sideslip in rad.") if in_degrees else None


def _path_turning(replay: Replay) -> FloatArray:
    """Return ∫(a_z·cos α − a_x·sin α + g·cos γ)/V dt from the start, rad, shape (m,)."""
    path = replay.theta - replay.alpha
    along = replay.a_x if replay.a_x is not None else GRAVITY_M_S2 * np.sin(replay.theta)
    force = replay.a_z * np.cos(replay.alpha) - along * np.sin(replay.alpha)
    rate = (force + GRAVITY_M_S2 * np.cos(path)) / replay.airspeed_m_s
    return integrated(replay.t, rate - rate[0])


def _slope(x: FloatArray, y: FloatArray) -> float:
    return float(x @ y / max(float(x @ x), 1e-300))


def _is(factor: float, unit: float) -> bool:
    return factor * unit > 0.0 and abs(log(factor / unit)) < _NEAR


def _sign(quantity: str, observed: str) -> InterfaceFault:
    mend = f"Reverse {quantity} in the simulator's output (scale: -1), or in its wrapper."
    return InterfaceFault(quantity, observed, mend)
