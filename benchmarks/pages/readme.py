"""Blocks of ``README.md`` that come from the data of the documentation."""

from collections.abc import Callable, Mapping
from pathlib import Path

from advisor.words.quantities import symbol
from benchmarks import real
from benchmarks.pages import results
from benchmarks.pages.fragments import DATA, GAP_RESULTS, REAL

_RECORDS = ("turboprop.tlog", "jet-vane.tlog", "glider.tlog", "arduplane-elevon.BIN")
"""Records that the README shows: one of each kind; the first row of a record stands for it."""
_FIGURES = ("right cause first, one effect", "false alarms where nothing is", "no named effect: unknown")


def _example(name: str) -> Callable[[], str]:
    return lambda: f"```text\n{(DATA / 'examples' / f'{name}.txt').read_text(encoding='utf-8')}```"


def _records() -> str:
    rows, measured = real.read(REAL)
    shown = [next(row for row in rows if row.log == log) for log in _RECORDS]
    lines = [f"| {row.what} | {symbol(row.asked)} | {symbol(row.got)} | {row.word} |" for row in shown]
    held = sum(row.holds for row in rows)
    last = f"{held} of {len(rows)} records hold. Measured {measured}."
    return "\n".join(["| record | asked | result | holds |", "|---|---|---|---|", *lines, "", last])


def _gap() -> str:
    *table, empty, source = results.figures_table(results.read(GAP_RESULTS)).splitlines()
    shown = [row for row in table if row.startswith(tuple(f"| {f} |" for f in _FIGURES))]
    return "\n".join([*table[:2], *shown, empty, source])


BLOCKS: Mapping[str, Callable[[], str]] = {
    "doctor": _example("doctor-short"),
    "analyze": _example("analyze-short"),
    "gap": _example("gap"),
    "records": _records,
    "gap-figures": _gap,
}
"""Name of a block, which stands between two comments, to the function that makes its text."""


def filled(page: str) -> str:
    """The page with every block as the data have it."""
    for name, make in BLOCKS.items():
        begin, end = f"<!-- {name}: begin -->", f"<!-- {name}: end -->"
        before, rest = page.split(begin)
        page = f"{before}{begin}\n{make()}\n{end}{rest.split(end)[1]}"
    return page


def write(path: Path) -> None:
    """Fill the blocks of the file."""
    path.write_text(filled(path.read_text(encoding="utf-8")), encoding="utf-8")
