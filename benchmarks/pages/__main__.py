"""Write what the documentation shows of the code, or add a scored run to the data of the results.

    python -m benchmarks.pages                  # the blocks of README.md, from docs/data
    python -m benchmarks.pages --examples       # before that run the worked examples, and draw the figures
    python -m benchmarks.pages add score.json --own --set SS --seed 7 --generator NAME --commit 1a2b3c4

``python -m sim reveal --json`` prints such a score, whatever the generator.
"""

import argparse
import json
import sys
from collections.abc import Sequence
from datetime import date
from pathlib import Path

from benchmarks.pages import readme, results

ROOT = Path(__file__).parents[2]
DATA = Path("docs") / "data"


def main(arguments: Sequence[str] | None = None, root: Path = ROOT) -> int:
    """Exit code 0; 2 where the run cannot be added, after a sentence."""
    given = _parser().parse_args(arguments)
    try:
        if given.command == "add":
            add(root / DATA / "gap-results.json", given)
            return 0
        if given.examples:
            write_examples(root)
        readme.write(root / "README.md")
    except OSError as error:
        print(f"error: {error.filename}: {error.strerror}; give a file that is there", file=sys.stderr)
        return 2
    except ValueError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


def write_examples(root: Path) -> None:
    """Run the worked examples, and write their outputs and the figures."""
    from benchmarks.pages import example

    for name, text in example.transcripts():
        (root / DATA / "examples" / name).write_text(text, encoding="utf-8")
    for name, drawn in example.figures():
        (root / "docs" / "explanation" / name).write_text(drawn, encoding="utf-8")


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
        raise ValueError(f"{given.score}: no score; write it with `python -m sim reveal --json`")
    run = results.Run(
        given.set, given.generator, given.own, score["cases"], given.seed, given.commit, given.date,
        score["answers_sha256"][:8], results.figures_of(score), given.note,
    )  # fmt: skip
    results.write(data, results.added(results.read(data), run))


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.pages", description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--examples", action="store_true", help="run the worked examples, too (a minute)")
    commands = parser.add_subparsers(dest="command")
    run = commands.add_parser("add", help="add a scored run to the data")
    run.add_argument("score", type=Path, help="output of `python -m sim reveal --json`")
    run.add_argument("--set", required=True, help="name of the set; several draws of one set have the same")
    run.add_argument("--generator", required=True, help="what made the flights")
    where = run.add_mutually_exclusive_group(required=True)
    where.add_argument("--own", action="store_true", help="by the project's own simulator")
    where.add_argument("--outside", action="store_true", help="by anything else")
    run.add_argument("--seed", type=int, help="of the draw")
    run.add_argument("--commit", required=True, help="of the code that answered")
    run.add_argument("--date", default=date.today().isoformat(), help="of the answers; default: today")
    run.add_argument("--note", default="")
    return parser


if __name__ == "__main__":
    sys.exit(main())
