"""Lateral flights for tests: an independent coding of the equations, integrated by SciPy."""

from collections.abc import Mapping, Sequence
from math import cos, sin, tan
from types import MappingProxyType
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.model.axes.lateral import LATERAL
from advisor.oem.axis.parameter import Parameter
from advisor.oem.axis.problem import AxisProblem, AxisRecord
from advisor.oem.extra import Prior
from advisor.oem.rows import Signal
from advisor.process.arrays import FloatArray

Number = TypeVar("Number", float, NDArray[np.float64])

JET = {
    "Y_beta": -0.2, "Y_p": 0.01, "Y_r": 0.01, "Y_delta_a": 0.0, "Y_delta_r": 0.04,
    "L_beta": -3.5, "L_p": -2.1, "L_r": 0.7, "L_delta_a": -6.3, "L_delta_r": 1.2,
    "N_beta": 2.9, "N_p": -0.14, "N_r": -0.12, "N_delta_a": -0.3, "N_delta_r": -1.6,
}  # fmt: skip
"""Derivatives of a jet at 130 m/s."""
TRIM = {"Y_0": 0.002, "L_0": 0.01, "N_0": -0.02}
NOISE = {"p": 0.003, "r": 0.001, "bank": 0.002, "a_y": 0.03, "beta": 0.002}
"""Standard deviations of the noise, SI."""


def steps(t: FloatArray, edges: tuple[float, ...], levels: tuple[float, ...]) -> Signal:
    """Return an input with steps, each over 0.1 s."""
    at: list[float] = [float(t[0])]
    y = [0.0]
    for edge, level in zip(edges, levels, strict=True):
        at += [edge, edge + 0.1]
        y += [y[-1], level]
    return Signal(t, np.interp(t, at, y))


def aileron_doublet(t: FloatArray) -> Signal:
    """Return a doublet of 4 degrees, 1 s a step, from 1 s on."""
    return steps(t, (1.0, 2.0, 3.0), (0.07, -0.07, 0.0))


def rudder_doublet(t: FloatArray) -> Signal:
    """Return a doublet of 4 degrees, 1.5 s a step, from 1 s on."""
    return steps(t, (1.0, 2.5, 4.0), (0.07, -0.07, 0.0))


def flown(
    theta: dict[str, float],
    *,
    aileron: Signal | None = None,
    rudder: Signal | None = None,
    seconds: float = 15.0,
    rate_hz: float = 40.0,
    airspeed: float = 130.0,
    measured: tuple[str, ...] = ("p", "r", "bank", "a_y", "beta"),
    rng: np.random.Generator | None = None,
    initial: tuple[float, ...] = (0.002, 0.01, 0.0, 0.05),
    cubes: Mapping[str, float] = MappingProxyType({}),
) -> AxisRecord:
    """Return a record of the aircraft at constant speed, angle of attack 4 deg and pitch 6 deg.

    ``cubes`` holds the coefficient of β³ in each equation.
    """
    t = np.arange(0.0, seconds, 1.0 / rate_hz)
    alpha, pitch, q = 0.07, 0.105, 0.01
    d = theta | TRIM
    inputs = {n: s for n, s in (("aileron", aileron), ("rudder", rudder)) if s is not None}

    def at(name: str, now: Number) -> Number:
        return np.interp(now, inputs[name].t, inputs[name].y) if name in inputs else 0.0 * now

    def force(x: Sequence[Number], a: Number, rud: Number) -> Number:
        beta, p, r = x
        return (
            d["Y_beta"] * beta + d["Y_p"] * p + d["Y_r"] * r + d["Y_delta_a"] * a + d["Y_delta_r"] * rud
            + d["Y_0"] + cubes.get("Y", 0.0) * beta**3
        )  # fmt: skip

    def rates(now: float, x: FloatArray) -> list[float]:
        beta, p, r, bank = x.tolist()
        a, rud = float(at("aileron", now)), float(at("rudder", now))
        moments = [
            d[f"{m}_beta"] * beta + d[f"{m}_p"] * p + d[f"{m}_r"] * r + d[f"{m}_delta_a"] * a
            + d[f"{m}_delta_r"] * rud + d[f"{m}_0"] + cubes.get(m, 0.0) * beta**3
            for m in "LN"
        ]  # fmt: skip
        side = force((beta, p, r), a, rud) + sin(alpha) * p - cos(alpha) * r
        side += GRAVITY_M_S2 / airspeed * cos(pitch) * sin(bank)
        turn = p + tan(pitch) * (q * sin(bank) + r * cos(bank))
        return [side, *moments, turn]

    x = solve_ivp(
        rates, (0.0, t[-1]), initial, t_eval=t, rtol=1e-10, atol=1e-12, method="DOP853", max_step=0.25
    ).y
    clean = {
        "p": x[1],
        "r": x[2],
        "bank": x[3],
        "a_y": airspeed * force(x[:3], at("aileron", t), at("rudder", t)),
        "beta": x[0],
    }
    noise = {n: 0.0 if rng is None else rng.normal(0.0, NOISE[n], len(t)) for n in measured}
    level = {"airspeed": airspeed, "alpha": alpha, "theta": pitch, "q": q}
    known = {n: Signal(t[[0, -1]], np.full(2, v)) for n, v in level.items()}
    return AxisRecord(inputs, {n: Signal(t, clean[n] + noise[n]) for n in measured}, known)


def both_inputs(
    theta: dict[str, float],
    rng: np.random.Generator | None = None,
    measured: tuple[str, ...] = ("p", "r", "bank", "a_y", "beta"),
) -> AxisProblem:
    """Return an aileron doublet and a rudder doublet of one aircraft."""
    t = np.arange(0.0, 15.0, 0.025)
    return AxisProblem(
        LATERAL,
        (
            flown(theta, aileron=aileron_doublet(t), measured=measured, rng=rng),
            flown(theta, rudder=rudder_doublet(t), measured=measured, rng=rng),
        ),
    )


def number(of: str, entry: str, prior: Prior, each_s: float = 1.0) -> Parameter:
    """Return one number of servos, clocks or sensors, which moves by at most 0.03 s, or by as much as moves
    the outputs like it."""
    bounds = (0.0, 0.4) if entry == "lag_s" else (-np.inf, np.inf)
    return Parameter((of, entry), prior, 0.03 * each_s, bounds)


def vector(theta: dict[str, float]) -> FloatArray:
    """Return derivatives in the order of the axis."""
    return np.array([theta[name] for name in LATERAL.names.reported])
