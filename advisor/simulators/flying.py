"""Flights of a simulator with the recorded inputs, and its difference from the linear surrogate."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.record import Channel
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.records.flights import PreparedManeuver, PreparedManeuvers
from advisor.gap.records.usable import DEPARTED_RAD
from advisor.gap.simulator.layout import BANK, HEIGHT, INDEX, OUTPUTS
from advisor.oem.rows import Signal
from advisor.process.arrays import FloatArray
from advisor.simulators.around import instruments, skewed
from advisor.simulators.increments import SimulatorIncrements, carried
from advisor.simulators.inputs import as_flight, condition_of, inputs_of, on_grid, surface_of
from advisor.simulators.interface import control_fault, interface_fault
from advisor.simulators.protocol import Condition, Increments, Inputs, Replay, Simulator
from advisor.simulators.surrogate import Surrogate, trimmed_at
from advisor.words.problems import UnusableInputError

Progress = Callable[[str, float], None]
_LATERAL = ("aileron", "rudder")
_BANKS_AWAY_RAD = 0.17
"""Largest difference between the bank angles of simulator and aircraft, rad. At 10 deg the vertical part of
the lift differs by 1.5 %."""


@dataclass(frozen=True)
class Flying:
    """A simulator with the manoeuvres that it flies."""

    simulator: Simulator
    flights: PreparedManeuvers
    heights_m: Mapping[int, float]
    """Height in the standard atmosphere with the air's density, m, by manoeuvre number."""
    controls: Mapping[int, Mapping[str, FloatArray]]
    """Logged controls (``advisor.simulators.inputs.other_controls``), by manoeuvre number."""
    mass_kg: float | None
    progress: Progress
    winds: Mapping[int, tuple[float, float]] = field(default_factory=dict)
    """Wind (``Condition.wind_m_s``) by manoeuvre number. Manoeuvres without an entry are flown in still
    air."""

    def condition(self, flight: PreparedManeuver) -> Condition:
        """Return the steady flight condition at the start of a manoeuvre."""
        steady = condition_of(flight, self.heights_m[flight.number], self.mass_kg)
        return replace(steady, wind_m_s=self.winds.get(flight.number, steady.wind_m_s))

    def replays(
        self, command: FloatArray, held: bool, increments: tuple[Increments | None, ...] | None = None
    ) -> list[Replay]:
        """Return the simulator's replay of every manoeuvre.

        Parameters
        ----------
        command
            Shape (manoeuvres, entries): effects between the recorded command and the simulator's input.
        held
            Whether the command was held between its stamps.
        increments
            Increments of the simulator in each manoeuvre; None for no increments.

        Raises
        ------
        UnusableInputError
            The simulator does not load or trim, takes too long, or returns numbers that are not finite.
        """
        replays = []
        many = self.flights.flights
        for i, flight in enumerate(many):
            self.progress(f"{self.simulator.description} flies manoeuvre {flight.number}", i / len(many))
            inputs = inputs_of(flight, self.controls[flight.number], command[i], held)
            increment = None if increments is None else increments[i]
            replay = self._flown(flight, inputs, increment)
            if _rolls_away(replay, flight):
                # The pilot's corrections of gusts that the simulator does not have.
                level = {name: y for name, y in inputs.others.items() if name not in _LATERAL}
                replay = self._flown(flight, replace(inputs, others=level), increment)
            replays.append(replay)
        return replays

    def _flown(self, flight: PreparedManeuver, inputs: Inputs, increments: Increments | None) -> Replay:
        replay = self.simulator.replay(self.condition(flight), inputs, increments)
        _refuse_broken(replay, self.simulator.description, flight)
        return replay

    def as_flown(self, replays: Sequence[Replay]) -> list[PreparedManeuver]:
        """Return the manoeuvres with the simulator's own speed and trim."""
        pairs = zip(self.flights.flights, replays, strict=True)
        return [as_flight(flight, replay, self.flights.reference_m_s) for flight, replay in pairs]


@dataclass(frozen=True)
class AsGiven:
    """One manoeuvre flown by the simulator without added effects."""

    flight: PreparedManeuver
    """Prepared manoeuvre with the simulator's own speed and trim."""
    beyond: FloatArray
    """Shape (4, n + 1): simulator outputs minus surrogate outputs."""


def beyond(
    flying: Flying, replays: Sequence[Replay], p: FloatArray, held: bool = False, as_read: bool = False
) -> list[FloatArray]:
    """Return the simulator outputs minus those of a surrogate with equal effects, by manoeuvre.

    Parameters
    ----------
    replays
        Motion of the simulator in every manoeuvre.
    p
        Shape (manoeuvres, entries): inputs of the surrogate, including effects around and in the simulator.
    held
        Whether the command was held between its stamps.
    as_read
        Whether the replays contain the effects of the instruments already.

    Returns
    -------
    A manoeuvre's α, q, a_z and θ on its grid, each of shape (4, n + 1).
    """
    problem = EffectProblem(flying.flights, p, held)
    differences = []
    for there, replay, numbers in zip(flying.as_flown(replays), replays, p, strict=True):
        linear = problem.fly(there, trimmed_at(numbers, there))
        if as_read:
            differences.append(on_grid(replay, there) - skewed(linear, there.h, numbers))
            continue
        ends = np.arange(there.n + 1) * there.h
        speed = np.interp(ends, replay.t, replay.airspeed_m_s)
        surface = surface_of(there, numbers, held)
        read = instruments(on_grid(replay, there), speed, surface, there.h, numbers)
        differences.append(skewed(read - linear, there.h, numbers))
    return differences


