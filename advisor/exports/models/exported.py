"""Text of a file, with the parts of the improvement that its format does not support."""

import re
from dataclasses import dataclass

from advisor.exports.models.improvement import Improvement
from advisor.gap.result import spelled


@dataclass(frozen=True)
class Exported:
    """Content of one file before it is written."""

    text: str
    left_out: tuple[str, ...] = ()
    """Names of effects in sentences that the text does not contain."""
    beside: tuple[str, ...] = ()
    """Texts of additional files that the format writes next to this file."""


def effects_beside(improvement: Improvement, *carried: str) -> tuple[str, ...]:
    """Return the effects that are neither servo effects nor supported by a format."""
    return tuple(spelled(effect) for effect in improvement.effects if effect not in carried)


def commented(lines: list[str], mark: str) -> str:
    """Return lines as a comment, each after the comment mark of a language."""
    return "".join(f"{mark} {line}".rstrip() + "\n" for line in lines)


def xml_comment(text: str) -> str:
    """Return an XML comment, which cannot contain two successive hyphens."""
    return f"<!-- {re.sub('-(?=-)', '- ', text)} -->"
