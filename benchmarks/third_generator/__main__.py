"""Draw a set of cases, or score the diagnosis' answers to it.

python -m benchmarks.third_generator draw --cases 160 --seed 11 --out cases
python -m benchmarks.third_generator score cases answers.jsonl --details
"""

import argparse
import json
from pathlib import Path

from benchmarks.second_generator.score import report, score_document

from . import late_alpha
from .files import draw_set


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    commands = options.add_subparsers(dest="command", required=True)
    draw = commands.add_parser("draw", help="write cases and their key")
    draw.add_argument("--cases", type=int, required=True)
    draw.add_argument("--seed", type=int, required=True)
    draw.add_argument("--out", type=Path, required=True)
    draw.add_argument("--only", help="a class (none, one, two, parameters, outside) or an effect")
    score = commands.add_parser("score", help="score answers against the key")
    score.add_argument("folder", type=Path)
    score.add_argument("answers", type=Path)
    score.add_argument("--details", action="store_true", help="one line a wrong case")
    score.add_argument("--json", action="store_true", help="the figures as one JSON document")
    chosen = options.parse_args()
    if chosen.command == "draw":
        try:
            draw_set(chosen.out, chosen.cases, chosen.seed, chosen.only)
        except ValueError as error:
            options.error(str(error))
    elif chosen.json:
        print(json.dumps(score_document(chosen.folder, chosen.answers), indent=1))
    else:
        print(late_alpha.lines(chosen.folder, chosen.answers))
        print(report(chosen.folder, chosen.answers, details=chosen.details))


if __name__ == "__main__":
    main()
