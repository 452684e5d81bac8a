"""``--export FORMAT:FILE``: the improvement in other simulators' formats."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from advisor.aircraft.aircraft import Aircraft
from advisor.cli.options import refuse_unwritable
from advisor.words.problems import ConfigurationError, printable

if TYPE_CHECKING:
    from advisor.exports.models.flown import FlownModel
    from advisor.exports.models.formats import AxisAsked
    from advisor.exports.models.write import ExportOrder, ExportOutcome

F = TypeVar("F", bound=Callable[..., Any])


def export_option(
    what: str = "Write both axes, improved, as jsbsim, ardupilot, matlab or aircraft; repeatable.",
) -> Callable[[F], F]:
    """Return a decorator that adds the option ``--export FORMAT:FILE``, repeatable, as ``exports``."""
    return click.option("--export", "exports", multiple=True, metavar="FORMAT:FILE", help=what)


def orders_of(
    exports: Sequence[str], aircraft: Aircraft, inputs: Sequence[Path | None], axis: "AxisAsked"
) -> "list[ExportOrder]":
    """Read and check all orders before any work.

    Parameters
    ----------
    inputs
        Files that the command reads, or that another option writes; no order may name such a file.

    Raises
    ------
    ConfigurationError
        An order cannot be carried out.
    """
    if not exports:
        return []
    from advisor.exports.models.write import order_of, refuse

    taken = {path.resolve() for path in inputs if path is not None}
    orders = []
    for text in exports:
        order = order_of(text)
        refuse_unwritable("--export", order.file)
        refuse(order, aircraft, axis)
        for file in order.files:
            if file.resolve() in taken:
                raise ConfigurationError(
                    f"--export: {file} is already read or written by this command; name another file."
                )
            taken.add(file.resolve())
        orders.append(order)
    return orders


def write_exports(
    orders: "list[ExportOrder]", make_model: "Callable[[], FlownModel]"
) -> "list[ExportOutcome]":
    """Carry out the orders, and print the result of each on standard error."""
    if not orders:
        return []
    from advisor.exports.models.write import ExportOutcome, carry_out

    try:
        return _said(carry_out(orders, make_model()))
    except ConfigurationError as error:
        click.echo(str(error), err=True)
        return [ExportOutcome(order, problem=str(error)) for order in orders]


def _said(outcomes: "list[ExportOutcome]") -> "list[ExportOutcome]":
    for outcome in outcomes:
        missing = f"; it does not carry: {', '.join(outcome.left_out)}" if outcome.left_out else ""
        files = ", ".join(printable(str(file)) for file in outcome.order.files)
        click.echo(outcome.problem or f"{files}: written ({outcome.order.format}){missing}.", err=True)
    return outcomes


def listed(outcomes: "Sequence[ExportOutcome]") -> list[dict[str, Any]]:
    """Return the value of ``exports`` in the JSON document: the files written."""
    return [
        {"format": outcome.order.format, "file": str(file), "left_out": list(outcome.left_out)}
        for outcome in outcomes
        if not outcome.problem
        for file in outcome.order.files
    ]
