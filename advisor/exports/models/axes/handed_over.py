"""Roll and yaw model for other programs, from logs and from their diagnosis."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis.axis_flown import SideCompared, accepted_of, flies_roll_or_yaw
from advisor.analysis.whole_flights import read_whole
from advisor.exports.models.flown import FlownModel, SideModel, flown_model, side_flown, side_of
from advisor.exports.models.improvement import ExportedServo, servo_of
from advisor.flight.maneuvers.marks import Mark
from advisor.gap.effects import EFFECTS
from advisor.gap.result import Cause, Diagnosis
from advisor.model.axes.lateral import LATERAL
from advisor.oem.axis.estimator import estimate_axis
from advisor.oem.estimate import NoEstimate
from advisor.words.problems import UnusableInputError


def side_of_logs(
    logs: Sequence[Path],
    aircraft: Aircraft,
    target_system: int | None = None,
    marks: Sequence[Mark] = (),
    no_marks: bool = False,
) -> SideModel | None:
    """Return the roll and yaw model from accepted manoeuvres in logs; None if the manoeuvres determine no
    model.

    The whole campaign is analysed only if aileron or rudder were flown.
    """
    try:
        if not any(flies_roll_or_yaw(log, aircraft, target_system, marks) for log in logs):
            return None
        flights = read_whole(logs, aircraft, target_system, marks, no_marks=no_marks, axis="lateral")
    except UnusableInputError:
        return None
    return side_flown(flights.state.lateral, aircraft)


def improved_side(compared: SideCompared) -> FlownModel:
    """Return both axes' models after a diagnosis of roll and yaw, including the servos found.

    With an effect the derivatives are those of the diagnosis' own model. The diagnosis next to a user's
    simulator lacks what that simulator adds. The derivatives are then estimated again with the servos found.
    """
    aircraft, state, diagnosis = compared.aircraft, compared.state, compared.diagnosis
    model = flown_model(state, aircraft)
    present = [cause for cause in diagnosis.causes if cause.present]
    model = replace(model, unchanged=not diagnosis.improves)
    if model.side is None or not present:
        return model
    side, servos = model.side, _servos_found(diagnosis, aircraft)
    if aircraft.simulator in (None, "linear"):
        side = replace(side, values={name: diagnosis.model[name] for name in side.values})
    elif servos:
        behind = _behind(servos, aircraft)
        again = estimate_axis(LATERAL, accepted_of(state), behind)
        side = side if isinstance(again, NoEstimate) else side_of(again, side.trim, side.air, behind)
    beyond = tuple(cause.name.replace("_", " ") for cause in present if not _has_key(cause))
    return replace(model, side=replace(side, servos={**side.servos, **servos}, beyond_keys=beyond))


def _has_key(cause: Cause) -> bool:
    """Return whether the aircraft file has a key for a cause of roll and yaw, or needs none."""
    return cause.block == "air" or (cause.of in LATERAL.inputs and EFFECTS[cause.effect].stated is not None)


def behind_found(diagnosis: Diagnosis, aircraft: Aircraft) -> Aircraft:
    """Return the aircraft with the lag and delay of each servo that a diagnosis found."""
    return _behind(_servos_found(diagnosis, aircraft), aircraft)


def _behind(servos: Mapping[str, ExportedServo], aircraft: Aircraft) -> Aircraft:
    changed: dict[str, Any] = {
        name: replace(getattr(aircraft, name), lag_s=servo.lag_s, delay_s=servo.delay_s)
        for name, servo in servos.items()
    }
    return replace(aircraft, **changed)


def _servos_found(diagnosis: Diagnosis, aircraft: Aircraft) -> Mapping[str, ExportedServo]:
    """Return the servo of each control at which the diagnosis found an effect."""
    effects: dict[str, dict[str, Mapping[str, float]]] = {}
    for cause in diagnosis.causes:
        if cause.present and cause.of in LATERAL.inputs and EFFECTS[cause.effect].servo:
            sizes = {name: value.value for name, value in cause.parameters.items()}
            effects.setdefault(cause.of, {})[cause.effect] = sizes
    return {name: servo_of(getattr(aircraft, name), by_effect) for name, by_effect in effects.items()}
