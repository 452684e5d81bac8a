"""The gap of the lateral axis: the simulator's derivatives and effects against those of the flight.

The derivatives are compared within their intervals. ``diagnosis`` gives probabilities of right derivatives,
wrong derivatives and effects. The gap of each manoeuvre is measured with the derivatives that all other
manoeuvres give.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import SIDE_PARAMETERS
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.gap.axes.lateral.diagnosis import Kind, SideDiagnosis, diagnose_side
from advisor.gap.axes.lateral.models import case_of
from advisor.gap.inference.prior import FIELD, FieldPrior
from advisor.gap.result import IMPROVING, ComparedDerivative, Trace, Value
from advisor.oem.axes.lateral.estimate import LateralEstimate
from advisor.oem.axes.lateral.estimator import estimate_lateral
from advisor.oem.estimate import NoEstimate
from advisor.words.certainty import as_sure


@dataclass(frozen=True, slots=True)
class SideGap:
    """Comparison of the aircraft file's lateral derivatives with the flight."""

    verdict: Kind | None
    """Kind of the likeliest explanation; None without a fit, or without stated derivatives and effects."""
    sentence: str
    derivatives: tuple[ComparedDerivative, ...]
    instruments: Mapping[str, Value]
    """Estimated lag or delay of each servo and clock."""
    not_identifiable: Mapping[str, str]
    maneuvers: tuple[int, ...]
    diagnosis: SideDiagnosis | None
    """Probabilities of all explanations; None where no model fits."""
    traces: tuple[Trace, ...] = ()
    """Measured and simulated outputs of the manoeuvres; empty unless requested."""
    corrects: bool = True
    """Whether the corrections do not increase the gap of held-out manoeuvres."""

    @property
    def improves(self) -> bool:
        """Whether the comparison gives an improved simulator, by an effect or by other derivatives."""
        return self.verdict in IMPROVING and self.corrects


def compare_side(
    maneuvers: Sequence[Maneuver],
    aircraft: Aircraft,
    prior: FieldPrior = FIELD,
    logged: LateralEstimate | None = None,
    as_logged: bool = False,
) -> SideGap | NoEstimate:
    """Compare roll and yaw of the aircraft file with accepted manoeuvres.

    A derivative that the file does not state is taken from the flight. ``prior`` holds the probability of
    each kind of answer before the flight. ``logged`` is the estimate from the manoeuvres as logged, and
    ``as_logged`` tells that these are the manoeuvres.
    """
    model = logged if logged is not None and as_logged else estimate_lateral(maneuvers, aircraft)
    if isinstance(model, NoEstimate):
        return model
    case = case_of(maneuvers, aircraft, model.theta)
    diagnosis = None if isinstance(case, NoEstimate) else diagnose_side(case, prior)
    answer = diagnosis.verdict if diagnosis else None
    seen = model if logged is None else logged
    told = (map(Value, one.theta.tolist(), one.std.tolist()) for one in (model, seen))
    found = dict(zip(SIDE_PARAMETERS, map(Value.agreeing, *told), strict=True))
    if diagnosis is not None and answer == "effect":
        # Beside an effect the derivatives are those of the model that contains the effect.
        found = dict(diagnosis.derivatives)
    stated = tuple(
        ComparedDerivative(name, aircraft.model[name], value)
        for name, value in found.items()
        if name in aircraft.model and name not in {*model.not_identifiable, *seen.not_identifiable}
    )
    verdict = answer if stated or answer in ("effect", "unknown") else None
    acts = diagnosis if verdict in ("effect", "unknown") else None
    sentence = acts.sentence if acts else sentence_of_side(verdict, stated)
    return SideGap(
        verdict,
        as_sure(sentence, diagnosis.answers) if verdict and diagnosis else sentence,
        stated,
        {name: Value(*told) for name, told in model.nuisances.items()},
        model.not_identifiable,
        tuple(m.number for m in maneuvers),
        diagnosis,
    )


def sentence_of_side(verdict: str | None, derivatives: Sequence[ComparedDerivative]) -> str:
    """Return the sentence of the report for an answer without an effect."""
    if verdict is None:
        return (
            "The aircraft file states no derivative of roll and yaw that the flight tells: give model.L_p "
            "and the like."
        )
    if verdict == "none":
        return "The simulator's derivatives of roll and yaw are those of the flight; no effect is missing."
    wrong = [one.name for one in derivatives if one.differs]
    listed = f": {', '.join(wrong)}" if wrong else " together, though none alone"
    return f"The simulator's derivatives of roll and yaw are not those of the flight{listed}."
