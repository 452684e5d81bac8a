"""Inputs of a simulator from a flown manoeuvre, and the replay as a manoeuvre on the gap's time grid."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.gap.records.flights import PreparedManeuver
from advisor.gap.simulator.layout import (
    A_X,
    ALPHA_TRIM,
    BANK,
    HEIGHT,
    REFERENCE,
    SPEED,
    THETA_FROM,
    THROTTLE,
    THRUST,
    TURN,
)  # fmt: skip
from advisor.gap.simulator.surface import surface
from advisor.oem.rows import Signal
from advisor.process.arrays import FloatArray
from advisor.simulators.protocol import CONTROLS, Condition, Inputs, Replay

_RATE_S = 0.02
"""Interval of the stamps at which a replay is read if nothing was measured, s."""


def condition_of(flight: PreparedManeuver, height_m: float, mass_kg: float | None) -> Condition:
    """Return the steady flight condition at the start of a manoeuvre: mean speed before the first step.

    ``height_m`` is the height in the standard atmosphere with the flight's air density.
    """
    before = max(int(flight.first_step_s / flight.h), 1)
    speed = float(np.mean(flight.slow[SPEED, :before]))
    steep = float(flight.trim[THETA_FROM]) - flight.alpha_trim
    return Condition(speed, height_m, steep, mass_kg)


def surface_of(flight: PreparedManeuver, p: FloatArray, held: bool) -> FloatArray:
    """Return the surface's deviation from trim, rad, shape (n,): the mean over each step.

    ``p``, shape (entries,), holds the effects between the recorded command and the surface.
    """
    stamps = flight.t_held if held else flight.t_u
    return surface(flight.h, flight.n, stamps, flight.u, held, flight.u_trim, p)


def inputs_of(
    flight: PreparedManeuver, others: Mapping[str, FloatArray], p: FloatArray, held: bool
) -> Inputs:
    """Return the recorded inputs, with the effects of ``p`` between command and surface."""
    t: FloatArray = (np.arange(flight.n, dtype=np.float64) + 0.5) * flight.h
    return Inputs(t, surface_of(flight, p, held), others)


def as_flight(flight: PreparedManeuver, replay: Replay, reference_m_s: float) -> PreparedManeuver:
    """Return the manoeuvre as flown by the simulator, with the simulator's own speed and trim.

    Bank and turn rate are the simulator's, zero in the vertical plane, and thrust equals drag. The height
    above the ground changes with the simulator's height.
    """
    middles = (np.arange(flight.n) + 0.5) * flight.h
    slow = np.zeros_like(flight.slow)
    slow[SPEED] = np.interp(middles, replay.t, replay.airspeed_m_s)
    slow[A_X] = np.interp(middles, replay.t, replay.a_x if replay.a_x is not None else _pull_along(replay))
    slow[BANK], slow[TURN], slow[THRUST] = 0.0, 0.0, 0.0
    if replay.bank is not None:
        bank = np.interp(middles, replay.t, replay.bank)
        coordinated = GRAVITY_M_S2 / slow[SPEED] * np.sin(bank)
        yaw_rate = coordinated if replay.r is None else np.interp(middles, replay.t, replay.r)
        slow[BANK], slow[TURN] = bank, yaw_rate * np.sin(bank)
    slow[THROTTLE] = flight.slow[THROTTLE]
    climbed = np.interp(middles, replay.t, replay.height_m - replay.height_m[0])
    slow[HEIGHT] = flight.slow[HEIGHT, 0] + climbed
    trim = flight.trim.copy()
    trim[ALPHA_TRIM], trim[THETA_FROM] = float(replay.alpha[0]), float(replay.theta[0])
    trim[REFERENCE] = reference_m_s
    return replace(flight, slow=slow, trim=trim, edges=np.empty((0, 4)), speed_error_factor=np.empty((0, 0)))


def at_reference(flight: PreparedManeuver, reference_m_s: float) -> PreparedManeuver:
    """Return the manoeuvre with another reference speed of the derivatives."""
    trim = flight.trim.copy()
    trim[REFERENCE] = reference_m_s
    return replace(flight, trim=trim)


def on_grid(replay: Replay, flight: PreparedManeuver) -> FloatArray:
    """Return α, q, a_z and θ of a replay at the ends of the steps, shape (4, n + 1)."""
    t = np.arange(flight.n + 1) * flight.h
    series = (replay.alpha, replay.q, replay.a_z, replay.theta)
    return np.stack([np.interp(t, replay.t, y) for y in series])


def read_from(flight: PreparedManeuver, grid: FloatArray, channels: tuple[str, ...]) -> PreparedManeuver:
    """Return the manoeuvre with a series on the time grid, shape (4, n + 1), as measurements."""
    t = np.arange(flight.n + 1) * flight.h
    stamps = np.arange(0.0, t[-1], _RATE_S)
    names = ("alpha", "q", "a_z", "theta")
    outputs = {
        name: Signal(stamps, np.interp(stamps, t, grid[c]))
        for c, name in enumerate(names)
        if name in channels
    }
    output = np.repeat([names.index(name) for name in channels], len(stamps)).astype(np.int64)
    return replace(flight, outputs=outputs, stamps=np.tile(stamps, len(channels)), output=output)


def _pull_along(replay: Replay) -> FloatArray:
    """Return the specific force along body x, m/s², for motion in the vertical plane, shape (m,)."""
    path = replay.theta - replay.alpha
    along = np.gradient(replay.airspeed_m_s, replay.t) + GRAVITY_M_S2 * np.sin(path)
    return np.asarray((along - replay.a_z * np.sin(replay.alpha)) / np.cos(replay.alpha))


def other_controls(
    flights: Sequence[PreparedManeuver], maneuvers: Sequence[Maneuver]
) -> Mapping[int, Mapping[str, FloatArray]]:
    """Return the logged controls of ``CONTROLS`` by manoeuvre number, each of shape (n,) on its grid.

    Values are deviations from the mean before the elevator's first step.
    """
    by_number = {m.number: m for m in maneuvers}
    return {flight.number: _departures(flight, by_number[flight.number]) for flight in flights}


def _departures(flight: PreparedManeuver, maneuver: Maneuver) -> Mapping[str, FloatArray]:
    middles = (np.arange(flight.n) + 0.5) * flight.h
    before = middles < max(flight.first_step_s, flight.h)
    departures = {}
    for name in CONTROLS:
        channel = maneuver.channels.get(name)
        if channel is not None and len(channel) > 1:
            y = np.interp(middles, channel.t - flight.started_s, channel.y)
            departures[name] = y - float(np.mean(y[before]))
    return departures
