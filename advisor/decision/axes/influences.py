"""Influences that the model of each axis omits (see ``decision.omitted``).

The equations of a rigid body contain (Izz − Ixx)/Iyy·p·r in pitch, (Iyy − Izz)/Ixx·q·r in roll and
(Ixx − Iyy)/Izz·p·q in yaw. Every body has Izz ≤ Ixx + Iyy, and an aircraft has Ixx and Iyy of at most Izz.
All three factors therefore have a size of at most one (Etkin & Reid, Dynamics of Flight, 1996, ch. 4). The
moments of throttle and of other controls are estimated from the residual. So are the changes of L_r, N_p and
L_β with the angle of attack, and a moment that does not grow with V².
"""

from collections.abc import Collection, Iterator

import numpy as np

from advisor.decision.axes.linear_motion import PITCH, SIDE, LinearMotion
from advisor.decision.omitted import Influence, objections_to
from advisor.decision.verdict import Reason
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.oem.axis.estimate import AxisEstimate
from advisor.oem.estimate import Estimate
from advisor.oem.instruments import COUPLING
from advisor.process.arrays import FloatArray

PITCH_JUDGED = ("M_alpha", "M_q", "M_delta_e", "Z_alpha")
"""Derivatives of pitch whose bias is examined."""
SIDE_JUDGED = ("L_p", "L_delta_a", "N_beta", "N_r", "N_delta_r")
"""Derivatives whose bias is examined: those that a test of aileron or rudder determines."""


def coupled(maneuver: Maneuver, estimate: Estimate, exceeded: Collection[str] = ()) -> list[Reason]:
    """Return a reason for each omitted influence that biases a derivative of pitch beyond its 95 % interval.

    Parameters
    ----------
    exceeded
        Codes of the limits that the manoeuvre exceeds. Air speed, aileron and rudder are examined beyond
        their limits only.
    """
    linear = LinearMotion(PITCH, maneuver, estimate, estimate.fits[0]["q"].t)
    examined = {"coupling", "throttle", *exceeded} - (set() if carries_speed(estimate) else {"airspeed"})
    examined -= {"coupling"} if carries_coupling(estimate) else set()
    influences = [influence for influence in _on_pitch(linear) if influence.code in examined]
    return list(objections_to(influences, linear, estimate, PITCH_JUDGED))


def side_coupled(maneuver: Maneuver, estimate: AxisEstimate, exceeded: Collection[str]) -> list[Reason]:
    """Return a reason for each omitted influence that biases a derivative of roll or yaw beyond its 95 %
    interval.

    Parameters
    ----------
    exceeded
        Codes of the limits that the manoeuvre exceeds. Within all limits no influence is examined.
    """
    if not exceeded:
        return []
    linear = LinearMotion(SIDE, maneuver, estimate, estimate.fits[0]["p"].t)
    left_out = () if estimate.scales_with_speed else ("airspeed",)
    influences = [influence for influence in _on_the_sides(linear) if influence.code not in left_out]
    judged = [name for name in SIDE_JUDGED if SIDE.controls.get(name[2:], "") in ("", *estimate.flown)]
    return list(objections_to(influences, linear, estimate, judged))


def _on_pitch(linear: LinearMotion) -> Iterator[Influence]:
    p, r = linear.measured("p"), linear.measured("r")
    if p is not None and r is not None:
        cure = "let roll and yaw die down before the first step"
        yield Influence("coupling", "rolling and yawing", cure, "q", p * r, True)
    yield from _by_speed(linear, "q")
    cures = {"throttle": "leave the throttle where it is"}
    for control in ("throttle", "aileron", "rudder"):
        moved = linear.measured(control)
        if moved is not None:
            cure = cures.get(control, f"use less {control}")
            yield Influence(control, f"the {control}'s pitching moment", cure, "q", moved)


def _on_the_sides(linear: LinearMotion) -> Iterator[Influence]:
    q, alpha = (_deviation(linear.measured(name)) for name in ("q", "alpha"))
    if q is not None:
        for state, rate in (("p", "r"), ("r", "p")):
            term = q * linear.states[rate]
            yield Influence("coupling", "pitching with rolling", "hold the nose still", state, term, True)
    if alpha is not None:
        for state, factor in (("p", "r"), ("r", "p"), ("p", "beta")):
            term = alpha * linear.states[factor]
            yield Influence("alpha", "the changing angle of attack", "keep the nose where it is", state, term)
    yield from _by_speed(linear, "p", "r")


def _by_speed(linear: LinearMotion, *states: str) -> Iterator[Influence]:
    """Yield the moments that do not grow with V²."""
    speed = linear.measured("airspeed")
    if speed is not None:
        growth = speed / float(np.mean(speed)) - 1.0
        for state in states:
            cure = "smaller steps, from steady speed"
            yield Influence("airspeed", "the changing air speed", cure, state, growth * linear.change(state))


def _deviation(y: FloatArray | None) -> FloatArray | None:
    return None if y is None else np.asarray(y - np.mean(y))


def has_banking(maneuver: Maneuver) -> bool:
    """Return whether a record contains all channels by which a bank changes the motion in pitch."""
    return {"p", "r", "bank", "beta", "theta"} <= maneuver.channels.keys()


def carries_coupling(estimate: Estimate) -> bool:
    """Return whether the model of an estimate contains the moment of rolling with yawing."""
    return estimate.found is not None and COUPLING.name in estimate.found.names


def carries_speed(estimate: Estimate) -> bool:
    """Return whether the derivatives of an estimate grow with the measured air speed."""
    return estimate.airspeed_m_s is not None
