"""Mutants of deciding numbers and shown numbers: each is killed by tests that take milliseconds.

    python -m benchmarks.mutants [WORD ...]

A copy of the tree takes one mutant after the other, and the named tests must fail on each. Without a mutant
the tests must pass. A WORD restricts the run to the mutants whose file contains the word.
"""

import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[1]
COPIED = ("advisor", "sim", "benchmarks", "tests", "docs", "logs", "pyproject.toml")
LONGEST_S = 60
"""Longest processor time of the tests on one mutant, s."""


@dataclass(frozen=True)
class Mutant:
    """One change of one line, and the tests that must notice."""

    file: str
    old: str
    new: str
    tests: str


MUTANTS = (
    Mutant("gap/search/score.py", "0.5 * numbers *", "0.1 * numbers *", "gap/test_price.py"),
    Mutant("gap/search/score.py", "1 if variant.fixed", "0 if variant.fixed", "gap/test_price.py"),
    Mutant(
        "gap/judge/logit.py", "prior.of(kind) / self.flown.of(kind)", "prior.of(kind)", "gap/test_judge.py"
    ),
    Mutant("gap/judge/posterior.py", "CREDIBLE = 0.9", "CREDIBLE = 0.5", "gap/test_judge.py"),
    Mutant(
        "gap/judge/why.py", "[: MOST_LINES - 1], lines[MOST_LINES - 1 :]", "[:2], []", "gap/test_judge.py"
    ),
    Mutant("gap/verdict/judgement.py", "_MOSTLY = 0.98", "_MOSTLY = 0.6", "gap/test_verdicts.py"),
    Mutant("gap/verdict/judgement.py", "not derivatives.are_imitated and", "", "gap/test_verdicts.py"),
    Mutant(
        "gap/uncatalogued/wind_shear.py",
        "_LEAST_SHARE = 0.17",
        "_LEAST_SHARE = 0.05",
        "gap/test_wind_shear.py",
    ),
    Mutant(
        "gap/uncatalogued/sensor_jumps.py", "_JUMPS = 0.005", "_JUMPS = 0.001", "gap/test_sensor_jumps.py"
    ),
    Mutant(
        "gap/records/floor.py",
        "STATED_FLOOR_MARGIN = 2.5",
        "STATED_FLOOR_MARGIN = 1.0",
        "gap/test_sensor_jumps.py",
    ),
    Mutant("gap/decision.py", "LEAST_GAIN = 6.0", "LEAST_GAIN = 1.0", "gap/test_additions.py"),
    Mutant("gap/decision.py", "LEAST_SIGMA = 3.0", "LEAST_SIGMA = 1.0", "gap/test_additions.py"),
    Mutant("gap/decision.py", "CERTAIN = 30.0", "CERTAIN = 20.0", "gap/test_additions.py"),
    Mutant(
        "oem/estimator.py",
        "covariance=best.covariance[:N, :N]",
        "covariance=len(best.contributions) * best.covariance[:N, :N]",
        "oem/test_joint_errors.py",
    ),
    Mutant(
        "oem/covariance.py",
        "own_inverse[at] @ weighted / len(parts)",
        "own_inverse[at] @ weighted",
        "oem/test_joint_errors.py",
    ),
    Mutant("oem/between.py", "CHANCE = 0.05", "CHANCE = 0.5", "oem/test_joint_errors.py"),
    Mutant(
        "exports/models/matlab.py", "{1.0 + m['Z_q']:.8g}", "{m['Z_q']:.8g}", "exports/models/test_matlab.py"
    ),
    Mutant(
        "exports/models/matlab.py",
        "V*({m['Z_q']:.8g})",
        "V*({1.0 + m['Z_q']:.8g})",
        "exports/models/test_matlab.py",
    ),
    Mutant(
        "exports/models/ardupilot.py",
        'lift * c["C_L_q"]',
        'lift * (1.0 + c["C_L_q"])',
        "exports/models/test_ardupilot.py",
    ),
    Mutant(
        "words/quantiles.py",
        "NORMAL_95 = 1.959963984540054",
        "NORMAL_95 = 1.0",
        "exports/models/test_matlab.py",
    ),
    Mutant("exports/models/sdf.py", "wing_zero = (c", "wing_zero = (0.9 * c", "exports/models/test_sdf.py"),
    Mutant("model/mil_f_8785c.py", "(0.25, 2.00), (0.096", "(0.25, 2.00), (0.15", "model"),
    Mutant("model/mil_f_8785c.py", "(0.20, 2.00), (0.038", "(0.20, 2.00), (0.05", "model"),
    Mutant(
        "doctor/pace.py", "hz * period_s, fewest_hz", "0.5 * hz * period_s, fewest_hz", "doctor/test_pace.py"
    ),
    Mutant("doctor/pace.py", "FALLEN = 0.6", "FALLEN = 0.3", "doctor/test_pace.py"),
    Mutant("doctor/pace.py", "GAP_INTERVALS = 3.0", "GAP_INTERVALS = 9.0", "doctor/test_pace.py"),
    Mutant("web/password.py", "& 0o077", "& 0o007", "web/test_password.py"),
    Mutant(
        "decision/acceptance.py",
        "ALLOWED_INCREASE = 2.0",
        "ALLOWED_INCREASE = 3.0",
        "decision/test_acceptance.py",
    ),
    Mutant("decision/tolerance.py", "SHARE = 2.0", "SHARE = 3.0", "decision/test_tolerance.py"),
    Mutant(
        "decision/scatter.py", "SCATTER_FACTOR = 5.0", "SCATTER_FACTOR = 50.0", "decision/test_scatter.py"
    ),
    Mutant("report/qualities.py", "NORMAL_95 * one.std", "one.std", "report/test_intervals.py"),
    Mutant(
        "report/result_rows.py",
        "NORMAL_95 * quantity.factor",
        "quantity.factor",
        "report/test_intervals.py",
    ),
)


