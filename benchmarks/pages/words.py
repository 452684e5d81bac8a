"""Words of the documentation that are written by hand: ``docs`` and ``README.md``, without what is made.

    python -m benchmarks.pages.words

Made are ``docs/data``, and blocks between ``<!-- NAME: begin -->`` and ``<!-- NAME: end -->``.
"""

import re
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[2]
MOST_WORDS = 25_500
"""Words of all pages together: 20,000 of explanation, 2,000 of tables that are looked up and not read through
(symbols and terms, symptoms, keys), 1,500 on roll and yaw and on users' simulators, 500 on scripts that an
autopilot flies, 500 on marks, odd manoeuvres and denied stops, and 1,000 on flights as tests and on tables of
flown data."""
MOST_BYTES = {"docs/explanation/gap.md": 8_192}
"""Size of single pages, bytes."""
_MADE = re.compile(r"<!-- ([a-z-]+): begin -->.*?<!-- \1: end -->", re.DOTALL)


def pages(root: Path) -> Iterator[Path]:
    """Yield the pages that are written by hand. The state of the work is no page of the site."""
    yield root / "README.md"
    docs = root / "docs"
    written = (path for path in sorted(docs.rglob("*.md")) if docs / "data" not in path.parents)
    yield from (path for path in written if path != docs / "status.md")


def words_in(text: str) -> int:
    """Words that have a letter or a digit, without those of made blocks."""
    return sum(any(map(str.isalnum, word)) for word in _MADE.sub("", text).split())


def main(root: Path = ROOT) -> int:
    """Print the words of each page and their sum; 1 where a limit is passed."""
    counts = {
        path.relative_to(root).as_posix(): words_in(path.read_text(encoding="utf-8")) for path in pages(root)
    }
    for name, count in counts.items():
        print(f"{count:6} {name}")
    total = sum(counts.values())
    print(f"{total:6} of at most {MOST_WORDS}")
    sizes = {name: (root / name).stat().st_size for name in MOST_BYTES}
    larger = [name for name, size in sizes.items() if size > MOST_BYTES[name]]
    for name in larger:
        print(f"{name} holds {sizes[name]} bytes, at most {MOST_BYTES[name]}: shorten it", file=sys.stderr)
    if total > MOST_WORDS:
        print(f"The documentation has {total} words, at most {MOST_WORDS}: shorten a page", file=sys.stderr)
    return 1 if larger or total > MOST_WORDS else 0


if __name__ == "__main__":
    sys.exit(main())
