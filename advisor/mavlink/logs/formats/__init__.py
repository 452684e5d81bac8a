"""Formats of logs, with one module for each format.

A new module in this folder is added automatically.
"""

from collections.abc import Iterator
from importlib import import_module
from pkgutil import iter_modules

from advisor.mavlink.logs.log_format import LogFormat


def _found() -> Iterator[LogFormat]:
    for module in iter_modules(__path__, f"{__name__}."):
        yield import_module(module.name).FORMAT


FORMATS: tuple[LogFormat, ...] = tuple(sorted(_found(), key=lambda one: (one.has_magic, one.ending)))
"""All formats, telemetry first, in the order of the user's sentence."""
ENDINGS: tuple[str, ...] = tuple(one.ending for one in FORMATS)
"""Usual file endings of logs."""
GIVE = f"Give {', '.join(one.given for one in FORMATS[:-1])} or {FORMATS[-1].given}."
"""Sentence that lists the readable logs."""
