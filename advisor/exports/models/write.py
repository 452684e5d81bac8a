"""Execution of an export order: format, requirements, and the writing of the file."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from advisor.aircraft.aircraft import Aircraft
from advisor.campaign.state import CampaignState
from advisor.exports.models.flown import FlownModel, flown_model
from advisor.exports.models.formats import AxisAsked, format_named
from advisor.exports.models.names import NAMES
from advisor.process.atomic_file import write_atomically
from advisor.process.parts import FailedPart, attempt
from advisor.words.problems import ConfigurationError

NOTHING = "there is nothing to improve"


@dataclass(frozen=True)
class ExportOrder:
    """Order for one export file."""

    format: str
    file: Path

    @property
    def files(self) -> tuple[Path, ...]:
        """Ordered file, and all files that the format writes next to it."""
        return format_named(self.format).files(self.file)


@dataclass(frozen=True)
class ExportOutcome:
    """Result of one export order."""

    order: ExportOrder
    left_out: tuple[str, ...] = ()
    """Parts of the model that the format does not support."""
    problem: str = ""
    """Reason why the file was not written; empty for a written file."""


def order_of(text: str) -> ExportOrder:
    """Return the order in ``FORMAT:FILE``.

    Raises
    ------
    ConfigurationError
        The format is unknown, or the file is missing.
    """
    name, colon, file = text.partition(":")
    if name not in NAMES:
        raise ConfigurationError(f"--export: {name!r} is none of the formats {', '.join(NAMES)}.")
    if not colon or not file:
        raise ConfigurationError(f"--export {name}: name the file behind a colon, as in {name}:FILE.")
    return ExportOrder(name, Path(file))


def refuse(order: ExportOrder, aircraft: Aircraft, axis: AxisAsked) -> None:
    """Refuse, before the analysis, an export that would fail afterwards.

    Raises
    ------
    ConfigurationError
        The aircraft file lacks required keys, or the file's ending is not supported.
    """
    format_named(order.format).refuse(order.file, aircraft, axis)


def carry_out(orders: Sequence[ExportOrder], model: FlownModel) -> list[ExportOutcome]:
    """Write each ordered file atomically. The failure of one file does not affect the others."""
    return [_outcome(order, partial(_carried_out, order, model)) for order in orders]


def _outcome(order: ExportOrder, carry: Callable[[], ExportOutcome]) -> ExportOutcome:
    try:
        made = attempt(f"export {order.format}", carry)
        return ExportOutcome(order, problem=made.sentence) if isinstance(made, FailedPart) else made
    except ConfigurationError as error:
        return ExportOutcome(order, problem=str(error))
    except OSError as error:
        reason = error.strerror or str(error)
        return ExportOutcome(order, problem=f"--export: {order.file} was not written: {reason}.")


def _carried_out(order: ExportOrder, model: FlownModel) -> ExportOutcome:
    writer = format_named(order.format)
    if writer.needs_a_finding and model.unchanged:
        return ExportOutcome(order, problem=f"--export: {order.file} was not written: {NOTHING}.")
    made = writer.made(model, order.file)
    for file, text in zip(order.files, (made.text, *made.beside), strict=True):
        write_atomically(file, text)
    return ExportOutcome(order, made.left_out)


def refuse_models(names: Sequence[str], folder: Path, aircraft: Aircraft) -> None:
    """Refuse, before the analysis, formats that could not be written afterwards.

    Raises
    ------
    ConfigurationError
        The aircraft file lacks keys that a format requires.
    """
    for order in _orders(names, folder):
        refuse(order, aircraft, "both")


def write_models(
    names: Sequence[str], folder: Path, state: CampaignState, aircraft: Aircraft
) -> Iterator[str]:
    """Write the model of a flight, and yield sentences about unsupported parts or missing files."""
    try:
        outcomes = carry_out(list(_orders(names, folder)), flown_model(state, aircraft))
    except ConfigurationError as error:
        yield str(error)
        return
    for each in outcomes:
        if each.problem or each.left_out:
            yield (each.problem or f"{each.order.file.name} does not carry: {', '.join(each.left_out)}.")


def _orders(names: Sequence[str], folder: Path) -> Iterator[ExportOrder]:
    for name in names:
        yield ExportOrder(name, folder / f"{name}{format_named(name).suffix}")
