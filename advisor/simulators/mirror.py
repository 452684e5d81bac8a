"""An effect that only the simulator has, such as a rate limit, play or a filter.

A fit to the flight cannot remove such an effect from a simulator, because its size would be negative.
Aircraft and simulator therefore exchange their roles. A quick fit to the simulator's own replays finds their
likeliest effect, which is added to the surrogate. If the aircraft flies like that surrogate without the
effect, the replays are diagnosed in full.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.record import Channel
from advisor.gap.alternative import Alternative, AlternativeEvidence, Contribution, together
from advisor.gap.candidates.catalogue import variants_for
from advisor.gap.candidates.known import with_known
from advisor.gap.decision import Decision
from advisor.gap.diagnose import Examined, examine
from advisor.gap.fitting.measure import whole_gap
from advisor.gap.fitting.problem import EffectProblem, SearchPoint
from advisor.gap.records.prepare import prepare
from advisor.gap.result import VISIBLE, Cause, Diagnosis, GapVerdict, Value
from advisor.gap.search.baseline import base_entries, fit_baseline
from advisor.gap.search.screen import Screen
from advisor.gap.simulator.layout import DERIVATIVES, NUISANCES
from advisor.gap.verdict.causes import parameters_of
from advisor.gap.verdict.statements import what
from advisor.gap.verdict.text import answers_of
from advisor.simulators.around import skewed
from advisor.simulators.flying import AsGiven, Flying
from advisor.simulators.improved import with_series
from advisor.simulators.inputs import on_grid
from advisor.simulators.protocol import Replay
from advisor.simulators.rate_filter import cause_of, lateness, unfiltered
from advisor.simulators.surrogate import trimmed_at
from advisor.simulators.unseen import floor_of, predicted, unknown_offset
from advisor.words.certainty import DECIDED, as_sure
from advisor.words.problems import UnusableInputError

_BLOCKS = frozenset({"input", "alpha_sensor", "pitch_rate_sensor", "accelerometer", "timing"})
"""Blocks outside the physics: the actuator and the instruments."""
_CLEARLY = 0.5
"""Largest gap without the simulator's effect, relative to the gap of the simulator as given. A smaller
difference between two fits of one flight is no evidence."""
_MOTION = ("alpha", "q", "theta", "a_z")
_IMPOSSIBLE = 1e-300
"""Probability that replaces zero in log odds, so that the logarithm exists."""


@dataclass(frozen=True)
class Mirrored:
    """A simulator with an effect that the aircraft lacks."""

    causes: tuple[Cause, ...]
    """Effects of the simulator that the aircraft lacks, with negative sizes."""
    before: float
    after: float
    """Gap of the simulator without these effects, with no parameter fitted to the flight."""

    def said(self, diagnosis: Diagnosis) -> Diagnosis:
        """Return the diagnosis with the simulator's effects as its causes."""
        removed = 100.0 * (1.0 - self.after / self.before)
        first = self.causes[0]
        sentence = f"{_said(first)}; without it the gap is {removed:.0f} % less."
        where = replace(diagnosis.where, block=first.block, share=float(np.clip(removed / 100.0, 0.0, 1.0)))
        simulated = diagnosis.in_simulator
        if simulated is not None:
            names = tuple(cause.effect for cause in self.causes)
            simulated = replace(
                simulated, after=simulated.before, percent=0.0, on_paper=simulated.on_paper or names
            )
        mine = Alternative("effect", first.effect, first.block)
        known = diagnosis.evidence
        evidence = _with_share(known, mine, first.probability) if known else ()
        return replace(
            _answered_by(diagnosis, evidence, mine), sentence=as_sure(sentence, answers_of(evidence)),
            where=where, causes=self.causes, effects={}, waterfall=((first.effect, self.after),), shrink=None,
            in_simulator=simulated,
        )  # fmt: skip


