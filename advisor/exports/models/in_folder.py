"""The model of a flight in several formats, in one folder: a file named as its format."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from advisor.aircraft.aircraft import Aircraft
from advisor.campaign.state import CampaignState
from advisor.exports.models.flown import flown_model
from advisor.exports.models.formats import format_named
from advisor.exports.models.write import ExportOrder, carry_out, refuse
from advisor.words.problems import ConfigurationError


def refuse_models(names: Sequence[str], folder: Path, aircraft: Aircraft) -> None:
    """Refuse, before the analysis, formats that could not be written after it.

    Raises
    ------
    ConfigurationError
        The aircraft file lacks what a format needs.
    """
    for order in _orders(names, folder):
        refuse(order, aircraft, "both")


def write_models(
    names: Sequence[str], folder: Path, state: CampaignState, aircraft: Aircraft
) -> Iterator[str]:
    """Write the model of a flight; yield what a format does not carry, or why there is no file."""
    try:
        outcomes = carry_out(list(_orders(names, folder)), flown_model(state, aircraft))
    except ConfigurationError as error:
        yield str(error)
        return
    for one in outcomes:
        if one.problem or one.left_out:
            yield one.problem or f"{one.order.file.name} does not carry: {', '.join(one.left_out)}."


def _orders(names: Sequence[str], folder: Path) -> Iterator[ExportOrder]:
    for name in names:
        yield ExportOrder(name, folder / f"{name}{format_named(name).suffix}")