def added(
    flown: Sequence[PreparedManeuver], changed: FloatArray, as_given: FloatArray
) -> tuple[Increments, ...]:
    """Return the increments by which effects change the simulator, for every manoeuvre.

    Parameters
    ----------
    flown
        Manoeuvres as the simulator flew them without the effects.
    changed
        Shape (manoeuvres, entries): inputs of the surrogate with the effects.
    as_given
        Shape (6,): derivatives of the surrogate without the effects.
    """
    plain = np.zeros(changed.shape[1])
    plain[: len(as_given)] = as_given
    increments = []
    for there, with_effects in zip(flown, changed, strict=True):
        numbers = np.stack([carried(trimmed_at(p, there)) for p in (with_effects, plain)])
        height_m = float(there.slow[HEIGHT, 0])
        increments.append(SimulatorIncrements(numbers, there.alpha_trim, there.reference_m_s, height_m))
    return tuple(increments)


def without_servo(p: FloatArray, surrogate: Surrogate) -> FloatArray:
    """Return the simulator inputs, shape (manoeuvres, entries), without the simulator's own lag and delay."""
    out = p.copy()
    for name, own in (("lag_s", surrogate.lag_s), ("delay_s", surrogate.delay_s)):
        out[:, INDEX[name]] = np.maximum(out[:, INDEX[name]] - own, 0.0)
    return out


def _rolls_away(replay: Replay, flight: PreparedManeuver) -> bool:
    """Return whether a simulator with the logged aileron and rudder banks much more than the aircraft."""
    if replay.bank is None:
        return False
    middles = (np.arange(flight.n) + 0.5) * flight.h
    apart = np.interp(middles, replay.t, replay.bank) - flight.slow[BANK]
    return bool(np.max(np.abs(apart)) > _BANKS_AWAY_RAD)


def _refuse_broken(replay: Replay, description: str, flight: PreparedManeuver) -> None:
    """Refuse a replay with missing numbers, an early end, a wrong sign or unit, or a departure."""
    series = (
        replay.t,
        replay.alpha,
        replay.q,
        replay.theta,
        replay.a_z,
        replay.airspeed_m_s,
        replay.height_m,
    )
    whole = len(replay.t) > 1 and all(len(y) == len(replay.t) and np.all(np.isfinite(y)) for y in series)
    if not whole or replay.t[-1] < flight.duration_s - 0.1 or np.min(replay.airspeed_m_s) <= 0.0:
        raise UnusableInputError(
            "simulator_replay",
            f"{description} does not fly manoeuvre {flight.number} to its end: numbers are missing.",
            "Check that the model flies at the speed and height of the flight.",
        )
    fault = interface_fault(replay)
    if fault is not None:
        raise fault.refuse(description)
    if np.ptp(replay.alpha) >= DEPARTED_RAD:
        raise UnusableInputError(
            "simulator_departs",
            f"{description} departs in manoeuvre {flight.number}: its angle of attack swings by "
            f"{np.degrees(np.ptp(replay.alpha)):.0f} deg.",
            "Check the sign and the calibration of the elevator, and that the model is stable at this speed.",
        )


def refuse_wrong_elevator(
    description: str, m_delta_e: float, replays: Sequence[Replay], flights: PreparedManeuvers
) -> None:
    """Refuse a simulator whose elevator has a wrong sign or unit.

    ``m_delta_e`` is the simulator's M_δe, 1/s².

    Raises
    ------
    UnusableInputError
        The simulator pitches up on positive elevator, or responds 57 times less than an aircraft.
    """
    pairs = zip(replays, flights.flights, strict=True)
    answer = max(float(np.ptp(replay.alpha) / np.ptp(flight.u)) for replay, flight in pairs)
    fault = control_fault("elevator", m_delta_e, answer)
    if fault is not None:
        raise fault.refuse(description)


def refuse_unmoved(description: str, replays: Sequence[Replay], flights: PreparedManeuvers) -> None:
    """Refuse a simulator whose pitch rate changes by less than the gyro noise of the flight.

    Raises
    ------
    UnusableInputError
        The pitch rate changes by less than the noise in every manoeuvre.
    """
    noise = float(flights.white[flights.channels.index("q")])
    if max(float(np.ptp(replay.q)) for replay in replays) < noise:
        raise UnusableInputError(
            "simulator_elevator",
            f"{description} does not respond to the elevator: its pitch rate does not change.",
            "Check which input of the model the elevator is, and its unit.",
        )


def without_difference(m: Maneuver, as_flown: Mapping[int, AsGiven]) -> Maneuver:
    """Return the manoeuvre without the simulator's difference to its surrogate."""
    if m.number not in as_flown:
        return m
    flight, grid = as_flown[m.number].flight, as_flown[m.number].beyond
    t: FloatArray = flight.started_s + np.arange(grid.shape[1], dtype=np.float64) * flight.h
    return without(m, {name: Signal(t, grid[c]) for c, name in enumerate(OUTPUTS)})


def without(m: Maneuver, lost: Mapping[str, Signal]) -> Maneuver:
    """Return the manoeuvre with a signal subtracted from each channel of that name."""
    changed = {name: _less(m.channels[name], *by) for name, by in lost.items() if name in m.channels}
    return replace(m, channels={**m.channels, **changed})


def _less(channel: Channel, t: FloatArray, by: FloatArray) -> Channel:
    """Return a channel minus a series; repeated samples remain repeated."""
    y = channel.y - np.interp(channel.t, t, by)
    fresh = np.concatenate([[True], np.diff(channel.y) != 0.0])
    return replace(channel, y=y[np.maximum.accumulate(np.where(fresh, np.arange(len(y)), 0))])
