"""Gap in the user's own simulator with the effects added, on held-out manoeuvres.

The qualification is the published tolerance of the short period: 14 CFR Part 60, Appendix A, Table A2A, test
2.c.10. Pitch within 1.5° or pitch rate within 2 °/s, and normal acceleration within 0.10 g, over the time
history.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from advisor.gap.diagnose import Examined
from advisor.gap.fitting.holdout import HeldOut
from advisor.gap.fitting.measure import whole_gap
from advisor.gap.fitting.problem import EffectProblem, SearchPoint
from advisor.gap.result import InSimulator, Qualification
from advisor.gap.simulator.layout import DERIVATIVES, INDEX, OUTPUTS
from advisor.gap.verdict.numbers import BAND, yardsticks
from advisor.oem.rows import Signal
from advisor.process.arrays import FloatArray
from advisor.simulators.as_given import AsGiven, Flying, added, beyond, without_servo
from advisor.simulators.increments import EQUATIONS
from advisor.simulators.inputs import at_reference
from advisor.simulators.surrogate import Surrogate
from advisor.simulators.unseen import (
    Flown,
    UnseenManeuvers,
    as_changed,
    changes_something,
    floor_of,
    percent_of,
    predicted,
    unknown_offset,
)
from advisor.words.problems import UnusableInputError

_WINDOW_S = 0.1
"""Length of the moving average over an error, s. Shorter errors are instrument noise."""


def qualified(
    problem: EffectProblem, before: HeldOut, after: HeldOut | None, kept: Sequence[int]
) -> tuple[Qualification, ...]:
    """Return every channel compared with its tolerance.

    Parameters
    ----------
    before, after
        Residuals of the simulator as given, and with the effects; None if nothing was added.
    """
    table = []
    for c, channel in enumerate(problem.channels):
        was, theil_was = _error(problem, before, kept, c)
        now, theil_now = (None, None) if after is None else _error(problem, after, kept, c)
        limit = BAND.get(channel)
        table.append(
            Qualification(channel, None if limit is None else float(limit), was, now, (theil_was, theil_now))
        )
    return tuple(table)


def _error(problem: EffectProblem, held: HeldOut, kept: Sequence[int], c: int) -> tuple[float, float]:
    """Return the largest error in the channel's unit, averaged over the window, and Theil's coefficient."""
    largest = 0.0
    measured: list[FloatArray] = []
    simulated: list[FloatArray] = []
    for i in kept:
        flight = problem.flights.flights[i]
        out = flight.outputs[problem.channels[c]]
        residual = held.residuals[i][problem.rows(flight)[c]]
        largest = max(largest, float(np.max(np.abs(_averaged(out.t, residual)))))
        measured.append(out.y)
        simulated.append(out.y - residual)
    return largest, yardsticks(problem.channels[c], np.concatenate(measured), np.concatenate(simulated)).theil


def _averaged(t: FloatArray, y: FloatArray) -> FloatArray:
    """Return the mean of the samples within the window around each stamp, both of shape (n,)."""
    first = np.searchsorted(t, t - 0.5 * _WINDOW_S, side="left")
    behind = np.searchsorted(t, t + 0.5 * _WINDOW_S, side="right")
    sums = np.concatenate([[0.0], np.cumsum(y)])
    return np.asarray((sums[behind] - sums[first]) / (behind - first))


DERIVATIVES_OF_IT, SERVO_OF_IT = "derivatives", "its own servo"


@dataclass(frozen=True)
class CarriedPart:
    """Part of a model that the simulator supports."""

    point: SearchPoint
    on_paper: tuple[str, ...]


def in_simulator(
    whole: Examined,
    unseen: UnseenManeuvers | None,
    flying: Flying,
    surrogate: Surrogate,
    as_flown: Mapping[int, AsGiven],
) -> Flown:
    """Return the gap in the simulator as given, and with the effects and derivatives of an export.

    Parameters
    ----------
    whole
        Diagnosis of all manoeuvres without the difference between simulator and surrogate.
    unseen
        Held-out manoeuvres with the diagnosis of the others; None if nothing was found.
    as_flown
        Manoeuvre as the simulator flew it, by manoeuvre number.
    """
    problem, floor = whole.findings.problem, floor_of(whole)
    flights = problem.flights.flights
    kept = tuple(range(len(flights))) if unseen is None else unseen.kept
    derivatives = np.array([surrogate.derivatives[name] for name in DERIVATIVES])
    given = SearchPoint(derivatives, whole.findings.last.fitted.point.own)
    plain = (whole if unseen is None else unseen.examined).findings.models[0].fitted
    before = predicted(problem, given, plain, floor, kept, unknown_offset(whole.diagnosis, None))
    was = whole_gap(before.mean_square, floor)
    original = with_series(problem, [as_flown[f.number].beyond for f in flights], 1.0)
    unchanged = InSimulator(
        flying.simulator.description, tuple(flights[i].number for i in kept), was, was, 0.0, (),
        qualified(original, before, None, kept),
    )  # fmt: skip
    as_it_was = Flown(before, None, was, was, gap=unchanged)
    if unseen is None or not changes_something(unseen.examined.diagnosis):
        return as_it_was
    part = _carried(as_changed(unseen, whole), problem, surrogate, flying)
    unchanged = replace(unchanged, on_paper=part.on_paper)
    as_it_was = replace(as_it_was, on_paper=part.on_paper, gap=unchanged)
    if not part.point.effects and np.array_equal(part.point.derivatives, derivatives):
        return as_it_was
    try:
        now = _flown_with(part, problem, kept, flying, as_flown, surrogate)
    except UnusableInputError as error:
        # The diagnosis stands, even if the simulator does not fly with the effects.
        refused = replace(unchanged, after=None, percent=None, refused=str(error.problem))
        return replace(as_it_was, gap=refused)
    offset = unknown_offset(whole.diagnosis, unseen.examined.diagnosis)
    own = unseen.examined.findings.last.fitted
    after = predicted(now, part.point, own, floor, kept, offset)
    here = whole_gap(after.mean_square, floor)
    if here > was:
        # Nothing is added that raises the gap.
        return replace(as_it_was, gap_after=here)
    improved = replace(
        unchanged,
        after=here,
        percent=percent_of(was, here),
        after_air_and_instruments=_without_air(whole, after),
        qualification=qualified(original, before, after, kept),
    )
    return Flown(before, after, was, here, part.on_paper, improved)


def where_it_acts(
    whole: Examined, flying: Flying, surrogate: Surrogate, as_flown: Mapping[int, AsGiven]
) -> Examined:
    """Return the diagnosis refitted with the effects in both simulator and surrogate.

    The difference between simulator and surrogate depends on the motion. With a servo lag the simulator's
    motion differs from that of the simulator as given. Other numbers alone change the difference in second
    order. The likelier parameter values are kept. Arguments are those of ``in_simulator``.
    """
    if whole.seen_in is None or not changes_something(whole.diagnosis):
        return whole
    problem, point = whole.findings.problem, as_changed(UnseenManeuvers((), whole), whole)
    # The simulator has a propeller of its own.
    point = point.keeping([k for k, effect in enumerate(point.effects) if not effect.is_nuisance])
    blocks = {effect.block for effect in point.effects}
    if blocks.isdisjoint(("input", *EQUATIONS)):
        return whole
    if blocks.isdisjoint(EQUATIONS):
        point = replace(point, derivatives=np.array([surrogate.derivatives[name] for name in DERIVATIVES]))
    part = _carried(point, problem, surrogate, flying)
    every = range(len(problem.flights))
    try:
        return whole.seen_in(_flown_with(part, problem, every, flying, as_flown, surrogate))
    except UnusableInputError:
        # The simulator does not fly with the effects, which ``in_simulator`` says.
        return whole


def _flown_with(
    part: CarriedPart,
    problem: EffectProblem,
    kept: Sequence[int],
    flying: Flying,
    as_flown: Mapping[int, AsGiven],
    surrogate: Surrogate,
) -> EffectProblem:
    """Return the problem without the difference between surrogate and simulator, both with the effects."""
    flights = problem.flights.flights
    given = [as_flown[f.number] for f in flights]
    still = replace(part.point, own=np.zeros_like(part.point.own))
    changed = problem.driving(still)[list(kept)]
    began = [at_reference(given[i].flight, problem.flights.reference_m_s) for i in kept]
    as_it_is = np.array([surrogate.derivatives[name] for name in DERIVATIVES])
    changes = any(v.block in EQUATIONS for v in part.point.effects) or np.any(
        part.point.derivatives != as_it_is
    )
    increments = added(began, changed, as_it_is) if changes and flying.simulator.takes_increments else None
    measured = replace(flying, flights=replace(problem.flights, flights=tuple(flights[i] for i in kept)))
    replays = measured.replays(without_servo(changed, surrogate), problem.held, increments)
    grids = dict(zip(kept, beyond(measured, replays, changed, problem.held), strict=True))
    differs = [grids.get(i, was.beyond) - was.beyond for i, was in enumerate(given)]
    return with_series(problem, differs, -1.0)


def _carried(point: SearchPoint, problem: EffectProblem, surrogate: Surrogate, flying: Flying) -> CarriedPart:
    """Return a model without the parts that the simulator does not support, and these parts' names."""
    on_paper: list[str] = []
    if not flying.simulator.takes_increments:
        derivatives = np.array([surrogate.derivatives[name] for name in DERIVATIVES])
        outside = [v.effect for v in point.effects if v.block in EQUATIONS]
        inside = [k for k, v in enumerate(point.effects) if v.effect not in outside]
        point = replace(point.keeping(inside), derivatives=derivatives)
        on_paper += [*outside, DERIVATIVES_OF_IT]
    base = np.atleast_2d(problem.base)[0]
    values = list(point.values)
    for k, effect in enumerate(point.effects):
        for name, own in (("lag_s", surrogate.lag_s), ("delay_s", surrogate.delay_s)):
            if effect.block == "input" and name in effect.names:
                at = effect.names.index(name)
                least = own - float(base[INDEX[name]])
                if values[k][at] < least:
                    values[k] = np.where(np.arange(len(values[k])) == at, least, values[k])
                    on_paper.append(SERVO_OF_IT)
    return CarriedPart(replace(point, values=tuple(values)), tuple(dict.fromkeys(on_paper)))


def with_series(problem: EffectProblem, grids: Sequence[FloatArray], sign: float) -> EffectProblem:
    """Return the problem with series on the time grid, times ``sign``, added to the measurements."""
    flights = []
    for flight, grid in zip(problem.flights.flights, grids, strict=True):
        t = np.arange(grid.shape[1]) * flight.h
        outputs = {
            name: Signal(out.t, out.y + sign * np.interp(out.t, t, grid[OUTPUTS.index(name)]))
            for name, out in flight.outputs.items()
        }
        flights.append(replace(flight, outputs=outputs))
    return replace(problem, flights=replace(problem.flights, flights=tuple(flights)))


def _without_air(whole: Examined, after: HeldOut) -> float:
    """Return the gap without the part that the air's course explains."""
    left, air = after.mean_square, whole.findings.air
    if air is not None:
        left = left * np.minimum(air.mean_square_beyond_air / whole.findings.last.held_out.mean_square, 1.0)
    return whole_gap(left, floor_of(whole))
