"""Roll and yaw for other programs, from logs and from a diagnosis of them, and their proof."""

import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.controls import SideControl
from advisor.aircraft.reference import SIDE_PARAMETERS
from advisor.analysis.side_gap import (
    SideCompared,
    accepted_of,
    answered,
    beside_simulator,
    with_derivatives,
)
from advisor.analysis.whole_flights import read_whole
from advisor.exports.models.flown import FlownModel, SideModel, flown_model, side_flown, side_of
from advisor.exports.models.formats.jsbsim_format import FORMAT as JSBSIM
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
from advisor.gap.axes.lateral.comparison import compare_side, sentence_of_side
from advisor.gap.axes.lateral.diagnosis import SideDiagnosis
from advisor.gap.effects import EFFECTS
from advisor.gap.inference.posterior import PARAMETERS
from advisor.gap.inference.prior import FIELD, FieldPrior
from advisor.gap.result import IMPROVING
from advisor.mavlink.logs.whole import read_whole_log
from advisor.model.axes.lateral import LATERAL
from advisor.oem.axes.lateral.estimate import LateralEstimate
from advisor.oem.axes.lateral.estimator import estimate_lateral
from advisor.oem.axes.lateral.prediction import predicted_lateral
from advisor.oem.estimate import NoEstimate
from advisor.simulators.contradicted import handed_over
from advisor.simulators.flying import Progress
from advisor.simulators.taken_back import taken_back_said, unused
from advisor.words.certainty import as_sure
from advisor.words.problems import UnusableInputError
from advisor.words.quantiles import NORMAL_95

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
    compared: SideCompared,
    fresh: Sequence[Maneuver] | None = None,
    prior: FieldPrior = FIELD,
    progress: Progress = lambda *_: None,
) -> Proof:
    """Improve roll and yaw of the simulator by some manoeuvres, and fly others.

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
    given = compared.aircraft
    fitted, kept = (compared.maneuvers, fresh) if fresh is not None else parted(compared.maneuvers)
    fitted, against = beside_simulator(fitted, given, progress)
    first = _flown(compare_side(fitted, against, prior))
    refuse_unimproved(first.verdict in IMPROVING, first.sentence, len(fitted))
    behind = behind_found(first.diagnosis, against)
    plain, found = (_flown(estimate_lateral(fitted, one)) for one in (against, behind))
    present = tuple(
        one.name for one in (first.diagnosis.causes if first.diagnosis else ()) if one.cause.present
    )

    def flown(model: LateralEstimate, simulator: Aircraft) -> _OnKept:
        seen, there = beside_simulator(kept, simulator, progress)
        theta = np.array([there.model.get(n, x) for n, x in zip(SIDE_PARAMETERS, model.theta, strict=True)])
        return _OnKept(seen, there, [_gap(m, model, there, theta) for m in seen])

    with tempfile.TemporaryDirectory() as folder:

        def improved(model: LateralEstimate, servos: Aircraft) -> tuple[Aircraft, tuple[str, ...]]:
            return _improved(model, against, servos, compared, fitted, Path(tempfile.mkdtemp(dir=folder)))

        better, left = improved(found, behind)
        before, every = flown(plain, given), flown(found, better)
        after = every
        taken: tuple[str, ...] = ()
        if every.gap > before.gap:
            after, taken = before, (*present, NUMBERS)
            by_numbers = flown(plain, improved(plain, against)[0]) if present else before
            if by_numbers.gap < before.gap:
                after, taken = by_numbers, present
    second = _flown(compare_side(after.maneuvers, after.against, prior))
    pairs = zip(kept, before.gaps, after.gaps, strict=True)
    return Proof(
        maneuvers=tuple(m.number for m in kept),
        before=before.gap,
        after=after.gap,
        floor={name: fit.noise for name, fit in found.fits[0].items()},
        by_maneuver=tuple((m.number, was, now) for m, was, now in pairs),
        first=" + ".join(present) or str(first.verdict),
        second=second.verdict,
        sentence=second.sentence,
        not_carried=left,
        taken_back=taken,
        gap_with_them=every.gap if taken else None,
    )


@dataclass(frozen=True)
class _OnKept:
    """The manoeuvres kept apart next to a simulator."""

    maneuvers: Sequence[Maneuver]
    """Manoeuvres without the difference of the simulator to its surrogate."""
    against: Aircraft
    gaps: Sequence[float]
    """Gap of each manoeuvre."""

    @property
    def gap(self) -> float:
        """Mean over the manoeuvres."""
        return float(np.mean(self.gaps))


def _improved(
    found: LateralEstimate,
    against: Aircraft,
    servos: Aircraft,
    compared: SideCompared,
    fitted: Sequence[Maneuver],
    folder: Path,
) -> tuple[Aircraft, tuple[str, ...]]:
    """Return the aircraft file with the improved simulator, and the parts that the simulator cannot take.

    Parameters
    ----------
    found
        Estimate behind ``servos``.
    against, servos
        The aircraft file of the surrogate, and that with the servos that were found.
    """
    given = compared.aircraft
    kind, _, _ = (given.simulator or "linear").partition(":")
    if kind in ("linear", "log"):
        speed = found.airspeed_m_s
        read = None if speed is None else air_flown(fitted).read_speed(speed)
        return replace(with_derivatives(servos, found, read), simulator="linear"), ()
    ahead: dict[str, Any] = {
        name: _ahead(*(getattr(one, name) for one in (given, against, servos))) for name in LATERAL.inputs
    }
    better = replace(given, **ahead)
    told = zip(SIDE_PARAMETERS, found.theta, found.std, strict=True)
    wrong = tuple(
        n for n, x, std in told if n in against.model and abs(x - against.model[n]) > NORMAL_95 * std
    )
    model = flown_model(compared.state, given) if kind == "jsbsim" else None
    if model is None or model.side is None:
        return better, wrong
    file = folder / f"{Path(str(given.simulator).partition(':')[2]).stem}.xml"
    side = replace(side_of(found, model.side.trim, model.side.air, servos), servos={})
    made = JSBSIM.made(replace(model, pitch=None, side=side), file)
    file.write_text(made.text, encoding="utf-8")
    return replace(better, simulator=f"jsbsim:{file}"), made.left_out


def _ahead(given: SideControl, against: SideControl, found: SideControl) -> SideControl:
    """Return the servo ahead of a simulator that has ``against`` behind ``given``, for ``found`` in all."""

    def less(name: str) -> float:
        first, own, whole = (getattr(one, name) or 0.0 for one in (given, against, found))
        return max(first + whole - own, 0.0)

    return given if found == against else replace(given, lag_s=less("lag_s"), delay_s=less("delay_s"))


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
