"""``advisor gap --figure``: the picture of a diagnosis as a file."""

from collections.abc import Callable, Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from advisor.cli.options import refuse_unwritable, writing
from advisor.words.problems import ConfigurationError

_FORMATS = (".svg", ".png")


def refuse_figure(figure: Path | None, others: Sequence[Path | None]) -> None:
    """Refuse, before any work, a picture that could not be drawn or written.

    Raises
    ------
    ConfigurationError
        The ending names no picture, matplotlib is missing, or the file is also an input or output of the
        command.
    """
    if figure is None:
        return
    if figure.suffix.lower() not in _FORMATS:
        raise ConfigurationError(f"--figure: {figure} ends in neither .svg nor .png; name such a file.")
    if find_spec("matplotlib") is None:
        raise ConfigurationError("--figure needs matplotlib: pip install 'inflight-advisor[report]'.")
    refuse_unwritable("--figure", figure)
    if any(other is not None and other.resolve() == figure.resolve() for other in others):
        raise ConfigurationError(f"--figure: {figure} is another file of this command; name a new one.")


def write_figure(figure: Path | None, document: Callable[[], Mapping[str, Any]]) -> None:
    """Write the picture of an axis's document, if one is wanted.

    Raises
    ------
    ConfigurationError
        The file cannot be written.
    """
    if figure is None:
        return
    from advisor.report.page.gap_picture import write_gap_picture

    with writing("--figure", figure):
        write_gap_picture(document(), figure)
