"""An effect that only the simulator has, such as a rate limit, play or a filter.

A fit to the flight cannot remove such an effect from a simulator, because its size would be negative.
Aircraft and simulator therefore exchange their roles. A quick fit to the simulator's own replays finds their
likeliest effect. If the flight is likelier next to the simulator without that effect, the replays are
diagnosed in full. The simulator without its effects is then one more explanation of the flight.

A pitch rate filter is found from the simulator's own attitude, because a replay has no noise. The relation
θ̇ = q·cos φ − r·sin φ holds within the simulation's step. A pitch rate that differs from the attitude's rate
is late. The difference is τ·q̇ for a first-order filter, and nearly so for a delay.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.record import Channel
from advisor.gap.candidates.known import Effects, base_entries, variants_for
from advisor.gap.diagnose import Examined, examine
from advisor.gap.effects.pitch_rate_skew import EFFECT
from advisor.gap.fitting.fit import fit
from advisor.gap.fitting.measure import whole_gap
from advisor.gap.fitting.problem import EffectProblem, SearchPoint
from advisor.gap.inference.evidence import FlightProblem
from advisor.gap.inference.pitch import PitchFlight, PitchModel
from advisor.gap.inference.posterior import stated_as
from advisor.gap.records.prepare import prepare
from advisor.gap.result import Cause, Diagnosis, Value
from advisor.gap.search.baseline import fit_baseline
from advisor.gap.search.screen import Screen
from advisor.gap.simulator.layout import DERIVATIVES
from advisor.gap.verdict.causes import parameters_of
from advisor.gap.verdict.statements import what
from advisor.gap.verdict.text import answers_of
from advisor.process.arrays import FloatArray
from advisor.simulators.as_given import AsGiven, Flying, beyond
from advisor.simulators.improved import with_series
from advisor.simulators.protocol import Replay
from advisor.simulators.surrogate import entries_of
from advisor.simulators.unseen import floor_of, predicted, unknown_offset
from advisor.words.certainty import as_sure
from advisor.words.problems import UnusableInputError


def said_of_the_simulator(whole: Examined, diagnosis: Diagnosis) -> Diagnosis:
    """Return the diagnosis with the words and the gap of a simulator that has an effect too much."""
    without = whole.findings.without
    if without is None:
        return diagnosis
    first, before, after = diagnosis.causes[0], diagnosis.gap.before, _gap_without(whole, without)
    removed = 100.0 * (1.0 - after / before)
    sentence = f"{_said(first)}; without it the gap is {removed:.0f} % less."
    where = replace(diagnosis.where, block=first.block, share=float(np.clip(removed / 100.0, 0.0, 1.0)))
    simulated = diagnosis.in_simulator
    if simulated is not None:
        names = tuple(cause.effect for cause in diagnosis.causes if cause.present)
        simulated = replace(
            simulated, after=simulated.before, percent=0.0, on_paper=simulated.on_paper or names
        )
    return replace(
        diagnosis, sentence=as_sure(sentence, answers_of(diagnosis.evidence)),
        where=where, effects={}, waterfall=((first.effect, after),), shrink=None, in_simulator=simulated,
    )  # fmt: skip


def _gap_without(whole: Examined, problem: EffectProblem) -> float:
    """Return the flight's gap to the simulator without its effects, with no parameter fitted."""
    floor = floor_of(whole)
    assert problem.prior_derivatives is not None
    given = SearchPoint(problem.prior_derivatives, whole.findings.last.fitted.point.own)
    plain, offset = whole.findings.models[0].fitted, unknown_offset(whole.diagnosis, None)
    every = range(len(problem.flights))
    return whole_gap(predicted(problem, given, plain, floor, every, offset).mean_square, floor)


def _said(cause: Cause) -> str:
    """Return the statement about a simulator effect of negative size."""
    if cause.block == "input":
        return what(cause)
    read = what(negative_of(cause))
    return f"In the simulator alone {read[0].lower()}{read[1:]}"


