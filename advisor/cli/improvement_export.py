"""``--export FORMAT:FILE``: the improvement in other simulators' formats."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from advisor.aircraft.aircraft import Aircraft
from advisor.cli.options import refuse_unwritable
from advisor.words.printable import printable
from advisor.words.problems import ConfigurationError

if TYPE_CHECKING:
    from advisor.campaign.state import CampaignState
    from advisor.exports.models.write import ExportOrder, ExportOutcome
    from advisor.gap.result import Diagnosis

F = TypeVar("F", bound=Callable[..., Any])


def export_option(
    what: str = "Write the improvement as jsbsim, ardupilot, sdf, matlab or aircraft; repeatable.",
) -> Callable[[F], F]:
    """Return a decorator that adds the option ``--export FORMAT:FILE``, repeatable, as ``exports``."""
    return click.option("--export", "exports", multiple=True, metavar="FORMAT:FILE", help=what)


def orders_of(
    exports: Sequence[str], aircraft: Aircraft, inputs: Sequence[Path | None], *, of_flight: bool = False
) -> "list[ExportOrder]":
    """Read and check all orders before any work.

    Parameters
    ----------
    inputs
        Files that the command reads, or that another option writes. No order may name one of them.
    of_flight
        Whether the model of a flight is written instead of a diagnosis.

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
        if order.file.resolve() in taken:
            raise ConfigurationError(
                f"--export: {order.file} is read or written by this call already; name another file."
            )
        refuse(order, aircraft, of_flight)
        taken.add(order.file.resolve())
        orders.append(order)
    return orders


def write_exports(
    orders: "list[ExportOrder]", found: "Diagnosis", aircraft: Aircraft
) -> "list[ExportOutcome]":
    """Carry out the orders, and print the result of each on standard error."""
    if not orders:
        return []
    from advisor.exports.models.write import carry_out

    return _said(carry_out(orders, found, aircraft))


def write_flown_model(orders: "list[ExportOrder]", state: "CampaignState", aircraft: Aircraft) -> None:
    """Write the model of a flight into each file, and print the result of each on standard error.

    Raises
    ------
    ConfigurationError
        The flight tells the derivatives of neither axis.
    """
    if orders:
        from advisor.exports.models.flown import flown_model
        from advisor.exports.models.write import write_flown

        _said(write_flown(orders, flown_model(state, aircraft), aircraft))


def _said(outcomes: "list[ExportOutcome]") -> "list[ExportOutcome]":
    for one in outcomes:
        missing = f"; it does not carry: {', '.join(one.left_out)}" if one.left_out else ""
        click.echo(
            one.problem or f"{printable(str(one.order.file))}: written ({one.order.format}){missing}.",
            err=True,
        )
    return outcomes


def listed(outcomes: "Sequence[ExportOutcome]") -> list[dict[str, Any]]:
    """Return the value of ``exports`` in the JSON document: the files written."""
    return [
        {"format": one.order.format, "file": str(one.order.file), "left_out": list(one.left_out)}
        for one in outcomes
        if not one.problem
    ]
