"""Tables of results that pages of the documentation show, each from its one data file in ``docs/data``."""

import re
from collections.abc import Callable, Mapping
from pathlib import Path

from benchmarks import real
from benchmarks.pages import results
from benchmarks.pages.forest import forest
from benchmarks.pages.signs import signs

DATA = Path(__file__).parents[2] / "docs" / "data"
GAP_RESULTS = DATA / "gap-results.json"
REAL = DATA / "real.json"
_MARK = re.compile(r"^<!-- made: ([a-z-]+) -->$", re.MULTILINE)

FRAGMENTS: Mapping[str, Callable[[], str]] = {
    "real": lambda: real.in_markdown(*real.read(REAL)),
    "real-forest": lambda: forest(real.read(REAL)[0]),
    "signs": signs,
    "gap-figures": lambda: results.figures_table(results.read(GAP_RESULTS)),
    "gap-sets": lambda: results.sets_table(results.read(GAP_RESULTS)),
}
"""Name of a fragment to the function that makes its Markdown."""


def filled(page: str) -> str:
    """A page whose lines ``<!-- made: NAME -->`` are exchanged for the fragments of these names."""
    return _MARK.sub(lambda found: FRAGMENTS[found[1]](), page)