def main(words: list[str]) -> int:
    """Print the fate of every mutant; 1 where one lives, or where tests fail without a mutant."""
    mutants = [mutant for mutant in MUTANTS if not words or any(word in mutant.file for word in words)]
    with tempfile.TemporaryDirectory() as name:
        copy = Path(name)
        for part in COPIED:
            source = ROOT / part
            (shutil.copytree if source.is_dir() else shutil.copy2)(source, copy / part)
        found = [_fails(copy, {mutant.tests for mutant in mutants})]
        print("without a mutant:", "tests FAIL" if found[0] else "tests pass")
        for mutant in mutants:
            began_s = time.monotonic()
            found.append(not _dies(copy, mutant))
            fate = "LIVES" if found[-1] else "dies"
            print(
                f"{fate:5}  {time.monotonic() - began_s:4.1f} s  {mutant.file}: {mutant.old} -> {mutant.new}"
            )
    return int(any(found))


def _dies(copy: Path, mutant: Mutant) -> bool:
    file = copy / "advisor" / mutant.file
    text = file.read_text(encoding="utf-8")
    assert text.count(mutant.old) == 1, f"{mutant.file} has {text.count(mutant.old)} times {mutant.old!r}"
    file.write_text(text.replace(mutant.old, mutant.new), encoding="utf-8")
    try:
        return _fails(copy, {mutant.tests})
    finally:
        file.write_text(text, encoding="utf-8")


def _fails(copy: Path, tests: set[str]) -> bool:
    """Return whether some test fails, within ``LONGEST_S`` of processor time."""
    command = [
        sys.executable,
        "-B",
        "-m",
        "pytest",
        "-x",
        "-q",
        "-p",
        "no:randomly",
        "-p",
        "no:cacheprovider",
    ]
    run = subprocess.run(
        [*command, *(f"tests/{one}" for one in sorted(tests))],
        cwd=copy,
        env={**os.environ, "PYTHONPATH": str(copy)},
        capture_output=True,
        text=True,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (LONGEST_S, LONGEST_S)),
    )
    assert run.returncode in (0, 1), run.stdout + run.stderr  # others: no test was run, or it took too long
    return run.returncode == 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
