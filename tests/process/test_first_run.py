"""The first run compiles with a word about it, later ones neither compile nor speak."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from advisor.process.first_run import compile_once


@pytest.fixture
def said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """What is told, with an empty folder for machine code."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "kernels"))
    monkeypatch.delenv("NUMBA_DISABLE_JIT", raising=False)
    return []


def test_the_first_run_tells_every_stage(said: list[str]) -> None:
    done: list[int] = []
    compile_once(said.append, {"one": lambda: done.append(1), "two": lambda: done.append(2)})
    assert done == [1, 2]
    assert said[1] == "First run: compiling the two for this machine (2 of 2)."


def test_the_second_run_is_silent(said: list[str]) -> None:
    done: list[int] = []
    for _ in range(2):
        compile_once(said.append, {"one": lambda: done.append(1)})
    assert (len(said), done) == (1, [1])


def test_a_run_that_was_stopped_is_begun_again(said: list[str]) -> None:
    def stopped() -> None:
        raise KeyboardInterrupt

    for _ in range(2):
        with pytest.raises(KeyboardInterrupt):
            compile_once(said.append, {"one": stopped})
    assert len(said) == 2


def test_where_nothing_can_be_kept_every_run_says_so(tmp_path, monkeypatch, said):
    (tmp_path / "a file").touch()
    monkeypatch.setattr("advisor.process.first_run._writable", lambda folder: False)
    compile_once(said.append, {"one": lambda: None})
    assert "Set NUMBA_CACHE_DIR" in said[-1]


def test_nothing_is_compiled_where_the_compiler_is_off(said, monkeypatch):
    monkeypatch.setenv("NUMBA_DISABLE_JIT", "1")
    compile_once(said.append)
    assert said == []


def test_a_check_of_a_simulator_waits_for_no_compiler(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "advisor", "simulator", "check", "linear"]
    inside = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    done = subprocess.run(command, env=inside, capture_output=True, encoding="utf-8", check=False)
    assert done.returncode == 2
    assert "First run" not in done.stderr
    assert "needs an air speed" in done.stderr
