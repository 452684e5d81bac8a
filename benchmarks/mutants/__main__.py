"""Draw mutants by a seed, and tell which of them the nearest tests let live.

    python -m benchmarks.mutants [--seed N ...] [--count N] [--list]

A copy of the tree takes one mutant after the other. The tests of the changed module run on each, in one
process at low priority. The exit code is 1 where more than 2 of 24 live.
"""

import argparse
import sys
import tempfile
import time
from pathlib import Path

from benchmarks.mutants.draw import Mutant, draw
from benchmarks.mutants.nearest import Imports
from benchmarks.mutants.trial import Trial

ROOT = Path(__file__).parents[2]
COUNT = 24
MOST_ALIVE = 2 / 24
"""Mutants of one seed, and the largest share that may live."""


def main() -> int:
    """Print the fate of every mutant of every seed; return 1 where too many of one seed live."""
    asked = argparse.ArgumentParser(prog="python -m benchmarks.mutants")
    asked.add_argument("--seed", type=int, nargs="+", default=[1], help="seeds of the draws")
    asked.add_argument("--count", type=int, default=COUNT, help="mutants of each seed")
    asked.add_argument("--list", action="store_true", help="print the mutants and their tests, run nothing")
    given = asked.parse_args()
    imports = Imports(ROOT)
    too_many = False
    with tempfile.TemporaryDirectory() as copy:
        trial = None if given.list else Trial(ROOT, Path(copy))
        for seed in given.seed:
            mutants = draw(ROOT, seed, given.count)
            if trial is None:
                for mutant in mutants:
                    print(_told(mutant), *imports.nearest(mutant.file), sep="\n    ")
                continue
            alive = [mutant for mutant in mutants if _lives(trial, imports, mutant)]
            print(f"seed {seed}: {len(alive)} of {len(mutants)} live", *map(_told, alive), sep="\n  ")
            too_many |= len(alive) > MOST_ALIVE * len(mutants)
    return int(too_many)


def _lives(trial: Trial, imports: Imports, mutant: Mutant) -> bool:
    began_s = time.monotonic()
    noticed = trial.fate(mutant, imports.nearest(mutant.file))
    took_s = time.monotonic() - began_s
    print(f"{'dies ' if noticed else 'LIVES'} {took_s:5.1f} s  {_told(mutant)}  {noticed}", flush=True)
    return not noticed


def _told(mutant: Mutant) -> str:
    return f"{mutant.file}:{mutant.change.line}: {mutant.before} -> {mutant.after}"


if __name__ == "__main__":
    sys.exit(main())