def negative_of(cause: Cause) -> Cause:
    """Return an effect of the simulator as a cause, with the negative of its size, because the aircraft lacks
    the effect.
    """
    first, *rest = cause.parameters.items()
    name, size = first
    return replace(cause, parameters={name: Value(-size.value, size.std), **dict(rest)})


def unfiltered(replay: Replay) -> Replay:
    """Return the replay with a pitch rate computed from its own attitude."""
    rate = np.gradient(replay.theta, replay.t)
    if replay.bank is None:
        return replace(replay, q=rate)
    across, up = np.sin(replay.bank), np.cos(replay.bank)
    if replay.r is not None:
        return replace(replay, q=(rate + replay.r * across) / up)
    turn = GRAVITY_M_S2 / replay.airspeed_m_s * across / up
    return replace(replay, q=rate * up + turn * across)


def lateness(replays: Sequence[Replay]) -> Value:
    """Return the lag of the replays' pitch rate relative to the attitude's rate, s, by least squares."""
    missing, rate = (np.concatenate(series) for series in zip(*map(_departure, replays), strict=True))
    information = max(float(rate @ rate), 1e-300)
    lag_s = float(rate @ missing) / information
    rest = missing - lag_s * rate
    return Value(lag_s, float(np.sqrt(np.mean(rest**2) / information)))


def cause_of(late: Value, own: Diagnosis) -> Cause:
    """Return the filter as a cause, with the size that the aircraft lacks.

    Parameters
    ----------
    late
        Lag of the simulator's pitch rate, s.
    own
        Diagnosis of the replays without the lag. The probability of the cause is that of the answer "nothing"
        for these replays.
    """
    probabilities = own.probabilities
    likeliness = 0.0 if probabilities is None else probabilities.none + probabilities.parameters
    assert EFFECT.imitated_by is not None
    looks, way = EFFECT.imitated_by
    size = {"skew_s": Value(-late.value, late.std)}
    return Cause(EFFECT.name, EFFECT.block, likeliness, size, (looks,), way, float("nan"), present=True)


def _departure(replay: Replay) -> tuple[FloatArray, FloatArray]:
    """Return attitude rate minus pitch rate, rad/s, and pitch acceleration, rad/s², shape (m,) each."""
    return unfiltered(replay).q - replay.q, np.gradient(replay.q, replay.t)


_BLOCKS = frozenset({"input", "alpha_sensor", "pitch_rate_sensor", "accelerometer", "timing"})
"""Blocks outside the physics: the actuator and the instruments."""
_ROUNDS = 8
"""Numerical: number of Gauss-Newton steps next to another simulator."""
_Sizes = tuple[Mapping[str, float], Effects]
"""Derivatives of a simulator, and the effects that it has."""
_MOTION = ("alpha", "q", "theta", "a_z")


