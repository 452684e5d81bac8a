"""Which pages of the documentation site the code makes: none of them is a file in ``docs``."""

from collections.abc import Callable, Mapping
from pathlib import Path

from benchmarks.pages import aircraft_file, commands, decision_records, decisions, documents, effects

DOCS = Path(__file__).parents[2] / "docs"
PAGES: Mapping[str, Callable[[], str]] = {
    "explanation/decisions/index.md": lambda: decision_records.page(DOCS / "explanation" / "decisions"),
    "changes.md": lambda: (DOCS.parent / "CHANGELOG.md").read_text(encoding="utf-8"),
    "reference/commands.md": commands.page,
    "reference/aircraft-file.md": aircraft_file.page,
    "reference/json.md": lambda: documents.page(DOCS / "reference" / "schemas"),
    "reference/effects.md": effects.page,
    "reference/gap-decisions.md": decisions.page,
}
"""Address of a page in ``docs`` to the function that makes its Markdown."""
BUILT_SAMPLES = DOCS.parent / "build" / "samples"
SAMPLES = ("report.html", "gap.html")
"""Pages that the advisor itself writes of two flights; ``make site`` writes them."""
SECTIONS: Mapping[str, str] = {"Developer": "developer"}
"""Section of the navigation to the folder in ``docs`` whose pages it lists."""
