"""The ledger: every statistic that was compared with a limit on the way to a verdict, in order."""

from advisor.gap.decision import CERTAIN, Decision
from advisor.gap.evidence.found import Evidence
from advisor.gap.result import VISIBLE
from advisor.gap.search.acceptance import JudgedAddition
from advisor.gap.search.stage import Stage
from advisor.gap.verdict.wrong_derivatives import WrongDerivatives


def decisions_of(e: Evidence, derivatives: WrongDerivatives) -> tuple[Decision, ...]:
    """Return the decisions on effects, moving air, unexplained residual and the aircraft file's
    derivatives."""
    return (
        *(decision for stage in e.stages for decision in _of_stage(stage)),
        *_of_the_air(e),
        *(() if e.unexplained is None else e.unexplained.decisions),
        *_of_the_derivatives(e, derivatives),
    )


def _of_stage(stage: Stage) -> list[Decision]:
    """Return why an effect was added, and why others with a positive gain were rejected."""
    refused = [judged for judged in stage.considered if judged.gain > 0.0 and not judged.is_accepted]
    against = [decision for judged in refused for decision in _against(judged)]
    return [*against, *(() if stage.added is None else stage.added.decisions)]


def _against(judged: JudgedAddition) -> list[Decision]:
    return [decision for decision in judged.decisions if not decision.holds]


def _of_the_air(e: Evidence) -> list[Decision]:
    if e.air is None:
        return []
    about = "gust" if e.air.gust else "turbulence"
    return [Decision(about, "likelihood", e.air.gain, CERTAIN, "log likelihood gained")]


def _of_the_derivatives(e: Evidence, derivatives: WrongDerivatives) -> list[Decision]:
    if e.file_model is None:
        return []
    unit = "mean square over the noise, beyond fitted numbers"
    gap = Decision("parameters", "gap", derivatives.gap, VISIBLE, unit)
    odds = Decision(
        "parameters", "odds", derivatives.distance.log_odds, 0.0, "log odds of wrong numbers, nats"
    )
    return [gap, odds]
