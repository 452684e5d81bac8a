"""Write the pages that are made, or add a scored run to the data of the results.

    python -m benchmarks.pages                  # the effects, the decisions, the table of results
    python -m benchmarks.pages --examples       # the worked examples and the figure of docs/gap.md, too
    python -m benchmarks.pages add score.json --own --set SS --seed 7 --generator NAME --commit 1a2b3c4

``python -m sim reveal --json`` and ``python -m benchmarks.second_generator score --json`` print such scores.
"""

import argparse
import json
import sys
from collections.abc import Callable, Mapping, Sequence
from datetime import date
from pathlib import Path

from benchmarks.pages import decisions, effects, results

DOCS = Path(__file__).parents[2] / "docs"
DATA = Path("data") / "gap-results.json"
PAGES: Mapping[str, Callable[[], str]] = {
    "effects.md": effects.page,
    "decisions-of-the-gap.md": decisions.page,
}
"""Pages that are made as a whole."""


def main(arguments: Sequence[str] | None = None, docs: Path = DOCS) -> int:
    """Exit code 0; 2 where the run cannot be added, after a sentence."""
    given = _parser().parse_args(arguments)
    try:
        if given.command == "add":
            add(docs / DATA, given)
        for path, text in made(docs).items():
            path.write_text(text, encoding="utf-8")
        if given.examples:
            write_examples(docs)
    except OSError as error:
        print(f"error: {error.filename}: {error.strerror}; give a file that is there", file=sys.stderr)
        return 2
    except ValueError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


def made(docs: Path = DOCS) -> dict[Path, str]:
    """Every made page, as it should be."""
    table = results.table(results.read(docs / DATA))
    page = docs / "gap-results.md"
    pages = {docs / name: page() for name, page in PAGES.items()}
    return {**pages, page: within(page.read_text(encoding="utf-8"), "results", table)}


def write_examples(docs: Path) -> None:
    """Run the worked examples, and write their outputs and the figure."""
    from benchmarks.pages import example, figure

    for name, mark, told in (
        ("gap.md", "example", example.transcript),
        ("foresee.md", "plan", example.foresight),
    ):
        page = docs / name
        page.write_text(within(page.read_text(encoding="utf-8"), mark, told()), encoding="utf-8")
    (docs / "gap.svg").write_text(figure.figure(example.diagnosis()), encoding="utf-8")


def within(page: str, name: str, text: str) -> str:
    """A page with the text between its two marks exchanged."""
    begin, end = f"<!-- {name}: begin -->", f"<!-- {name}: end -->"
    before, rest = page.split(begin)
    return f"{before}{begin}\n{text}\n{end}{rest.split(end)[1]}"


def add(data: Path, given: argparse.Namespace) -> None:
    """Put a run before the others of the data file.

    Raises
    ------
    ValueError
        The run stands there already, or the file holds no score.
    """
    try:
        score = json.loads(given.score.read_text(encoding="utf-8"))
    except ValueError:
        score = None
    if not isinstance(score, dict) or score.get("schema") != "score/1":
        raise ValueError(f"{given.score}: no score; write it with `score --json` or `reveal --json`")
    seed = score.get("seed") if given.seed is None else given.seed
    run = results.Run(
        given.set, given.generator, given.own, score["cases"], seed, given.commit, given.date,
        score["answers_sha256"][:8], results.figures_of(score), given.note,
    )  # fmt: skip
    results.write(data, results.added(results.read(data), run))


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.pages", description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument(
        "--examples", action="store_true", help="run the worked examples, too (half a minute)"
    )
    commands = parser.add_subparsers(dest="command")
    run = commands.add_parser("add", help="add a scored run, then write the pages")
    run.add_argument("score", type=Path, help="output of `score --json` or of `reveal --json`")
    run.add_argument("--set", required=True, help="name of the set; several draws of one set have the same")
    run.add_argument("--generator", required=True, help="what made the flights")
    where = run.add_mutually_exclusive_group(required=True)
    where.add_argument("--own", action="store_true", help="by the project's own simulator")
    where.add_argument("--outside", action="store_true", help="by anything else")
    run.add_argument("--seed", type=int, help="of the draw; default: as the score says")
    run.add_argument("--commit", required=True, help="of the code that answered")
    run.add_argument("--date", default=date.today().isoformat(), help="of the answers; default: today")
    run.add_argument("--note", default="")
    return parser


if __name__ == "__main__":
    sys.exit(main())
