"""Answer of a single manoeuvre, which shows only where the gap lies. One manoeuvre proves no cause."""

from dataclasses import replace

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.instruments.kinematics import KinematicCheck
from advisor.gap.candidates.known import variants_for
from advisor.gap.fitting.fit import EffectFit, fit
from advisor.gap.fitting.holdout import hold_out
from advisor.gap.fitting.measure import file_model_of, whole_gap
from advisor.gap.fitting.prior import ERROR_IF_RIGHT
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.fitting.uncertainty import colour_of, covariance_of
from advisor.gap.foresight.foresee import unseen_effects
from advisor.gap.inference.diagnose import floor_of
from advisor.gap.inference.evidence import FlightProblem
from advisor.gap.inference.findings import Findings, Model, Unexplained
from advisor.gap.inference.residual import residual_of
from advisor.gap.result import Diagnosis, GapVerdict, Where, ranked
from advisor.gap.verdict.answer import speed_is_known
from advisor.gap.verdict.notes import notes_of
from advisor.gap.verdict.numbers import (
    compared_derivatives,
    fidelity_of,
    gap_numbers,
    irreducible,
    model_of,
    traces_of,
)
from advisor.gap.verdict.reasons import VISIBLE_GAP
from advisor.gap.verdict.text import sentence_of, sentence_of_one_maneuver

_FIXED = 0.1
"""Numerical: tolerance of derivatives fixed at the file's values, over that of right derivatives."""


def answer_of_one(
    problem: EffectProblem, baseline: EffectFit, aircraft: Aircraft, kinematics: KinematicCheck
) -> tuple[Diagnosis, Findings]:
    """Return the diagnosis of a single manoeuvre, and its findings.

    The gap is that of the file's derivatives, or of fitted derivatives if the file states none.
    """
    held_out = hold_out(problem, baseline)
    floor = floor_of(problem, baseline, held_out)
    file_model = file_model_of(problem, baseline)
    before = file_model or held_out
    unexplained = None
    if whole_gap(before.mean_square, floor) >= VISIBLE_GAP:
        unexplained = _located(problem, baseline)
    e = Findings(problem, (Model(baseline, held_out),), unexplained, None, floor, file_model, None, None)
    gap = gap_numbers(problem, floor, before, held_out)
    cov = covariance_of(problem, baseline, colour_of(problem, baseline))
    where = Where("force_equation", 0.0, ())
    if unexplained is not None:
        where = Where(unexplained.block, unexplained.share, unexplained.ranking)
    verdict: GapVerdict = "none" if unexplained is None else "unknown"
    diagnosis = Diagnosis(
        verdict=verdict,
        sentence=sentence_of(verdict, gap, where, (), None) if unexplained is None
        else sentence_of_one_maneuver(where),
        gap=gap, where=where, causes=(), shrink=None, waterfall=(),
        cannot_see=unseen_effects(problem, baseline, variants_for(problem.flights), floor, set()),
        kinematics=kinematics, model=model_of(problem, baseline, cov),
        reference_airspeed_m_s=problem.flights.reference_m_s if speed_is_known(problem, aircraft) else None,
        effects={}, share_irreducible=irreducible(held_out.mean_square, floor, gap),
        yardsticks=fidelity_of(problem, before, held_out),
        traces=traces_of(problem, before, held_out),
        derivatives=compared_derivatives(problem, baseline, cov),
        notes=notes_of(e, aircraft, None, verdict, ()),
        maneuvers=tuple(f.number for f in problem.flights.flights),
    )  # fmt: skip
    return diagnosis, e


def _located(problem: EffectProblem, baseline: EffectFit) -> Unexplained:
    """Return the block whose disturbance explains the file model's residual best."""
    as_filed = baseline
    if problem.prior_derivatives is not None:
        file = replace(baseline.point, derivatives=problem.prior_derivatives)
        fixed = FlightProblem.of(problem, baseline).within(_FIXED * ERROR_IF_RIGHT)
        as_filed = fit(fixed, file, baseline.noise)
    blocks = residual_of(problem, as_filed, 1.0).blocks
    ranking = ranked(blocks)
    return Unexplained(ranking[0][0], blocks[ranking[0][0]], ranking)
