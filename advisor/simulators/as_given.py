"""The simulator as given: it flies the recorded inputs next to its linear surrogate."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.record import Channel
from advisor.gap.candidates.known import base_entries, variants_for, with_known
from advisor.gap.effects import EFFECTS
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.records.flights import PreparedManeuver, PreparedManeuvers
from advisor.gap.records.usable import DEPARTED_RAD
from advisor.gap.result import Trace, TrimDifference
from advisor.gap.simulator.layout import BANK, DERIVATIVES, HEIGHT, INDEX, OUTPUTS
from advisor.oem.rows import Signal
from advisor.process.arrays import FloatArray
from advisor.simulators.air import refuse_unknown_air, standard_heights, winds
from advisor.simulators.by_log import IdentifiedSimulator
from advisor.simulators.increments import (
    COMMAND,
    EQUATIONS,
    SimulatorIncrements,
    carried,
    instruments,
    skewed,
)
from advisor.simulators.inputs import as_flight, condition_of, inputs_of, on_grid, other_controls, surface_of
from advisor.simulators.interface import control_fault, interface_fault
from advisor.simulators.linear import LinearSimulator
from advisor.simulators.protocol import Condition, Increments, Inputs, Progress, Replay, Simulator
from advisor.simulators.static_errors import trim_differences
from advisor.simulators.surrogate import Surrogate, entries_of, surrogate_of, trimmed_at
from advisor.words.problems import UnusableInputError

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


@dataclass(frozen=True)
class GivenSimulator:
    """A simulator that has flown the recorded inputs, with its linear surrogate."""

    flying: Flying
    surrogate: Surrogate
    as_flown: Mapping[int, AsGiven]
    """Difference of simulator and surrogate, by manoeuvre number."""
    as_file: Aircraft
    """Aircraft file with the surrogate as its model."""
    replays: Sequence[Replay] = ()
    """Replays of the simulator; empty where the simulator is linear."""
    trims: tuple[TrimDifference, ...] = ()

    def as_logged(self, traces: Sequence[Trace]) -> tuple[Trace, ...]:
        """Return the traces of the logged flight, with those of the simulator in place of its surrogate."""
        logged = []
        for trace in traces:
            as_given = self.as_flown[trace.number]
            t = np.arange(as_given.beyond.shape[1]) * as_given.flight.h
            by = np.interp(trace.t, t, as_given.beyond[OUTPUTS.index(trace.channel)])
            logged.append(
                replace(trace, measured=trace.measured + by, before=trace.before + by, after=trace.after + by)
            )
        return tuple(logged)


def given_of(
    simulator: Simulator,
    flights: PreparedManeuvers,
    maneuvers: Sequence[Maneuver],
    aircraft: Aircraft,
    progress: Progress,
) -> GivenSimulator:
    """Fly the recorded inputs with a simulator, and separate the simulator from its linear surrogate.

    Raises
    ------
    UnusableInputError
        The air of the flight is unknown, or the simulator does not fly.
    """
    heights = standard_heights(maneuvers, aircraft)
    if not isinstance(simulator, LinearSimulator):
        refuse_unknown_air(simulator.description, heights)
    heights_m = {number: height or 0.0 for number, height in heights.items()}
    controls, mass_kg = other_controls(flights.flights, maneuvers), aircraft.reference.mass_kg
    flying = Flying(simulator, flights, heights_m, controls, mass_kg, progress, winds(maneuvers))
    if isinstance(simulator, LinearSimulator):
        surrogate = Surrogate(simulator.derivatives, simulator.reference_m_s or flights.reference_m_s)
        basis = simulator.as_file if isinstance(simulator, IdentifiedSimulator) else aircraft
        return GivenSimulator(flying, surrogate, _linear(flying), replace(basis, simulator=None))
    surrogate, as_flown, replays = _surrogate_and_rest(flying, aircraft)
    as_file = replace(surrogate.aircraft(aircraft), simulator=simulator.description)
    trims = trim_differences(flights, maneuvers, replays, aircraft)
    return GivenSimulator(flying, surrogate, as_flown, as_file, replays, trims)


def _linear(flying: Flying) -> dict[int, AsGiven]:
    """Return the start of every manoeuvre for a linear simulator, which equals its surrogate."""
    rests = ((f, Inputs(np.array([0.5, 1.5]) * f.h, np.zeros(2))) for f in flying.flights.flights)
    begun = [flying.simulator.replay(flying.condition(f), rest) for f, rest in rests]
    return {f.number: AsGiven(f, np.zeros((len(OUTPUTS), f.n + 1))) for f in flying.as_flown(begun)}


def _surrogate_and_rest(
    flying: Flying, aircraft: Aircraft
) -> tuple[Surrogate, dict[int, AsGiven], list[Replay]]:
    """Return the surrogate, every manoeuvre as the simulator flew it, and the replays."""
    flights = flying.flights
    values = with_known(base_entries(aircraft), aircraft.effects, flights, variants_for(flights))
    command = np.zeros_like(values)
    entries = [INDEX[name] for name in COMMAND]
    command[:, entries] = values[:, entries]
    replays = flying.replays(command, held=False)
    refuse_unmoved(flying.simulator.description, replays, flights)
    flown = flying.as_flown(replays)
    surrogate = surrogate_of(flights, flown, replays, command, flying.simulator.linearise(_usual(flying)))
    refuse_wrong_elevator(flying.simulator.description, surrogate.derivatives["M_delta_e"], replays, flights)
    p = entries_of(flights, surrogate.aircraft(aircraft), aircraft.effects)
    if any(EFFECTS[effect].block in EQUATIONS for effect in aircraft.effects):
        as_given = np.array([surrogate.derivatives[name] for name in DERIVATIVES])
        replays = flying.replays(command, False, added(flown, p, as_given))
    grids = beyond(flying, replays, p)
    return surrogate, {f.number: AsGiven(f, grid) for f, grid in zip(flown, grids, strict=True)}, replays


def _usual(flying: Flying) -> Condition:
    """Return the median flight condition at the starts of the manoeuvres."""
    height = float(np.mean([flying.condition(f).height_m for f in flying.flights.flights]))
    return Condition(flying.flights.reference_m_s, height, 0.0, flying.mass_kg)