@dataclass(frozen=True)
class Mirror:
    """A simulator with its replays of the flight, searched for effects that the aircraft lacks."""

    maneuvers: Sequence[Maneuver]
    flying: Flying
    replays: Sequence[Replay]
    """Replays of the simulator without added effects; empty where the simulator is linear."""
    aircraft: Aircraft
    as_flown: Mapping[int, AsGiven]
    """Difference of simulator and surrogate that the diagnosis removed, by manoeuvre number."""

    def __call__(self, flight: PitchFlight, plain: PitchModel, heat: float) -> PitchModel | None:
        """Return the simulator without effects that the aircraft lacks; None without such effects.

        ``plain`` is the flight's model next to the simulator as given, ``heat`` its temperature.
        """

        def beside(replays: Sequence[Replay], sizes: _Sizes) -> PitchModel:
            problem = self._beside(flight.problem, replays, *sizes)
            point = replace(plain.fitted.point, derivatives=problem.mean)
            made = fit(problem, point, plain.fitted.noise, _ROUNDS)
            return flight.model_of(problem, None, made, plain.fitted, heat)

        replays = self.replays
        if not replays:
            return None
        try:
            looks = _quick_look(self._as_flights(replays), self._unknown)
            if looks is None or beside(replays, looks).evidence.either < plain.evidence.either:
                return None
            own = examine(self._as_flights(replays), self._unknown).diagnosis
            late = None
            if own.verdict == "unknown" and own.where.block == "pitch_rate_sensor":
                late, replays = lateness(replays), [unfiltered(replay) for replay in replays]
                own = examine(self._as_flights(replays), self._unknown).diagnosis
        except UnusableInputError:
            return None
        causes = tuple(c for c in own.causes if c.present and c.block in _BLOCKS)
        if not causes and late is None:
            return None
        effects = {c.effect: own.effects[c.effect] for c in causes if c.effect in own.effects}
        model = {name: own.model[name].value for name in DERIVATIVES}
        filtered = [] if late is None else [cause_of(late, own)]
        first, *rest = [*filtered, *map(negative_of, causes)]
        return replace(
            beside(replays, (model, effects)),
            alternative=stated_as(first.effect), taken_out=(first, *rest), chance=first.probability,
        )  # fmt: skip

    @property
    def _unknown(self) -> Aircraft:
        """Aircraft of which neither model nor servo is stated."""
        unknown = replace(self.aircraft, model={}, effects={}, simulator=None)
        return replace(unknown, elevator=replace(self.aircraft.elevator, lag_s=None, delay_s=None))

    def _beside(
        self,
        problem: FlightProblem,
        replays: Sequence[Replay],
        model: Mapping[str, float],
        effects: Effects,
    ) -> FlightProblem:
        """Return the flight next to the simulator without its effects."""
        reference = self.flying.flights.reference_m_s
        as_file = replace(self._unknown, model=dict(model), reference_airspeed_m_s=reference)
        flights = self.flying.flights
        # The simulator hands its instruments' effects out already; the surrogate gets them here.
        grids = beyond(self.flying, replays, entries_of(flights, as_file, effects), as_read=True)
        by_number = dict(zip((f.number for f in flights.flights), grids, strict=True))
        differs = [by_number[f.number] - self.as_flown[f.number].beyond for f in problem.flights.flights]
        derivatives = np.array([model[name] for name in DERIVATIVES])
        changed = replace(problem, base=base_entries(as_file), changes=(), prior_derivatives=derivatives)
        return replace(changed, flights=with_series(changed, differs, -1.0).flights)

    def _as_flights(self, replays: Sequence[Replay]) -> list[Maneuver]:
        """Return the simulator's replays as manoeuvres, with the noise of the flight's instruments."""
        by_number = {m.number: m for m in self.maneuvers}
        flights = self.flying.flights
        white = dict(zip(flights.channels, flights.white, strict=True))
        as_flights = []
        for flight, replay in zip(flights.flights, replays, strict=True):
            maneuver = by_number[flight.number]
            rng = np.random.default_rng(flight.number)
            channels = {"elevator": maneuver.channels["elevator"]}
            for name in (*_MOTION, "airspeed"):
                logged = maneuver.channels.get(name)
                if logged is None:
                    continue
                y = replay.airspeed_m_s if name == "airspeed" else getattr(replay, name)
                read = np.interp(logged.t - flight.started_s, replay.t, y)
                noise = white.get(name, 0.0) * rng.standard_normal(len(read))
                # A simulator's own angle of attack is exact: its lateness is no habit of an autopilot.
                channels[name] = Channel(name, logged.t, read + noise, "simulator", "vane")
            as_flights.append(replace(maneuver, channels=channels))
        return as_flights


def _quick_look(as_flights: Sequence[Maneuver], unknown: Aircraft) -> _Sizes | None:
    """Return the replays' derivatives and likeliest actuator or instrument effect, or None."""
    problem, plain = fit_baseline(prepare(as_flights, unknown), unknown)
    around = [variant for variant in variants_for(problem.flights) if variant.block in _BLOCKS]
    likeliest = Screen(problem, plain).likeliest(around)
    if likeliest is None:
        return None
    values = likeliest.point.values[-1]
    sizes = parameters_of(likeliest.variant, values, np.zeros(len(values)))
    model = dict(zip(DERIVATIVES, map(float, likeliest.point.derivatives), strict=True))
    return model, {likeliest.name: {name: size.value for name, size in sizes.items()}}
