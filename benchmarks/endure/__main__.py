"""Ask the advisor about flights in every unkind form: it always answers.

    python -m benchmarks.endure [--cases N] [--seed N] [--workers N] [--minutes N]
    python -m benchmarks.endure --case 'analyze logs/bundled-demo.tlog: cut 0.2 0.4; nan ATTITUDE.pitch'

An answer has exit code 0 or 3, no part that failed by a fault of the advisor, no NaN in its document, and
takes at most 20 s of processor time a minute of log. A failure is made smaller, and printed with the command
that repeats it. The exit code is 1 after a failure.
"""

import argparse
import os
import sys
import time
from collections import Counter
from functools import partial

from advisor.process.first_run import KERNELS
from advisor.process.tasks.processes import run_in_processes
from benchmarks.endure.cases import draw, logs, parsed
from benchmarks.endure.outcome import Outcome, tried
from benchmarks.endure.trial import Failure, failure

CHUNK = 50
"""Cases between two lines of progress. Every chunk has fresh processes."""


def table(outcomes: list[Outcome]) -> str:
    """Return cases and failures by command and by form, and failures by kind."""
    lines = [f"{'':<12}{'cases':>7}{'failures':>10}"]
    names = Counter(case.command for case, *_ in outcomes)
    names += Counter(one.form for case, *_ in outcomes for one in case.unkindnesses)
    failed = Counter(case.command for case, found, _ in outcomes if found)
    failed += Counter(one.form for case, found, _ in outcomes if found for one in case.unkindnesses)
    lines += [f"{name:<12}{count:>7}{failed[name]:>10}" for name, count in names.items()]
    kinds = Counter(found.kind for _, found, _ in outcomes if found)
    lines += [f"{count:>4} {kind}" for kind, count in kinds.most_common()]
    return "\n".join([*lines, f"{len(outcomes)} cases, {kinds.total()} failures"])


def main() -> int:
    """Answer all cases; return 1 where one fails."""
    asked = argparse.ArgumentParser(prog="python -m benchmarks.endure")
    asked.add_argument("--cases", type=int, default=5000)
    asked.add_argument("--seed", type=int, default=0)
    asked.add_argument("--workers", type=int, default=os.cpu_count())
    asked.add_argument(
        "--minutes", type=float, default=float("inf"), help="begin no further cases after these"
    )
    asked.add_argument("--case", help="answer one case, as a failure printed it")
    given = asked.parse_args()
    for compile_kernels in KERNELS.values():  # so that no case pays for what a machine does once
        compile_kernels()
    if given.case:
        found = failure(parsed(given.case))
        print(f"{found.told}\n{found.kind}" if found else "answered")
        return int(found is not None)
    work, began_s, outcomes = partial(tried, given.seed, logs()), time.monotonic(), list[Outcome]()
    for begin in range(0, given.cases, CHUNK):
        if time.monotonic() - began_s > 60.0 * given.minutes:
            break
        numbers = range(begin, min(begin + CHUNK, given.cases))
        for number, outcome in run_in_processes(work, numbers, given.workers):
            if isinstance(outcome, Exception):
                case = draw(given.seed, number, logs())
                outcome = Outcome(case, Failure(f"death: {outcome!r}"), case)
            outcomes.append(outcome)
            if outcome.found and outcome.smallest:
                told = (f"FAILS {outcome.found.kind}", outcome.found.told, f"    {outcome.smallest.repeat}")
                print(*told, sep="\n", flush=True)
        print(f"{len(outcomes)} of {given.cases}, {time.monotonic() - began_s:.0f} s", flush=True)
    print(f"seed {given.seed}", table(outcomes), sep="\n")
    return int(any(found for _, found, _ in outcomes))


if __name__ == "__main__":
    sys.exit(main())
