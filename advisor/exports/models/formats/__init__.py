"""Formats of a model, one object a file, each imported only on use."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import Literal

from advisor.aircraft.aircraft import Aircraft
from advisor.exports.models.exported import Exported
from advisor.exports.models.flown import FlownModel
from advisor.words.problems import ConfigurationError

AxisAsked = Literal["pitch", "lateral", "both"]
"""Axis that a command answers for: a diagnosis of one, or the analysis of both."""


class ModelFormat(ABC):
    """A format of another program. A new one is a subclass in a file of its own."""

    suffix: str
    """Usual ending of its files."""
    needs_a_finding = False
    """Whether nothing is written where a diagnosis found nothing."""

    def files(self, file: Path) -> tuple[Path, ...]:
        """Return the ordered file, and those that are written next to it."""
        return (file,)

    def refuse(self, file: Path, aircraft: Aircraft, axis: AxisAsked) -> None:  # noqa: B027 - may be empty
        """Refuse, before the analysis, an order that could not be carried out after it.

        Raises
        ------
        ConfigurationError
            The aircraft file lacks what the format needs, or the file's ending fits no content.
        """

    @abstractmethod
    def made(self, model: FlownModel, file: Path) -> Exported:
        """Return the content of a file.

        Raises
        ------
        ConfigurationError
            The model cannot be written in this format.
        """


def format_named(name: str) -> ModelFormat:
    """Return the format of a name of ``advisor.exports.models.names.NAMES``."""
    found: ModelFormat = import_module(f"advisor.exports.models.formats.{name}_format").FORMAT
    return found


def refuse_lacking(lacking: Sequence[Sequence[str]], name: str) -> None:
    """Refuse an aircraft file that lacks keys for every one of several axes.

    Raises
    ------
    ConfigurationError
        No axis is without missing keys. The message names the fewest.
    """
    if all(lacking):
        missing = min(lacking, key=len)
        reference = [key for key in missing if "." not in key]
        listed = reference or missing
        where = "under reference: " if reference else ""
        what = "non-dimensional coefficients" if reference else "coefficients per full travel of the servo"
        raise ConfigurationError(
            f"--export {name}: {what} need {', '.join(listed)}; "
            f"give {'them' if len(listed) > 1 else 'it'} {where}in the aircraft file."
        )
