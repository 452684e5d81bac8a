"""Agreement of the derivatives from a comparison with a user's simulator with the estimate of the same
log."""

from dataclasses import replace

from advisor.gap.result import Diagnosis, Value
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.words.quantities import PARAMETERS


def agreeing(diagnosis: Diagnosis, logged: Estimate | NoEstimate) -> Diagnosis:
    """Return a diagnosis whose derivatives agree with an estimate within their 95 % intervals.

    The estimate is made without a simulator. A significant difference between two analyses of one log is a
    lower bound of both errors. A derivative whose wider interval contains the simulator's value is not stated
    as changed.

    Parameters
    ----------
    logged
        Estimate from all manoeuvres together, as logged.
    """
    if isinstance(logged, NoEstimate):
        return diagnosis
    estimated = zip(logged.names, logged.theta.tolist(), logged.std.tolist(), strict=True)
    others = {name: Value(x, std) for name, x, std in estimated if name not in logged.not_identifiable}
    shared = [derivative.name for derivative in diagnosis.derivatives if derivative.name in others]
    model = {**diagnosis.model, **{name: diagnosis.model[name].agreeing(others[name]) for name in shared}}
    wider = [PARAMETERS[name].symbol for name in shared if model[name] != diagnosis.model[name]]
    derivatives = tuple(
        replace(derivative, found=model[derivative.name]) for derivative in diagnosis.derivatives
    )
    said = f"The intervals of {', '.join(wider)} contain those of advisor analyze, which lie elsewhere."
    notes = (*diagnosis.notes, *([said] if wider else []))
    return replace(diagnosis, model=model, derivatives=derivatives, notes=notes)
