"""A test takes at most 2 s of processor time; the list of those that take longer only shrinks."""

from pathlib import Path

import pytest

from tests import conftest
from tests.conftest import SLOW

ROOT = Path(__file__).parents[1]


def test_the_list_does_not_grow() -> None:
    assert len(SLOW) <= 48
    assert len(set(SLOW)) == len(SLOW)


@pytest.mark.parametrize("line", SLOW)
def test_each_line_is_the_beginning_of_a_test_that_exists(line: str) -> None:
    path, _, name = line.partition("::")
    assert (ROOT / path).exists()
    assert not name or f"def {name}(" in (ROOT / path).read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("taken_s", "slowness", "fails"),
    [(5.9, 1.0, False), (6.1, 1.0, True), (12.1, 2.1, False), (12.2, 2.0, True)],
)
def test_a_test_that_takes_thrice_as_long_on_a_quiet_core_fails(
    taken_s: float,
    slowness: float,
    fails: bool,
    request: pytest.FixtureRequest,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    times = iter([10.0, 10.0 + taken_s])
    with monkeypatch.context() as patch:
        patch.setattr(conftest, "processor_time_s", lambda: next(times))
        patch.setattr(conftest, "slowness", lambda: slowness)
        running = conftest.pytest_runtest_call(request.node)
        next(running)
        with pytest.raises(pytest.fail.Exception if fails else StopIteration) as ended:
            next(running)
    assert not fails or "This test takes 6.1 s of processor time" in str(ended.value)
