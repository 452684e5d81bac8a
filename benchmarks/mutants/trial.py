"""A copy of the tree, in which tests run on one mutant after the other."""

import os
import re
import resource
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from benchmarks.mutants.draw import Mutant

COPIED = ("advisor", "sim", "benchmarks", "tests", "docs", "logs", "pyproject.toml", "Makefile", "README.md")
LONGEST_S = 150
"""Longest processor time of the tests of one mutant, s; a changed module may compile kernels for 80 s."""
_PLUGINS = ("-p", "no:randomly", "-p", "no:cacheprovider", "-o", "timeout=600")
_PYTEST = ("-m", "pytest", "-x", "-q", "-rfE", "--tb=no", *_PLUGINS)
_FAILED = re.compile(r"^(?:FAILED|ERROR) (tests/.+?)(?: - |$)", re.MULTILINE)


class Trial:
    """The copy, and the tests that run in it, one process at low priority."""

    def __init__(self, root: Path, copy: Path) -> None:
        self._copy = copy
        for part in COPIED:
            source = root / part
            (shutil.copytree if source.is_dir() else shutil.copy2)(source, copy / part)
        assert not self._failing(["tests/test_walls.py"], None), "the tests do not run in the copy"

    def fate(self, mutant: Mutant, tests: Sequence[str]) -> str:
        """Return which test notices a mutant; empty where none does.

        A test that fails without the mutant as well notices nothing.
        """
        file = self._copy / mutant.file
        text = file.read_text(encoding="utf-8")
        file.write_text(mutant.change.apply(text), encoding="utf-8")
        try:
            noticed = self._failing(tests) if tests else ""
        finally:
            file.write_text(text, encoding="utf-8")
        if noticed and self._failing(tests if noticed == _NO_END else [noticed]):
            print(f"{noticed}: {' '.join(tests)} without a mutant as well")
            return ""
        return noticed

    def _failing(self, tests: Sequence[str], longest_s: int | None = LONGEST_S) -> str:
        """Return the first test that fails, or that the tests come to no end; empty where all pass."""
        run = subprocess.run(
            [sys.executable, "-B", *_PYTEST, *tests],
            cwd=self._copy,
            env={**os.environ, "PYTHONPATH": str(self._copy), "OPENBLAS_NUM_THREADS": "1"},
            capture_output=True,
            text=True,
            preexec_fn=lambda: _modest(longest_s),
        )
        if run.returncode == 0:
            return ""
        if run.returncode < 0:
            return _NO_END
        failed = _FAILED.search(run.stdout)
        return failed[1] if failed else _NO_END


_NO_END = "no end"


def _modest(longest_s: int | None) -> None:
    os.nice(10)
    if longest_s is not None:
        resource.setrlimit(resource.RLIMIT_CPU, (longest_s, longest_s))
