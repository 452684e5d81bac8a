"""Text of a file, with the parts of the improvement that its format cannot carry."""

import re
from dataclasses import dataclass

from advisor.exports.models.improvement import Improvement
from advisor.gap.result import spelled


@dataclass(frozen=True)
class Exported:
    """One file before it is written."""

    text: str
    left_out: tuple[str, ...] = ()
    """Names of effects, as people write them, that the text does not carry."""
    beside: tuple[str, ...] = ()
    """Texts of the further files that the format writes next to this one."""


def effects_beside(improvement: Improvement, *carried: str) -> tuple[str, ...]:
    """Return the effects other than those of the servo and those that a format carries."""
    return tuple(spelled(effect) for effect in improvement.effects if effect not in carried)


def commented(lines: list[str], mark: str) -> str:
    """Return lines as a comment, each behind the mark of a language."""
    return "".join(f"{mark} {line}".rstrip() + "\n" for line in lines)


def xml_comment(text: str) -> str:
    """Return a comment of XML, in which no two hyphens may meet."""
    return f"<!-- {re.sub('-(?=-)', '- ', text)} -->"