def mirrored(
    whole: Examined,
    maneuvers: Sequence[Maneuver],
    flying: Flying,
    replays: Sequence[Replay],
    aircraft: Aircraft,
    as_flown: Mapping[int, AsGiven],
) -> Mirrored | None:
    """Return the effects that only the simulator has; None without such effects.

    Parameters
    ----------
    flying, replays
        Simulator, and its replays without added effects.
    as_flown
        Difference of simulator and surrogate that the diagnosis removed, by manoeuvre number.
    """
    if whole.diagnosis.verdict not in ("effect", "parameters", "unknown"):
        return None
    unknown = replace(aircraft, model={}, effects={}, simulator=None)
    unknown = replace(unknown, elevator=replace(aircraft.elevator, lag_s=None, delay_s=None))
    gap = whole.diagnosis.gap
    # What is unknown explains nothing, whatever of it the likeliest course of the air removes. Fitted numbers
    # of the aircraft imitate a dead band of the simulator, whose own size no flight has fitted.
    is_effect = whole.diagnosis.verdict == "effect"
    most = gap.after + VISIBLE if is_effect else _CLEARLY * gap.before

    def without(model: Mapping[str, float], effects: Mapping[str, Mapping[str, float]]) -> float:
        as_file = replace(unknown, model=dict(model), reference_airspeed_m_s=flying.flights.reference_m_s)
        return _gap_without(whole, flying, as_flown, _beyond(flying, replays, as_file, effects), as_file)

    try:
        as_flights = _as_flights(maneuvers, flying, replays)
        looks = _quick_look(as_flights, unknown)
        if looks is None or without(*looks) > _CLEARLY * gap.before:
            return None
        own = examine(as_flights, unknown).diagnosis
    except UnusableInputError:
        return None
    late = None
    if own.verdict == "unknown" and own.where.block == "pitch_rate_sensor":
        late, replays = lateness(replays), [unfiltered(replay) for replay in replays]
        own = examine(_as_flights(maneuvers, flying, replays), unknown).diagnosis
    causes = tuple(c for c in own.causes if c.present and c.block in _BLOCKS)
    if not causes and late is None:
        return None
    effects = {c.effect: own.effects[c.effect] for c in causes if c.effect in own.effects}
    after = without({name: own.model[name].value for name in DERIVATIVES}, effects)
    if after > most:
        return None
    filtered = () if late is None else (cause_of(late, after, own),)
    return Mirrored((*filtered, *map(_negative, causes)), gap.before, after)


def _quick_look(
    as_flights: Sequence[Maneuver], unknown: Aircraft
) -> tuple[Mapping[str, float], Mapping[str, Mapping[str, float]]] | None:
    """Return the replays' derivatives and likeliest actuator or instrument effect, or None."""
    problem, plain = fit_baseline(prepare(as_flights, unknown), unknown)
    around = [variant for variant in variants_for(problem.flights) if variant.block in _BLOCKS]
    found = Screen(problem, plain).likeliest(around)
    if found is None:
        return None
    values = found.point.values[-1]
    sizes = parameters_of(found.variant, values, np.zeros(len(values)))
    model = dict(zip(DERIVATIVES, map(float, found.point.derivatives), strict=True))
    return model, {found.name: {name: size.value for name, size in sizes.items()}}


def _gap_without(
    whole: Examined,
    flying: Flying,
    as_flown: Mapping[int, AsGiven],
    grids: Mapping[int, AsGiven],
    as_file: Aircraft,
) -> float:
    """Return the flight's gap to the simulator without its effects, with no parameter fitted."""
    problem, floor = whole.findings.problem, floor_of(whole)
    flights = problem.flights.flights
    differs = [grids[f.number].beyond - as_flown[f.number].beyond for f in flights]
    now = replace(with_series(problem, differs, -1.0), base=base_entries(as_file), changes=())
    derivatives = np.array([as_file.model[name] for name in DERIVATIVES])
    given = SearchPoint(derivatives, whole.findings.last.fitted.point.own)
    offset = unknown_offset(whole.diagnosis, None)
    plain = whole.findings.models[0].fitted
    return whole_gap(predicted(now, given, plain, floor, range(len(flights)), offset).mean_square, floor)


