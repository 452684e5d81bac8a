"""Flights with known instruments, and changes of their channels."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.flight.instruments.axes.side_instruments import examine_side
from advisor.flight.instruments.examination import examine
from advisor.flight.instruments.measured import pooled
from advisor.flight.signals.record import Channel
from advisor.flight.signals.trust import InstrumentFinding
from advisor.oem.rows import Signal
from tests.oem.axis.builders import JET, flown, rudder_doublet, steps

T = np.arange(0.0, 8.0, 0.02)
SPEED = 20.0
Channels = dict[str, Channel]


def flight(source: str = "AOA_SSA.AOA", provenance: str = "derived") -> Channels:
    """Return an exact flight: an oscillating angle of attack, and the path that its lift bends."""
    alpha = 0.05 + 0.06 * np.sin(5.0 * T) * np.exp(-0.4 * T) + 0.02 * np.sin(2.0 * T)
    bending = 4.0 * (alpha - np.mean(alpha))
    path = np.concatenate(([0.0], np.cumsum(np.diff(T) * (bending[1:] + bending[:-1]) / 2.0)))
    theta = alpha + path
    a_x = GRAVITY_M_S2 * np.sin(theta)
    a_z = (a_x * np.sin(alpha) - SPEED * bending - GRAVITY_M_S2 * np.cos(path)) / np.cos(alpha)
    values = {
        "theta": theta,
        "q": np.gradient(theta, T),
        "a_x": a_x,
        "a_z": a_z,
        "airspeed": np.full(len(T), SPEED),
        "climb_rate": SPEED * np.sin(path),
        "alpha": alpha,
    }
    sources = {"alpha": (source, provenance), "a_x": ("RAW_IMU.xacc", ""), "a_z": ("RAW_IMU.zacc", "")}
    return {name: Channel(name, T, y, *sources.get(name, ())) for name, y in values.items()}


def times(factor: float, *names: str) -> Callable[[Channels], Channels]:
    return lambda channels: channels | {n: replace(channels[n], y=factor * channels[n].y) for n in names}


def late(by_s: float, *names: str) -> Callable[[Channels], Channels]:
    return lambda channels: channels | {n: replace(channels[n], t=channels[n].t + by_s) for n in names}


SMALL = JET | {"Y_beta": -0.5}
SOURCE = {"a_y": "RAW_IMU.yacc", "beta": "AOA_SSA.SSA"}


@cache
def doublets(vane=True):
    """Return the channels of an aileron doublet to 30 deg of bank, and of a rudder doublet."""
    measured = ("p", "r", "bank", "a_y", "beta") if vane else ("p", "r", "bank", "a_y")
    t, rng = np.arange(0.0, 15.0, 0.025), np.random.default_rng(2)
    hands, feet = steps(t, (1.0, 3.0, 5.0), (0.1, -0.1, 0.0)), rudder_doublet(t)
    inputs = {"aileron": hands}, {"rudder": feet}
    records = [flown(SMALL, **one, airspeed=25.0, measured=measured, rng=rng) for one in inputs]
    return tuple(map(channels_of, records))


def channels_of(record):
    known = record.given
    t = record.outputs["p"].t
    told = dict(record.outputs) | {n: Signal(t, s.at(t)) for n, s in known.items()}
    return {
        name: Channel(name, s.t, s.y, SOURCE.get(name, f"ATTITUDE.{name}"), "measured")
        for name, s in told.items()
    }


def found_in_pitch(change: Callable[[Channels], Channels], **of_flight: str) -> dict[str, InstrumentFinding]:
    """Return the contradictions in the pitching flight after a change of its channels, by code."""
    return {f.code: f for f in examine(change(flight(**of_flight))).findings}


def found_in_roll_and_yaw(
    change: Callable[[Channels], Channels], vane: bool = True
) -> dict[str, InstrumentFinding]:
    """Return the contradictions in both doublets together after a change of their channels, by code."""
    evidence = {}
    for channels in doublets(vane):
        examined = examine_side(change(channels), evidence)
        evidence = pooled((evidence, examined.evidence))
    return {f.code: f for f in examined.findings}
