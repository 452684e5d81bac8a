"""Posterior of all explanations of a flight in pitch, including an offset of α and moving air."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.instruments.kinematics import KinematicCheck
from advisor.gap.candidates.known import beyond_known, beyond_servo, variants_for
from advisor.gap.fitting.fit import EffectFit
from advisor.gap.fitting.holdout import HeldOut
from advisor.gap.fitting.measure import whole_gap
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.inference.engine import Decided, Progress, decided, first_stage
from advisor.gap.inference.evidence import FlightProblem
from advisor.gap.inference.explanation import Row
from advisor.gap.inference.laws import laws_of
from advisor.gap.inference.offset import with_offset
from advisor.gap.inference.pitch import PitchFlight, PitchModel
from advisor.gap.inference.posterior import NONE, relabelled, stated_as
from advisor.gap.inference.prior import FieldPrior
from advisor.gap.inference.sizes import with_sizes
from advisor.gap.kit.effect import Variant
from advisor.gap.noise.quiet import quiet_rms
from advisor.gap.noise.stamps import stamp_power
from advisor.gap.records.floor import tolerance_of
from advisor.gap.search.air import SoughtAir, moving_air
from advisor.process.arrays import FloatArray

Mirror = Callable[[PitchFlight, PitchModel, float], PitchModel | None]


@dataclass(frozen=True)
class Inference(Decided[PitchModel]):
    """Data and posterior from which the answer of a diagnosis is made."""

    problem: EffectProblem
    sought_air: SoughtAir
    floor: FloatArray
    """Shape (channels,): noise of each channel before and after the manoeuvre's input."""


def infer(
    problem: EffectProblem,
    baseline: EffectFit,
    aircraft: Aircraft,
    kinematics: KinematicCheck,
    prior: FieldPrior,
    progress: Progress,
    mirror: Mirror,
) -> Inference:
    """Return the posterior of all explanations of a flight.

    Parameters
    ----------
    kinematics
        Check of α against the motion, which alone shows a constant offset.
    """
    begun = FlightProblem.of(problem, baseline)
    table, laws = _table(problem, begun, aircraft)
    flight = PitchFlight(begun, baseline, table, laws, mirror=mirror)
    progress(f"trying {len(table) + len(laws)} ways to explain the residual", 0.12)
    stage = first_stage(flight)
    progress("looking at the air", 0.5)
    sought = moving_air(problem, stage.best.fitted)
    floor = floor_of(problem, stage.best.fitted, stage.best.held_out)
    # The aircraft file may state moving air.
    sigma = aircraft.effects.get("turbulence", {}).get("sigma_w_m_s", 0.0) / problem.flights.reference_m_s

    def beyond(rows: list[Row[PitchModel]]) -> list[Row[PitchModel]]:
        if "alpha" in problem.channels:
            computed = problem.flights.alpha_is_derived
            rows = with_offset(rows, kinematics.offset, computed, prior, flight.tried[0])
        return _named_air(rows, stage.plain, sought, sigma, floor)

    progress("searching for a second cause", 0.52)
    final = decided(flight, stage, prior, beyond)
    return Inference(final.posteriors, final.chosen, final.failed, final.heat, problem, sought, floor)


def _table(
    problem: EffectProblem, flight: FlightProblem, aircraft: Aircraft
) -> tuple[list[Variant], list[Variant]]:
    """Return catalogue effects beyond the aircraft file's, and other laws, with prior sizes."""
    stated = {change.effect for change, _ in problem.changes}
    variants = beyond_known(aircraft.effects, beyond_servo(aircraft, variants_for(problem.flights)))
    described = [w for v in variants if v.effect not in stated for w in (v, *v.likewise)]
    return (
        [with_sizes(v, flight.mean, problem.flights) for v in described if v.starts],
        [with_sizes(v, flight.mean, problem.flights) for v in laws_of(problem.flights) if v.starts],
    )


def _named_air(
    rows: Sequence[Row[PitchModel]], plain: PitchModel, sought: SoughtAir, stated: float, floor: FloatArray
) -> list[Row[PitchModel]]:
    """Return the rows with moving air as the answer of still-air models without a larger cause.

    Air that exceeds natural air acts in every model. Next to right derivatives the air is the answer. Next to
    an effect, the pair has the name of the cause that removes more of the gap. Wrong derivatives stay wrong
    in moving air, and a residual beyond the air stays an effect without a name.
    """
    air = sought.found
    if air is None or air.is_natural or (not air.gust and air.angle_std <= stated):
        return list(rows)
    name, beyond = stated_as("gust" if air.gust else "turbulence"), air.mean_square_beyond_air
    plain_gap = whole_gap(plain.held_out.mean_square, floor)

    def is_air(row: Row[PitchModel]) -> bool:
        if row.alternative.kind in ("unknown", "parameters"):
            return False
        left = row.model.held_out.mean_square
        by_air = whole_gap(left, floor) - whole_gap(np.minimum(beyond, left), floor)
        return row.alternative == NONE or plain_gap - whole_gap(left, floor) < by_air

    def named(row: Row[PitchModel]) -> Row[PitchModel]:
        return replace(relabelled(row, name), terms={**row.terms, "steady": air.steady})

    return [named(row) if is_air(row) else row for row in rows]


def floor_of(problem: EffectProblem, last: EffectFit, held_out: HeldOut) -> FloatArray:
    """Return the noise of each channel before and after the input, shape (channels,)."""
    # Jitter of the stamps belongs to the instruments, but appears only where a channel moves.
    measured = quiet_rms(problem, last) ** 2 + stamp_power(problem, last)
    tolerance = tolerance_of(problem.flights)
    return np.maximum(np.sqrt(np.minimum(measured, held_out.mean_square)), tolerance)
