"""Blocks of ``README.md`` that come from the data of the documentation."""

from collections.abc import Callable, Mapping
from pathlib import Path

from advisor.words.quantities import symbol
from benchmarks import real
from benchmarks.pages.fragments import DATA, REAL

_RECORDS = ("turboprop.tlog", "jet-vane.tlog", "glider.tlog", "arduplane-elevon.BIN")
"""Records that the README shows: one of each kind; the first row of a record stands for it."""
_FIGURES = (
    *(f"first answer right, {name} |" for name in ("own", "second", "third", "arduplane")),
    "in the world: ", "false alarms, nothing withheld |", "right where P is at least .9 |",
    "without a name: unknown |", "sizes inside",
)  # fmt: skip
"""Begins of the rows on fresh flights that the README shows."""


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
    head, rule, *rows = (DATA / "gap-fresh.md").read_text(encoding="utf-8").splitlines()
    shown = [row for row in rows if row.removeprefix("| ").startswith(_FIGURES)]
    return "\n".join([head, rule, *shown, "", rows[-1]])


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