def _as_flights(maneuvers: Sequence[Maneuver], flying: Flying, replays: Sequence[Replay]) -> list[Maneuver]:
    """Return the simulator's replays as manoeuvres, with the noise of the flight's instruments."""
    by_number = {m.number: m for m in maneuvers}
    white = dict(zip(flying.flights.channels, flying.flights.white, strict=True))
    found = []
    for flight, replay in zip(flying.flights.flights, replays, strict=True):
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
        found.append(replace(maneuver, channels=channels))
    return found


def _beyond(
    flying: Flying, replays: Sequence[Replay], as_file: Aircraft, effects: Mapping[str, Mapping[str, float]]
) -> dict[int, AsGiven]:
    """Return the difference between the simulator and a surrogate with its effects."""
    flights = flying.flights
    base = with_known(base_entries(as_file), effects, flights, variants_for(flights))
    derivatives = np.array([as_file.model[name] for name in DERIVATIVES])
    still = SearchPoint(derivatives, np.zeros((len(flights), len(NUISANCES))))
    problem = EffectProblem(flights, base)
    differences = {}
    pairs = zip(flying.as_flown(replays), replays, problem.driving(still), strict=True)
    for there, replay, numbers in pairs:
        # The simulator hands its instruments' effects out already; the surrogate gets them here.
        linear = skewed(problem.fly(there, trimmed_at(numbers, there)), there.h, numbers)
        differences[there.number] = AsGiven(there, on_grid(replay, there) - linear)
    return differences


def _said(cause: Cause) -> str:
    """Return the statement about a simulator effect of negative size."""
    if cause.block == "input":
        return what(cause)
    read = what(_negative(cause))
    return f"In the simulator alone {read[0].lower()}{read[1:]}"


def _negative(cause: Cause) -> Cause:
    """Return an effect of the simulator as a cause, with the negative of its size, because the aircraft lacks
    the effect.
    """
    first, *rest = cause.parameters.items()
    name, size = first
    return replace(cause, parameters={name: Value(-size.value, size.std), **dict(rest)})


def _with_share(
    evidence: Sequence[AlternativeEvidence], alternative: Alternative, share: float
) -> tuple[AlternativeEvidence, ...]:
    """Return the evidence with more probability for one alternative, and proportionally less for the others.

    The likeliest alternative is first.
    """
    scale = (1.0 - share) / max(sum(one.probability for one in evidence), _IMPOSSIBLE)
    others = [replace(one, probability=scale * one.probability) for one in evidence]
    mine = next((other for other in others if other.alternative == alternative), None)
    mine = mine or AlternativeEvidence(alternative, (), 0.0)
    more = replace(mine, probability=mine.probability + share)
    rest = [other for other in others if other.alternative != alternative]
    return tuple(sorted([more, *rest], key=lambda one: -one.probability))


def _answered_by(
    diagnosis: Diagnosis, evidence: tuple[AlternativeEvidence, ...], answer: Alternative
) -> Diagnosis:
    """Return the diagnosis with an answer from flights of the simulator, and its odds."""
    verdict: GapVerdict = "effect" if answer.is_effect else answer.kind  # type: ignore[assignment]
    d = replace(diagnosis, verdict=verdict, evidence=evidence, answer=answer, why=(), rival="", decisions=())
    ranked = together((one.alternative, one.probability) for one in evidence)
    if len(ranked) < 2:
        return d
    (_, p), (rival, q) = ranked[:2]
    odds = math.log(p / max(q, _IMPOSSIBLE))
    about = answer.block if answer.kind == "unknown" else answer.name
    return replace(
        d, rival=rival.label,
        why=(Contribution("flown", odds, "flights of the simulator with the correction"),),
        decisions=(
            Decision(about, "against its rival", odds, 0.0, "nats"),
            Decision(about, "decided", p, DECIDED, "probability"),
        ),
    )  # fmt: skip
