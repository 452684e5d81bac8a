"""Settings of a user: YAML checked against dataclasses by pydantic, with every mistake listed at once."""

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from copy import deepcopy
from dataclasses import fields, is_dataclass
from difflib import get_close_matches
from math import isfinite
from pathlib import Path
from typing import Any, TypeVar, get_args, get_type_hints

from pydantic import BeforeValidator, ConfigDict, TypeAdapter, ValidationError, with_config

from advisor.process.yaml_file import read_yaml
from advisor.words.problems import ConfigurationError

T = TypeVar("T")
strict = with_config(ConfigDict(extra="forbid", allow_inf_nan=False))
"""Decorator of a section of a settings file: unknown keys, infinity and NaN are refused."""
_MOST_LISTED = 20
"""Largest number of listed mistakes. With more mistakes, a user has repeated the same one."""
_UNION_TAGS = frozenset({"int", "str", "float", "none"})


def must(
    be: str, allowed: Callable[[float], bool] = lambda _: True, words: Sequence[str] = ()
) -> BeforeValidator:
    """Return the check of a number or of one of the words, whose sentence says what the value must be."""

    def checked(given: Any) -> Any:
        is_number = isinstance(given, int | float) and not isinstance(given, bool) and isfinite(given)
        if (is_number and allowed(given)) or given in words:
            return given
        raise ValueError(f"must be {be}, is {given!r:.40}")

    return BeforeValidator(checked)


def read_settings(
    path: Path, kind: type[T], mend: str, beyond: Callable[[T], Iterable[str]] = lambda _: ()
) -> T:
    """Read a settings file; an empty file has no keys. Parameters and errors are those of ``settings_of``."""
    content = read_yaml(path, mend)
    return settings_of({} if content is None else content, kind, str(path), mend, beyond)


def settings_of(
    content: Any,
    kind: type[T],
    origin: str,
    mend: str,
    beyond: Callable[[T], Iterable[str]] = lambda _: (),
    meant: Callable[[str], str] | None = None,
) -> T:
    """Turn parsed YAML into a dataclass.

    Parameters
    ----------
    kind
        Dataclass of the file, and of its sections, each decorated by ``strict``.
    origin
        Name of the file or other source of the content, for the sentence about mistakes.
    mend
        Sentence with the remedy for a refused file.
    beyond
        Function that yields the mistakes that the types do not exclude, as ``path: description``.
    meant
        Function that returns what an unknown key at a path may mean, in brackets.

    Raises
    ------
    ConfigurationError
        Lists every mistake with its path, e.g. ``elevator.calibration[1]``.
    """
    reader = TypeAdapter(kind)
    meant = meant or (lambda path: resembling(path.rpartition(".")[2], _keys_at(kind, path)))
    # "elevator:" with nothing under it is a section that the user leaves for later.
    content = {k: v for k, v in content.items() if v is not None} if isinstance(content, dict) else content
    mistakes: list[str] = []
    while True:
        try:
            settings = reader.validate_python(content)
        except ValidationError as error:
            mistakes += dict.fromkeys(_sentence(item, meant) for item in error.errors())
            # The rest is read again, so that one wrong key does not hide another's mistake.
            remainder = _without(content, [item["loc"] for item in error.errors()])
            if remainder == content:
                break
            content = remainder
        else:
            mistakes += beyond(settings)
            if not mistakes:
                return settings
            break
    more = [f"and {len(mistakes) - _MOST_LISTED} more"] if len(mistakes) > _MOST_LISTED else []
    listed = "; ".join([*mistakes[:_MOST_LISTED], *more])
    raise ConfigurationError(f"{origin}: {listed}. {mend}".rstrip())


def _without(content: Any, locations: list[tuple[int | str, ...]]) -> Any:
    kept = deepcopy(content)
    for location in locations:
        if isinstance(kept, dict) and location:
            _take_out(kept, location)
    return kept


def _take_out(section: dict[Any, Any], location: Sequence[int | str]) -> None:
    """Remove only the innermost key at a location, because other keys of the section may be wrong too."""
    key, *inside = location
    within = section.get(key)
    if isinstance(within, dict) and inside and inside[0] in within:
        _take_out(within, inside)
    else:
        section.pop(key, None)


def _sentence(item: Any, meant: Callable[[str], str]) -> str:
    path = ""
    # Union members add the member's type to the location. A user's file has no such key.
    for step in item["loc"]:
        if isinstance(step, int):
            path += f"[{step}]"
        elif (
            not step.startswith(("literal[", "tuple[", "function-", "constrained-"))
            and step not in _UNION_TAGS
        ):
            path += f".{step}" if path else str(step)
    if path.endswith(".[key]"):
        path = path.removesuffix(".[key]")
        names = re.findall(r"'([^']+)'", item["ctx"]["expected"])
        return f"{path}: unknown key{resembling(path.rpartition('.')[2], names)}"
    if item["type"] in ("unexpected_keyword_argument", "extra_forbidden"):
        return f"{path or 'file'}: unknown key{meant(path)}"
    if item["type"] == "dataclass_type" or item["type"] == "dict_type":
        return f"{path or 'file'}: must hold keys with values"
    said = item["msg"].removeprefix("Value error, ")
    return f"{path or 'file'}: {said[0].lower()}{said[1:]}"


def resembling(key: str, names: Sequence[str]) -> str:
    """Return the known key that resembles an unknown key, or all known keys, in brackets."""
    near = get_close_matches(key, names, 1)
    return f" (did you mean {near[0]}?)" if near else f" (the keys are {', '.join(names)})"


def _keys_at(kind: type, path: str) -> list[str]:
    for step in re.sub(r"\[\d+\]", "", path).split(".")[:-1]:
        kind = next(_dataclasses_in(get_type_hints(kind).get(step)), kind)
    return [field.name for field in fields(kind)]


def _dataclasses_in(hint: Any) -> Iterator[Any]:
    if is_dataclass(hint):
        yield hint
    for inner in get_args(hint):
        yield from _dataclasses_in(inner)
