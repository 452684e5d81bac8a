"""Comparison of a flight with the model of the aircraft file, or with no simulator at all."""

from collections.abc import Sequence

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.gap.diagnose import examine, without_simulator
from advisor.gap.inference.prior import FieldPrior
from advisor.gap.search.baseline import prior_derivatives
from advisor.simulators.compare import Compared
from advisor.simulators.flying import Progress
from advisor.simulators.static_errors import with_static_errors
from advisor.simulators.taken_back import with_unseen_shrink
from advisor.simulators.unseen import changes_something, unseen_of


def compare_to_file(
    maneuvers: Sequence[Maneuver],
    aircraft: Aircraft,
    holdout: int | None,
    progress: Progress,
    prior: FieldPrior,
) -> Compared:
    """Diagnose the gap of manoeuvres to the file's model, and measure its reduction on held-out manoeuvres.

    Raises
    ------
    UnusableInputError
        The manoeuvres cannot be used.
    """
    whole = stays = examine(maneuvers, aircraft, holdout, progress, prior)
    diagnosis = whole.diagnosis
    if prior_derivatives(aircraft) is None:
        diagnosis = without_simulator(diagnosis, aircraft)
    elif changes_something(diagnosis):
        progress("measuring the gap's reduction on held-out manoeuvres", 0.9)
        unseen = unseen_of(whole, holdout)
        if unseen is not None:
            stays = with_unseen_shrink(whole, unseen, aircraft)
            diagnosis = stays.diagnosis
    return Compared(with_static_errors(diagnosis, whole), aircraft, stays.findings)
