"""YAML for settings: plain text, without references, each key once. Any other form of YAML is refused with
one sentence."""

from collections.abc import Hashable
from pathlib import Path
from typing import Any

import yaml

from advisor.words.problems import ConfigurationError, printable

_MOST_BYTES = 256 * 1024
"""Largest file, bytes. Largest size of a YAML file, bytes. A settings file has a few kB, and the limit keeps
the reading time below a second.
"""
_MOST_VALUES = 20_000
"""Largest number of values, lists and sections together. A file with a thousand decisions by hand on one log
has 8,000 values. A check of ten times as many values would take seconds."""
_DEEPEST = 32
"""Deepest nesting of sections in a settings file. The advisor's own files need six levels."""

_Parser: type[Any] = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


def read_yaml(path: Path, mend: str = "See the example in the README.") -> Any:
    """Return the content of a YAML file; None for an empty one.

    Parameters
    ----------
    mend
        Sentence with the remedy for a refused file.

    Raises
    ------
    ConfigurationError
        The file cannot be read, is too large, is not YAML in UTF-8, nests too deeply, holds a
        reference, or repeats a key.
    """
    try:
        if path.exists() and not (path.is_file() or path.is_dir()):
            raise _Refused("a pipe or a device, no regular file")
        with path.open("rb") as file:
            raw = file.read(_MOST_BYTES + 1)
        if len(raw) > _MOST_BYTES:
            raise _Refused(f"larger than {_MOST_BYTES // 1024} kB, which no file of this kind needs")
        text = raw.decode("utf-8-sig")
        _look_over(text)
        return yaml.load(text, Loader=_Loader)
    except OSError as error:
        mistake = f"cannot be read ({error.strerror})"
    except UnicodeDecodeError:
        mistake = "not a YAML file: it is no text in UTF-8"
    except _Refused as refused:
        mistake = str(refused)
    except yaml.YAMLError as error:
        where = f", line {mark.line + 1}" if (mark := getattr(error, "problem_mark", None)) else ""
        mistake = f"not a YAML file{where}"
    except ValueError as error:
        # PyYAML builds dates: "2026-02-31" has the form of a date and is none.
        why, _, _ = str(error).partition(";")  # what follows is for programmers
        mistake = f"holds a value that is none ({why})"
    raise ConfigurationError(f"{path}: {mistake}. {mend}")


class _Refused(Exception):  # noqa: N818 (a reason, told by the caller)
    """Reason for which well-formed YAML is refused."""


def _look_over(text: str) -> None:
    """Refuse the YAML forms that overflow a recursive reader, before any object is built."""
    depth = values = 0
    for event in yaml.parse(text, Loader=_Parser):
        values += isinstance(event, yaml.ScalarEvent | yaml.CollectionStartEvent)
        if values > _MOST_VALUES:
            raise _Refused(f"more than {_MOST_VALUES} values, which no file of this kind needs")
        line = event.start_mark.line + 1  # type: ignore[union-attr]
        if isinstance(event, yaml.AliasEvent):
            raise _Refused(
                f"line {line}: the reference *{event.anchor} is not read; write its values in this line"
            )
        if isinstance(event, yaml.CollectionStartEvent):
            depth += 1
        elif isinstance(event, yaml.CollectionEndEvent):
            depth -= 1
        if depth > _DEEPEST:
            raise _Refused(f"line {line}: nested more than {_DEEPEST} deep")


class _Loader(_Parser):  # type: ignore[misc]
    """Safe YAML loader that refuses a repeated key of a section."""

    def construct_mapping(self, node: Any, deep: bool = False) -> dict[Any, Any]:
        """Build one section of the settings.

        Raises
        ------
        _Refused
            The section repeats a key.
        """
        said: set[Hashable] = set()
        for key_node, _ in node.value:
            key = (key_node.tag, str(key_node.value))
            if key in said:
                line = key_node.start_mark.line + 1
                raise _Refused(f"line {line}: the key {key_node.value!r} is repeated; keep one")
            said.add(key)
        section: dict[Any, Any] = super().construct_mapping(node, deep=deep)
        return section

    def construct_text(self, node: Any) -> str:
        """Build a text that can be displayed. An escape in quotes may stand for any control character."""
        return "\n".join(map(printable, self.construct_scalar(node).split("\n")))


_Loader.add_constructor("tag:yaml.org,2002:str", _Loader.construct_text)
