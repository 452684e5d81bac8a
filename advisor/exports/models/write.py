"""From an order for a file to the file: its format, its needs, and the one place that writes."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from advisor.aircraft.aircraft import Aircraft
from advisor.exports.models import ardupilot, matlab, sdf
from advisor.exports.models.ardupilot_side import side_model_text
from advisor.exports.models.exported import Exported
from advisor.exports.models.flown import FlownModel
from advisor.exports.models.improvement import (
    REFERENCE_KEYS,
    Improvement,
    improvement_of,
    require_reference,
)
from advisor.exports.models.jsbsim.aircraft import aircraft_text
from advisor.exports.models.jsbsim.run import Model, model_of
from advisor.exports.models.jsbsim.side import side_text
from advisor.exports.models.matlab_side import both_axes_text
from advisor.gap.result import Diagnosis
from advisor.process.atomic_file import write_atomically
from advisor.process.parts import FailedPart, attempt
from advisor.report.improved import write_improved
from advisor.words.problems import ConfigurationError

FORMATS = ("jsbsim", "ardupilot", "sdf", "matlab", "aircraft")
SERVO_FILES = (".parm", ".param")
"""Endings of ArduPilot's parameter files."""
NOTHING = "no cause was named and no number found wrong"


@dataclass(frozen=True)
class ExportOrder:
    """One requested file."""

    format: str
    file: Path


@dataclass(frozen=True)
class ExportOutcome:
    """Result of an order."""

    order: ExportOrder
    left_out: tuple[str, ...] = ()
    """Parts of the improvement that the format does not carry."""
    problem: str = ""
    """Reason for which the file was not written; empty for a written file."""


def order_of(text: str) -> ExportOrder:
    """Read ``FORMAT:FILE``.

    Raises
    ------
    ConfigurationError
        The format is unknown, or the file is missing.
    """
    name, colon, file = text.partition(":")
    if name not in FORMATS:
        raise ConfigurationError(f"--export: {name!r} is none of the formats {', '.join(FORMATS)}.")
    if not colon or not file:
        raise ConfigurationError(f"--export {name}: name the file behind a colon, as in {name}:FILE.")
    return ExportOrder(name, Path(file))


def refuse(order: ExportOrder, aircraft: Aircraft, of_flight: bool = False) -> None:
    """Refuse, before the analysis, an order that could not be carried out after it.

    Parameters
    ----------
    of_flight
        Whether the model of a flight is written instead of a diagnosis.

    Raises
    ------
    ConfigurationError
        The aircraft file lacks what the format needs, or the file's ending fits no content.
    """
    if order.format == "sdf":
        require_reference(aircraft.reference, REFERENCE_KEYS)
    elif order.format == "jsbsim":
        model = _model(aircraft)
        if order.file.resolve() == model.file:
            raise ConfigurationError(
                f"--export jsbsim: {order.file} is the simulator's own aircraft; name another file."
            )
    elif order.format == "ardupilot" and order.file.suffix == ".json" and of_flight:
        require_reference(aircraft.reference, ("wing_area_m2", "span_m"))
    elif order.format == "ardupilot" and order.file.suffix == ".json":
        require_reference(aircraft.reference, REFERENCE_KEYS)
        ardupilot.elevator_line(aircraft.elevator)
    elif order.format == "ardupilot" and order.file.suffix not in SERVO_FILES:
        raise ConfigurationError(
            f"--export ardupilot: {order.file} must end in .json (coefficients) or .parm (servo)."
        )


def write_flown(orders: Sequence[ExportOrder], model: FlownModel, aircraft: Aircraft) -> list[ExportOutcome]:
    """Write the model of a flight into each file. The failure of one file does not hinder the others."""
    return [_outcome(order, partial(_flown, order, model, aircraft)) for order in orders]


def _flown(order: ExportOrder, model: FlownModel, aircraft: Aircraft) -> ExportOutcome:
    if order.format == "matlab":
        made = both_axes_text(model)
    elif order.format == "jsbsim" and model.side is not None:
        made = side_text(model.name, model.side, _model(aircraft))
    elif order.format == "ardupilot" and order.file.suffix == ".json" and model.side is not None:
        made = side_model_text(model.name, model.side, aircraft)
    else:
        without_side = order.format == "jsbsim" or order.file.suffix == ".json"
        text = "no derivatives of roll and yaw" if without_side else "written by advisor gap alone"
        return ExportOutcome(order, problem=f"--export: {order.file} was not written: {text}.")
    write_atomically(order.file, made.text)
    return ExportOutcome(order, made.left_out)


def carry_out(orders: Sequence[ExportOrder], diagnosis: Diagnosis, aircraft: Aircraft) -> list[ExportOutcome]:
    """Write each file as a whole. The failure of one file does not hinder the others."""
    return [_outcome(order, partial(_carried_out, order, diagnosis, aircraft)) for order in orders]


def _outcome(order: ExportOrder, carry: Callable[[], ExportOutcome]) -> ExportOutcome:
    try:
        made = attempt(f"export {order.format}", carry)
        return ExportOutcome(order, problem=made.told) if isinstance(made, FailedPart) else made
    except ConfigurationError as error:
        return ExportOutcome(order, problem=str(error))
    except OSError as error:
        reason = error.strerror or str(error)
        return ExportOutcome(order, problem=f"--export: {order.file} was not written: {reason}.")


def _carried_out(order: ExportOrder, diagnosis: Diagnosis, aircraft: Aircraft) -> ExportOutcome:
    if order.format in ("jsbsim", "aircraft") and diagnosis.verdict not in ("effect", "parameters"):
        return ExportOutcome(order, problem=f"--export: {order.file} was not written: {NOTHING}.")
    if order.format == "aircraft":
        write_improved(diagnosis, aircraft, order.file)
        return ExportOutcome(order)
    improvement = improvement_of(diagnosis, aircraft)
    if order.format == "jsbsim":
        made = aircraft_text(improvement, _model(aircraft))
    else:
        made = _maker(order)(improvement)
    write_atomically(order.file, made.text)
    return ExportOutcome(order, made.left_out)


def _maker(order: ExportOrder) -> Callable[[Improvement], Exported]:
    if order.format == "ardupilot" and order.file.suffix in SERVO_FILES:
        return ardupilot.servo_text
    makers: Mapping[str, Callable[[Improvement], Exported]] = {
        "ardupilot": ardupilot.model_text, "sdf": sdf.block_text, "matlab": matlab.script_text,
    }  # fmt: skip
    return makers[order.format]


def _model(aircraft: Aircraft) -> Model:
    """Return the user's JSBSim aircraft, from the specification of the simulator."""
    kind, _, what = (aircraft.simulator or "").partition(":")
    if kind != "jsbsim" or not what:
        raise ConfigurationError(
            "--export jsbsim corrects a JSBSim aircraft: give yours with simulator: jsbsim:MODEL in the "
            "aircraft file."
        )
    return model_of(what)
