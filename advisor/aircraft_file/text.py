"""The text of a new aircraft file: known keys as values, unknown keys as comments with their cost."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from textwrap import wrap
from typing import Any

import yaml

from advisor.aircraft.key import Key
from advisor.aircraft_file.lacks import KEYS

_WIDTH = 100
"""Width of a comment line, in characters."""


@dataclass(slots=True)
class Draft:
    """Content of an aircraft file before it is written."""

    head: list[str] = field(default_factory=list)
    """Sentences at the beginning of the file."""
    values: dict[str, Any] = field(default_factory=dict)
    """Value of each key, by the key's path. The key ``elevator.outputs`` replaces output and calibration."""
    comments: dict[str, str] = field(default_factory=dict)
    """Source of each key's value, or the known facts instead of a value, by the key's path."""
    examples: dict[str, str] = field(default_factory=dict)
    """Example of a value in the comment of each key without a value, by the key's path."""
    needless: set[str] = field(default_factory=set)
    """Paths of keys that this aircraft does not need."""
    unsure: list[str] = field(default_factory=list)
    """Sentences on points that the user must check."""


def aircraft_text(draft: Draft) -> str:
    """Return the text of an aircraft file from its draft.

    Returns
    -------
    YAML that ``advisor.aircraft_file.read.parse_aircraft`` reads. A key without a value is a comment.
    """
    lines = [line for sentence in draft.head for line in _commented(sentence)]
    section, values = "", draft.values
    for key in KEYS:
        if key.path in draft.needless:
            continue
        within = key.path.rpartition(".")[0]
        if within != section:
            section = within
            # An empty section counts as left for later.
            lines += ["", f"{section}:"] if section else [""]
            if section == "elevator" and "elevator.outputs" in values:
                lines += _outputs(values["elevator.outputs"], draft.comments)
        if "elevator.outputs" in values and key.path in ("elevator.output", "elevator.calibration"):
            continue
        lines += _entry(key, "  " if section else "", draft)
    return "\n".join(lines) + "\n"


def _outputs(outputs: Sequence[Mapping[str, Any]], comments: Mapping[str, str]) -> list[str]:
    lines = _commented(comments.get("elevator.outputs", "Each output with its own calibration."), "  ")
    return [*lines, "  outputs:", *(f"    - {_inline(output)}" for output in outputs)]


def _entry(key: Key, indent: str, draft: Draft) -> list[str]:
    said, meaning = draft.comments.get(key.path, ""), key.meaning.replace("``", "")
    if key.path in draft.values:
        about, line = said or meaning.rstrip("."), f"{indent}{key.name}: {_inline(draft.values[key.path])}"
        beside = f"{line}  # {about}"
        return [beside] if len(beside) <= _WIDTH else [*_commented(about, indent), line]
    cost = f"Without it: {key.cost[0].lower()}{key.cost[1:]}" if key.cost else ""
    notes = [meaning, cost, said]
    lines = [line for note in notes if note for line in _commented(note, indent)]
    return [*lines, f"{indent}# {key.name}: {draft.examples.get(key.path, key.example)}"]


def _commented(sentence: str, indent: str = "") -> list[str]:
    return [f"{indent}# {line}" for line in wrap(sentence, _WIDTH - len(indent))]


def _inline(value: Any) -> str:
    """Return a value as one line of YAML."""
    text: str = yaml.safe_dump(
        value, default_flow_style=True, allow_unicode=True, width=10_000, sort_keys=False
    )
    return text.removesuffix("\n").removesuffix("...").strip()
