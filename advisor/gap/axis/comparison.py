"""The gap of an axis: the simulator's derivatives and effects against those of the flight.

The derivatives are compared within their intervals. ``diagnosis`` gives probabilities of right derivatives,
wrong derivatives and effects. The gap of each manoeuvre is measured with the derivatives that all other
manoeuvres give.
"""

from collections.abc import Sequence
from dataclasses import replace

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.instruments.kinematics import KinematicCheck
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.gap.axis.diagnosis import diagnose_axis
from advisor.gap.axis.models import case_of
from advisor.gap.inference.prior import FIELD, FieldPrior
from advisor.gap.result import ComparedDerivative, Diagnosis, Gap, GapVerdict, Value
from advisor.gap.verdict.text import answers_of
from advisor.model.axis import Axis
from advisor.oem.axis.estimate import AxisEstimate
from advisor.oem.axis.estimator import estimate_axis
from advisor.oem.estimate import NoEstimate
from advisor.words.certainty import as_sure


def compare_axis(
    axis: Axis,
    maneuvers: Sequence[Maneuver],
    aircraft: Aircraft,
    prior: FieldPrior = FIELD,
    logged: AxisEstimate | None = None,
    as_logged: bool = False,
    kinematics: KinematicCheck | None = None,
) -> Diagnosis | NoEstimate:
    """Compare an axis of the aircraft file with accepted manoeuvres.

    A derivative that the file does not state is taken from the flight. ``prior`` holds the probability of
    each kind of answer before the flight. ``logged`` is the estimate from the logged manoeuvres.
    ``as_logged`` says that ``maneuvers`` are the logged ones. ``kinematics`` is the check of a measured angle
    of attack against the motion.
    """
    model = logged if logged is not None and as_logged else estimate_axis(axis, maneuvers, aircraft)
    if isinstance(model, NoEstimate):
        return model
    case = case_of(axis, maneuvers, aircraft, model.theta)
    made = (
        None if isinstance(case, NoEstimate) else diagnose_axis(replace(case, kinematics=kinematics), prior)
    )
    diagnosis = made or Diagnosis(
        axis=axis.key, verdict="untested", sentence="", gap=Gap(), model={},
        maneuvers=tuple(m.number for m in maneuvers),
    )  # fmt: skip
    seen = model if logged is None else logged
    estimated = (map(Value, e.theta.tolist(), e.std.tolist()) for e in (model, seen))
    values = dict(zip(axis.names.reported, map(Value.agreeing, *estimated), strict=True))
    acts = diagnosis.verdict in ("effect", "unknown")
    if diagnosis.verdict == "effect":
        # Beside an effect the derivatives are those of the model that contains the effect.
        values = dict(diagnosis.model)
    stated = tuple(
        ComparedDerivative(name, aircraft.model[name], value)
        for name, value in values.items()
        if name in aircraft.model and name not in {*model.not_identifiable, *seen.not_identifiable}
    )
    verdict: GapVerdict = diagnosis.verdict if stated or acts else "untested"
    sentence = diagnosis.sentence if acts else sentence_of(axis, verdict, stated)
    return replace(
        diagnosis,
        verdict=verdict,
        sentence=sentence if verdict == "untested" else as_sure(sentence, answers_of(diagnosis.evidence)),
        derivatives=stated,
        instruments={name: Value(*value) for name, value in model.nuisances.items()},
        not_identifiable=model.not_identifiable,
        structured=seen.structured,
    )


def sentence_of(axis: Axis, verdict: GapVerdict, derivatives: Sequence[ComparedDerivative]) -> str:
    """Return the sentence of the report for an answer without an effect."""
    if verdict == "untested":
        return (
            f"The aircraft file states no derivative of {axis.name} that the flight determines: give "
            f"model.{axis.example} and others."
        )
    if verdict == "none":
        return f"The simulator's derivatives of {axis.name} agree with the flight's; no effect is missing."
    wrong = [derivative.name for derivative in derivatives if derivative.differs]
    listed = f": {', '.join(wrong)}" if wrong else " together, though none alone"
    return f"The simulator's derivatives of {axis.name} differ from the flight's{listed}."
