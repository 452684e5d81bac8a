"""The formats of logs: one module for each, which makes its ``FORMAT``.

A new module is found by itself.
"""

from collections.abc import Iterator
from importlib import import_module
from pkgutil import iter_modules

from advisor.mavlink.logs.log_format import LogFormat


def _found() -> Iterator[LogFormat]:
    for module in iter_modules(__path__, f"{__name__}."):
        yield import_module(module.name).FORMAT


FORMATS: tuple[LogFormat, ...] = tuple(sorted(_found(), key=lambda one: (one.has_magic, one.ending)))
"""Every format, telemetry first, as people name them."""
ENDINGS: tuple[str, ...] = tuple(one.ending for one in FORMATS)
"""Usual endings of logs."""
GIVE = f"Give {', '.join(one.given for one in FORMATS[:-1])} or {FORMATS[-1].given}."
"""Sentence on the logs that can be read."""
