"""Formats of a model, with one class per file, each imported only when used."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import Literal

from advisor.aircraft.aircraft import Aircraft
from advisor.exports.models.flown import FlownModel
from advisor.exports.models.improvement import Exported
from advisor.words.problems import ConfigurationError

AxisAsked = Literal["pitch", "lateral", "both"]
"""Axes that a command exports: one axis of a diagnosis, or both axes of an analysis."""


class ModelFormat(ABC):
    """Format of another program for a model. A new format is a subclass in a separate file."""

    suffix: str
    """Usual ending of the format's files."""
    needs_a_finding = False
    """Whether no file is written if a diagnosis found nothing."""

    def files(self, file: Path) -> tuple[Path, ...]:
        """Return the ordered file, and all files that the format writes next to it."""
        return (file,)

    def refuse(self, file: Path, aircraft: Aircraft, axis: AxisAsked) -> None:  # noqa: B027 - may be empty
        """Refuse, before the analysis, an export that would fail afterwards.

        Raises
        ------
        ConfigurationError
            The aircraft file lacks required keys, or the file's ending is not supported.
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
    """Return the format with a name in ``advisor.exports.models.names.NAMES``."""
    named: ModelFormat = import_module(f"advisor.exports.models.formats.{name}_format").FORMAT
    return named


def refuse_lacking(lacking: Sequence[Sequence[str]], name: str) -> None:
    """Refuse an aircraft file that lacks required keys for every axis.

    Raises
    ------
    ConfigurationError
        Every axis has missing keys. The error message names the shortest list of missing keys.
    """
    if all(lacking):
        missing = min(lacking, key=len)
        reference = [key for key in missing if "." not in key]
        listed = reference or missing
        where = "under reference: " if reference else ""
        what = "non-dimensional coefficients" if reference else "coefficients per full travel of the servo"
        raise ConfigurationError(
            f"The format {name} cannot be written: {what} need {', '.join(listed)}; "
            f"give {'them' if len(listed) > 1 else 'it'} {where}in the aircraft file."
        )
