"""Fields of a log that a person asks for by name, alone or summed: ``ATT.Roll``, ``RCOU.C1+RCOU.C3``."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path

import numpy as np

from advisor.mavlink.logs.raw_fields import RawTable, names_in, read_raw
from advisor.process.arrays import FloatArray
from advisor.words.problems import ConfigurationError


@dataclass(frozen=True, slots=True)
class FieldSum:
    """One field of a log, or the sum of several, in the log's units."""

    name: str
    """Name as the user wrote it: ``RCOU.C1+RCOU.C3``."""
    t: FloatArray
    """Shape (n,), stamps of the first field, s since power-on."""
    y: FloatArray
    """Shape (n,), sum of the fields. All fields but the first are interpolated at ``t``. NaN where
    a field has no samples."""


def field_sums(log: Path, asked: Sequence[str]) -> tuple[FieldSum, ...]:
    """Return the fields that are asked for.

    Parameters
    ----------
    asked
        Names, each ``MESSAGE.FIELD`` as in the log, or several fields joined by ``+``.

    Raises
    ------
    ConfigurationError
        A field is not in the log.
    UnusableInputError
        The log cannot be read.
    """
    if not asked:
        return ()
    parts = [[part.strip() for part in text.split("+")] for text in asked]
    tables = read_raw(log, {part.partition(".")[0].partition("[")[0] for sums in parts for part in sums})
    _refuse_unknown(log, [part for sums in parts for part in sums], tables)
    return tuple(_summed(text, sums, tables) for text, sums in zip(asked, parts, strict=True))


def _refuse_unknown(log: Path, parts: Sequence[str], tables: Mapping[str, RawTable]) -> None:
    there = {f"{name}.{field}" for name, table in tables.items() for field in table.fields}
    unknown = [part for part in parts if part not in there]
    if not unknown:
        return
    defined = {f"{name}.{field}": None for name, fields in names_in(log).items() for field in fields}
    every = {name.lower(): name for name in (*defined, *there)}
    said = []
    for part in dict.fromkeys(unknown):
        near = [every[name] for name in get_close_matches(part.lower(), every) if every[name] != part]
        nearest = f"; nearest: {', '.join(near)}" if near else "; names are MESSAGE.FIELD as in the log"
        said.append(f"--field {part}: {log.name} has no numbers under this name{nearest}.")
    raise ConfigurationError("\n".join(said))


def _summed(text: str, parts: Sequence[str], tables: Mapping[str, RawTable]) -> FieldSum:
    t = tables[parts[0].partition(".")[0]].t
    y = np.zeros(len(t))
    for part in parts:
        name, _, field = part.partition(".")
        y += np.interp(t, tables[name].t, tables[name].fields[field], left=np.nan, right=np.nan)
    return FieldSum(text, t, y)
