"""Damaged logs of every kind, through the whole analysis: a document and an exit code, never a traceback.

``make test`` takes some tens of cases of each kind, ``make damage`` thousands (DAMAGE_CASES). DAMAGE_SEED
draws other damage.
"""

import json
import os
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from advisor.flight.signals.messages import Columns
from advisor.mavlink.logs.logs import open_log
from advisor.words.problems import Problem, UnusableInputError
from tests.conftest import Advisor

CASES = int(os.environ.get("DAMAGE_CASES", "40"))
"""Cases of each kind of log that are read; one in twenty is analysed by the command as well."""
SEED = int(os.environ.get("DAMAGE_SEED", "0"))
FLIGHTS = Path(__file__).parent / "cases"


@cache
def sound(kind: str) -> bytes:
    """One flight, cut to a manoeuvre, as a log of this kind."""
    return (FLIGHTS / {"tlog": "t_base.tlog", "bin": "base.bin", "ulg": "u_base.ulg"}[kind]).read_bytes()


# What happens to files. Each takes the bytes and a random generator.


def cut_short(log: bytearray, rng: np.random.Generator) -> None:
    del log[rng.integers(len(log)) :]


def flip_bits(log: bytearray, rng: np.random.Generator) -> None:
    for at in rng.integers(len(log), size=rng.integers(1, 200)):
        log[at] ^= 1 << rng.integers(8)


def block(log: bytearray, rng: np.random.Generator) -> slice:
    start = int(rng.integers(len(log)))
    return slice(start, start + int(rng.integers(1, 8192)))


def lose_a_block(log: bytearray, rng: np.random.Generator) -> None:
    del log[block(log, rng)]


def repeat_a_block(log: bytearray, rng: np.random.Generator) -> None:
    again = log[block(log, rng)]
    at = int(rng.integers(len(log)))
    log[at:at] = again


def swap_blocks(log: bytearray, rng: np.random.Generator) -> None:
    a, b = block(log, rng), block(log, rng)
    log[a], log[b] = log[b], log[a]


def zeros(log: bytearray, rng: np.random.Generator) -> None:
    hole = block(log, rng)
    log[hole] = bytes(len(log[hole]))


def noise(log: bytearray, rng: np.random.Generator) -> None:
    at = int(rng.integers(len(log) + 1))
    log[at:at] = rng.bytes(int(rng.integers(1, 4096)))


def text_in_front(log: bytearray, rng: np.random.Generator) -> None:
    log[:0] = b"INFO something was printed here\n" * int(rng.integers(1, 5))


DAMAGES: list[Callable[[bytearray, np.random.Generator], None]] = [
    cut_short,
    flip_bits,
    lose_a_block,
    repeat_a_block,
    swap_blocks,
    zeros,
    noise,
    text_in_front,
]


def damaged(kind: str, seed: int, damages: list[int]) -> bytes:
    log, rng = bytearray(sound(kind)), np.random.default_rng([SEED, seed, *damages])
    for damage in damages:
        if log:
            DAMAGES[damage](log, rng)
    return bytes(log)


def read(path: Path) -> list[Columns] | Problem:
    """The messages of a log, or why there are none."""
    try:
        return [c for batch in open_log(path) for c in batch]
    except UnusableInputError as error:
        return error.problem


any_damage = st.lists(st.integers(0, len(DAMAGES) - 1), min_size=1, max_size=4)
seeds = st.integers(0, 2**32 - 1)
thoroughly = settings(
    max_examples=CASES,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
hardly = settings(thoroughly, max_examples=max(2, CASES // 20))


@pytest.mark.parametrize("kind", ["bin", "ulg", "tlog"])
@thoroughly
@given(seed=seeds, damages=any_damage)
def test_a_damaged_log_is_read_or_refused_in_a_sentence(kind, tmp_path, seed, damages):
    path = tmp_path / f"flight.{kind}"
    path.write_bytes(damaged(kind, seed, damages))
    found = read(path)
    if isinstance(found, Problem):
        assert found.text.endswith(".")
        assert found.fix.endswith(".")
        assert found.code != "damaged", (
            "the reader has met bytes, or a warning of NumPy, that it does not know"
        )
        return
    for c in found:
        assert len(c) == len(c.arrival_s) == len(c.order)
        assert np.all(np.diff(c.order) > 0)
        assert all(len(values) == len(c) for values in c.fields.values())


@pytest.mark.parametrize("kind", ["bin", "ulg", "tlog"])
@hardly
@given(seed=seeds, damages=any_damage)
def test_the_analysis_of_a_damaged_log_ends_in_a_document_and_an_exit_code_of_the_contract(
    kind: str, tmp_path: Path, advisor: Advisor, seed: int, damages: list[int]
) -> None:
    path = tmp_path / f"flight.{kind}"
    path.write_bytes(damaged(kind, seed, damages))
    result = advisor("analyze", path, "--json")
    document = json.loads(result.stdout)
    assert result.returncode == (0 if document["usable"] else 3)
    assert "Traceback" not in result.stderr


@pytest.mark.parametrize("kind", ["bin", "ulg"])
@settings(thoroughly, max_examples=max(5, CASES // 10))
@given(cut=st.floats(0.3, 1.0))
def test_what_lies_before_a_cut_is_read_as_before(kind: str, tmp_path: Path, cut: float) -> None:
    whole, part = tmp_path / f"whole.{kind}", tmp_path / f"part.{kind}"
    whole.write_bytes(sound(kind))
    part.write_bytes(sound(kind)[: round(cut * len(sound(kind)))])
    every, some = ({c.name: c for batch in open_log(path) for c in batch} for path in (whole, part))
    expected, found = every["HIGHRES_IMU"], some["HIGHRES_IMU"]
    n = len(found)
    assert n >= round(cut * 0.9 * len(expected))
    for name, values in found.fields.items():
        np.testing.assert_array_equal(values[: n - 1], expected.fields[name][: n - 1])
