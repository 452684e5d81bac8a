"""Roll and yaw for other programs, from logs and from a diagnosis of them, and their proof."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import SIDE_PARAMETERS
from advisor.analysis.side_gap import SideCompared, accepted_of, answered, with_derivatives
from advisor.analysis.whole_flights import read_whole
from advisor.exports.models.flown import FlownModel, SideModel, flown_model, side_flown, side_of
from advisor.exports.models.improvement import ExportedServo, servo_of
from advisor.exports.models.proof import Proof, parted, refuse_unimproved
from advisor.exports.models.proved_finding import NUMBERS
from advisor.flight.instruments.atmosphere import air_flown
from advisor.flight.maneuvers.events import SideManeuverFlown
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.maneuvers.marks import Mark
from advisor.flight.signals.messages import FloatArray
from advisor.flight.stream.stream import FlightStream
from advisor.gap.alternative import Alternative
from advisor.gap.effects import EFFECTS
from advisor.gap.inference.posterior import PARAMETERS
from advisor.gap.inference.prior import FIELD, FieldPrior
from advisor.gap.result import IMPROVING
from advisor.mavlink.logs.whole import read_whole_log
from advisor.model.lateral import LATERAL
from advisor.oem.estimate import NoEstimate
from advisor.oem.lateral_estimate import LateralEstimate
from advisor.oem.lateral_estimator import estimate_lateral
from advisor.oem.lateral_prediction import predicted_lateral
from advisor.side_gap.comparison import compare_side, sentence_of_side
from advisor.side_gap.diagnosis import SideDiagnosis
from advisor.simulators.contradicted import handed_over
from advisor.simulators.taken_back import taken_back_said, unused
from advisor.words.certainty import as_sure
from advisor.words.problems import UnusableInputError

_Found = TypeVar("_Found")


def side_of_logs(
    logs: Sequence[Path],
    aircraft: Aircraft,
    target_system: int | None = None,
    marks: Sequence[Mark] = (),
    no_marks: bool = False,
) -> SideModel | None:
    """Return roll and yaw as the accepted manoeuvres of logs tell them; None where they tell none.

    The whole campaign is judged only where aileron or rudder were flown.
    """
    try:
        if not any(_flies_roll_or_yaw(log, aircraft, target_system, marks) for log in logs):
            return None
        flights = read_whole(logs, aircraft, target_system, marks, no_marks=no_marks, axis="lateral")
    except UnusableInputError:
        return None
    return side_flown(flights.state.lateral, aircraft)


def _flies_roll_or_yaw(
    log: Path, aircraft: Aircraft, target_system: int | None, marks: Sequence[Mark]
) -> bool:
    stream = FlightStream(aircraft, target_system, marks, lateral=True)
    events = [event for columns in read_whole_log(log) for event in stream.feed(columns)]
    return any(isinstance(event, SideManeuverFlown) for event in (*events, *stream.finish()))


def improved_side(compared: SideCompared) -> FlownModel:
    """Return both axes of a flight whose roll and yaw were diagnosed, with the servos that were found.

    Derivatives are estimated anew behind a servo that the diagnosis changed.
    """
    aircraft, state = compared.aircraft, compared.state
    model = flown_model(state, aircraft)
    unchanged = compared.gap.verdict not in IMPROVING
    found = _servos_found(compared.gap.diagnosis, aircraft)
    if model.side is None or not found:
        return replace(model, unchanged=unchanged)
    behind = _behind(found, aircraft)
    again = estimate_lateral(accepted_of(state), behind)
    side = model.side
    if not isinstance(again, NoEstimate):
        side = side_of(again, side.trim, side.air, behind)
    return replace(model, side=replace(side, servos={**side.servos, **found}), unchanged=unchanged)


def behind_found(diagnosis: SideDiagnosis | None, aircraft: Aircraft) -> Aircraft:
    """Return the aircraft with the lag and delay of each servo that a diagnosis found."""
    return _behind(_servos_found(diagnosis, aircraft), aircraft)


def _behind(found: Mapping[str, ExportedServo], aircraft: Aircraft) -> Aircraft:
    changed: dict[str, Any] = {
        name: replace(getattr(aircraft, name), lag_s=servo.lag_s, delay_s=servo.delay_s)
        for name, servo in found.items()
    }
    return replace(aircraft, **changed)


def _servos_found(diagnosis: SideDiagnosis | None, aircraft: Aircraft) -> Mapping[str, ExportedServo]:
    """Return the servo of each control at which the diagnosis found an effect."""
    effects: dict[str, dict[str, Mapping[str, float]]] = {}
    for one in diagnosis.causes if diagnosis is not None else ():
        if one.cause.present and one.of in LATERAL.inputs and EFFECTS[one.cause.effect].servo:
            sizes = {name: value.value for name, value in one.cause.parameters.items()}
            effects.setdefault(one.of, {})[one.cause.effect] = sizes
    return {name: servo_of(getattr(aircraft, name), by_effect) for name, by_effect in effects.items()}


def prove_side(
    compared: SideCompared, fresh: Sequence[Maneuver] | None = None, prior: FieldPrior = FIELD
) -> Proof:
    """Improve roll and yaw by some manoeuvres, and fly others.

    Parameters
    ----------
    compared
        The comparison of the whole flight.
    fresh
        Manoeuvres of other logs; None keeps the last third apart.

    Raises
    ------
    UnusableInputError
        There are too few manoeuvres, nothing was improved, or the fit does not fly every control.
    """
    aircraft = compared.against
    fitted, kept = (compared.maneuvers, fresh) if fresh is not None else parted(compared.maneuvers)
    first = _flown(compare_side(fitted, aircraft, prior))
    refuse_unimproved(first.verdict in IMPROVING, first.sentence, len(fitted))
    behind = behind_found(first.diagnosis, aircraft)
    plain, found = (_flown(estimate_lateral(fitted, one)) for one in (aircraft, behind))
    given = np.array([aircraft.model.get(n, x) for n, x in zip(SIDE_PARAMETERS, plain.theta, strict=True)])
    present = tuple(
        one.name for one in (first.diagnosis.causes if first.diagnosis else ()) if one.cause.present
    )

    def flown(model: LateralEstimate, against: Aircraft, theta: FloatArray) -> list[float]:
        return [_gap(m, model, against, theta) for m in kept]

    before, every = flown(plain, aircraft, given), flown(found, behind, found.theta)
    after: list[float] = every
    stays: tuple[LateralEstimate, Aircraft] | None = (found, behind)
    taken: tuple[str, ...] = ()
    if np.mean(every) >= np.mean(before):
        by_numbers = flown(plain, aircraft, plain.theta)
        none = before, None, (*present, NUMBERS)
        tried = [none, (by_numbers, (plain, aircraft), present)] if present else [none]
        after, stays, taken = min(tried, key=lambda one: float(np.mean(one[0])))
    improved = aircraft
    if stays is not None:
        speed = stays[0].airspeed_m_s
        read = None if speed is None else air_flown(fitted).read_speed(speed)
        improved = with_derivatives(stays[1], stays[0], read)
    second = _flown(compare_side(kept, improved, prior))
    return Proof(
        maneuvers=tuple(m.number for m in kept),
        before=float(np.mean(before)),
        after=float(np.mean(after)),
        floor={name: fit.noise for name, fit in found.fits[0].items()},
        by_maneuver=tuple((m.number, b, a) for m, b, a in zip(kept, before, after, strict=True)),
        first=" + ".join(present) or str(first.verdict),
        second=second.verdict,
        sentence=second.sentence,
        taken_back=taken,
        gap_with_them=float(np.mean(every)) if taken else None,
    )


def stays_of_side(compared: SideCompared, proof: Proof | None) -> SideCompared:
    """Return a comparison without the parts that a proof took back, which its sentence names.

    The probability of an effect goes to the numbers, where they stay, or else to the unknown in its place.
    """
    gap, d = compared.gap, compared.gap.diagnosis
    if proof is None or proof.gap_with_them is None or d is None or d.answer is None:
        return compared
    words = [one.replace("_", " ") for one in proof.taken_back]
    said = taken_back_said(words, unused(proof.maneuvers), proof.gap_with_them, proof.after)
    stays = PARAMETERS
    if NUMBERS in proof.taken_back:
        place = d.causes[0].block if d.answer.is_effect and d.causes else "rolling_moment"
        stays = Alternative("unknown", "unknown", place)
    evidence = handed_over(d.evidence, d.answer, stays)
    causes = tuple(replace(one, cause=replace(one.cause, present=False)) for one in d.causes)
    d = replace(d, evidence=evidence, answer=stays, causes=causes, why=(), rival="", decisions=())
    derivatives = gap.derivatives if stays == PARAMETERS else ()
    lead = sentence_of_side(d.verdict, derivatives) if stays == PARAMETERS else d.sentence
    sentence = f"{as_sure(lead, d.answers)} {said}"
    found = replace(gap, verdict=d.verdict, sentence=sentence, derivatives=derivatives, diagnosis=d)
    return replace(compared, gap=found)


def _gap(maneuver: Maneuver, model: LateralEstimate, aircraft: Aircraft, theta: FloatArray) -> float:
    """Return the mean over outputs of the mean square of the error over that of the noise, minus 1, at least
    0."""
    fits = predicted_lateral(maneuver, model, aircraft, theta)
    if isinstance(fits, NoEstimate):
        return 0.0
    return float(np.mean([max(0.0, (fit.rms / fit.noise) ** 2 - 1.0) for fit in fits.values()]))


def _flown(found: _Found | NoEstimate) -> _Found:
    """Return an answer, or refuse manoeuvres that gave none."""
    return answered(found, "Fly aileron and rudder in both parts of the flight.", "--prove: ")
