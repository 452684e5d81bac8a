"""``explanation/decisions/index.md``: every decision record, by its number and its title."""

from pathlib import Path

_HEAD = """# Decisions

A decision record says which question stood open, what was decided and what follows. A later decision gets a
record of its own.

"""


def page(folder: Path) -> str:
    """The list as Markdown; a record's first line is its title."""
    records = sorted(folder.glob("[0-9]*.md"))
    titles = [path.read_text(encoding="utf-8").splitlines()[0].removeprefix("# ") for path in records]
    lines = (f"- [{title}]({path.name})" for path, title in zip(records, titles, strict=True))
    return _HEAD + "\n".join(lines) + "\n"
