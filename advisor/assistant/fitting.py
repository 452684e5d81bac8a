"""Documents shortened to a size that an assistant can read, with the address of each omitted part."""

import json
from collections.abc import Sequence
from typing import Any

from advisor.assistant.folders import RefusedError

MOST_BYTES = 20_000
"""Longest answer as sent, bytes: some 7,000 tokens, a small share of an assistant's context."""
_ENVELOPE_BYTES = 200
"""Largest size of the protocol's data around an answer's text, bytes, with the number of the request."""
_LEAST_BYTES = 200
"""Least size, bytes, to which a part of an answer is shortened. A part that would become smaller is
omitted."""
_ITEM_BYTES = 800
"""Least size of a list item, bytes: one manoeuvre with its verdict and reasons. Later items of the list are
omitted."""
_DIGITS = 7
"""Number of significant digits in an answer. A time of one hour thus keeps its milliseconds."""


def part_of(document: Any, path: str) -> Any:
    """Return a part of a document.

    Parameters
    ----------
    path
        Keys and list positions with dots between: ``lateral.maneuvers.2``. Empty: the whole document.

    Raises
    ------
    RefusedError
        The document has no such part.
    """
    part = document
    for step in filter(None, path.split(".")):
        if isinstance(part, dict) and step in part:
            part = part[step]
        elif isinstance(part, list) and step.isdigit() and int(step) < len(part):
            part = part[int(step)]
        else:
            there = ", ".join(part) if isinstance(part, dict) else f"0 to {len(part) - 1}"
            if not isinstance(part, dict | list) or not part:
                there = "nothing"
            raise RefusedError(f"There is no part {path}: at {step} there are {there}.")
    return part


def written(document: Any, path: str = "", without: Sequence[str] = ()) -> str:
    """Return a document, or its part at ``path``, as JSON of at most ``MOST_BYTES``.

    The largest parts of the document are shortened first. A sentence in the place of a part names the path to
    ask for.

    Parameters
    ----------
    without
        Keys of the document and of its blocks that only a request by path answers.
    """
    whole = _rounded(part_of(document, path))
    if not path:
        whole = _on_request(whole, without)
    budget = MOST_BYTES
    while not fits(text := _json(_shortened(whole, budget, path))):
        budget = budget * 9 // 10
    return text


def _on_request(value: Any, without: Sequence[str], within: str = "") -> Any:
    """Return a document without the keys that only a request answers; ``within`` is the path to it."""
    if not isinstance(value, dict):
        return value
    return {
        k: _left_out(v, f"{within}{k}") if k in without and v else _on_request(v, without, f"{within}{k}.")
        for k, v in value.items()
    }


def fits(text: str) -> bool:
    """Return whether an answer with this text, which the protocol sends as a JSON string, is short enough."""
    return len(_json(text).encode()) <= MOST_BYTES - _ENVELOPE_BYTES


def _shortened(value: Any, budget: int, path: str) -> Any:
    """Return a value shortened to a size in bytes: small parts stay complete, large ones are shortened."""
    if _size(value) <= budget:
        return value
    if budget < _LEAST_BYTES:
        return _left_out(value, path)
    if isinstance(value, dict):
        return _shared(value, budget, path)
    if isinstance(value, list):
        kept: list[Any] = []
        for k, item in enumerate(value):
            share = max(budget // (len(value) - k), _ITEM_BYTES)
            shorter = _shortened(item, share, f"{path}.{k}".lstrip("."))
            budget -= _size(shorter)
            if budget < _LEAST_BYTES:
                return [*kept, f"{len(value) - k} more; ask for part {path}.{k} and so on".replace(" .", " ")]
            kept.append(shorter)
        return kept
    return _left_out(value, path)


def _shared(value: dict[str, Any], budget: int, path: str) -> dict[str, Any]:
    shorter = {}
    by_size = sorted(value, key=lambda key: _size(value[key]))
    for k, key in enumerate(by_size):
        share = budget // (len(by_size) - k)
        shorter[key] = _shortened(value[key], share, f"{path}.{key}".lstrip("."))
        budget -= _size(shorter[key]) + len(key) + 4
    return {key: shorter[key] for key in value}


def _left_out(value: Any, path: str) -> str:
    return f"left out, {_size(value) / 1000.0:.1f} kB; ask for part {path}"


def _rounded(value: Any) -> Any:
    if isinstance(value, float):
        return float(f"{value:.{_DIGITS}g}")
    if isinstance(value, dict):
        return {key: _rounded(item) for key, item in value.items()}
    return [_rounded(item) for item in value] if isinstance(value, list) else value


def _size(value: Any) -> int:
    return len(_json(value).encode())


def _json(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False, separators=(",", ":"))
