"""What tests of every folder may ask for, and the limit of what they may take."""

import gc
import os
import signal
import sys
from collections.abc import Callable, Generator, Iterator
from contextlib import suppress
from functools import _lru_cache_wrapper
from importlib import import_module
from pathlib import Path
from subprocess import CompletedProcess
from time import process_time
from typing import Any

import pytest

from advisor.bundled.demo import Demonstration
from advisor.cli import group as cli
from advisor.process.first_run import compile_once

Advisor = Callable[..., "CompletedProcess[str]"]
"""Called with the words that follow ``advisor`` on the command line."""

# A shell has the programs that it starts in the background ignore Ctrl-C, which tests send to programs.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

# Children look for no module in the current folder, but some are given what tests define.
os.environ["PYTHONPATH"] = os.pathsep.join(
    [str(Path(__file__).parents[1]), *filter(None, [os.environ.get("PYTHONPATH")])]
)

MOST_DIAGNOSES = 10
"""Whole diagnoses of flights that all tests without the mark ``study`` may make, seconds each.

A gap of several manoeuvres takes two: the second search leaves out the manoeuvres that measure the shrink."""

MOST_S = 2.0
"""Processor time that a test may take on a quiet machine, s; what fixtures prepare does not count."""
NOISE = 3.0
"""Factor by which a test may exceed that limit, because processes that share a core cost each other time."""
SUM_S = 0.08
"""Processor time of the sum in `slowness` on the quiet core that ``MOST_S`` speaks of, s."""
SLOW = tuple(
    line
    for line in (Path(__file__).parent / "slow.txt").read_text(encoding="utf-8").splitlines()
    if line.startswith("tests/")
)
"""Beginnings of the names of tests that may take longer. The list only shrinks."""


def pytest_sessionstart(session: pytest.Session) -> None:
    """Compile every kernel before the first test, because no test's time limit allows for it."""
    if not hasattr(session.config, "workerinput"):
        compile_once(print)
        compile_once(print, {"bundled aircraft": Demonstration.fly_once})
    elif session.config.args == ["tests"]:
        _import_from_another_place(session.config.workerinput)


def _import_from_another_place(process: dict[str, Any]) -> None:
    """Import all test files, each process beginning at another one.

    Each file's assertions are rewritten at its first import. The processes share that work and its results.
    """
    files = sorted(Path(__file__).parent.rglob("test_*.py"))
    begin = len(files) * int(process["workerid"].removeprefix("gw")) // process["workercount"]
    for path in [*files[begin:], *files[:begin]]:
        with suppress(Exception, pytest.skip.Exception):  # collection says what is wrong
            import_module(".".join(("tests", *path.relative_to(Path(__file__).parent).with_suffix("").parts)))


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems() -> None:
    """Have hypothesis draw no numbers from the code, whose search takes seconds in each process.

    What a test draws then depends on no other module.
    """
    if "hypothesis" in sys.modules:
        from hypothesis.internal.conjecture import providers

        providers._get_local_constants = lambda: providers._local_constants


def pytest_collection_finish() -> None:
    """Have no application find a program that speaks, and no collection of garbage examine all imports.

    Such a collection takes a third of a second.
    """
    if sound := sys.modules.get("advisor.tui.sound"):
        sound._PROGRAMS = ()  # type: ignore[attr-defined]
    gc.freeze()


def pytest_sessionfinish() -> None:
    """Examine all objects once for errors in what nobody holds any more, and not five times."""
    gc.collect()
    gc.freeze()


def pytest_itemcollected(item: pytest.Item) -> None:
    """Keep tests in one process that share results of their module or of their package."""
    if item.get_closest_marker("xdist_group") or not isinstance(item, pytest.Function):
        return
    name = item.module.__name__
    values = [value for value in vars(item.module).values() if isinstance(value, _lru_cache_wrapper)]
    fixtures = [found[-1].scope for found in item._fixtureinfo.name2fixturedefs.values()]
    if "package" in fixtures:
        item.add_marker(pytest.mark.xdist_group(item.module.__package__))
    elif "module" in fixtures or any(value.__module__ == name for value in values):
        item.add_marker(pytest.mark.xdist_group(name))


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Generator[None, None, None]:
    """Let a test fail that takes more processor time than a test may."""
    before_s = processor_time_s()
    yield
    taken_s = processor_time_s() - before_s
    if item.nodeid.startswith(SLOW) or item.get_closest_marker("study") or taken_s <= MOST_S * NOISE:
        return
    quiet_s = taken_s / slowness()
    if quiet_s > MOST_S * NOISE:
        pytest.fail(
            f"This test takes {quiet_s:.1f} s of processor time, and {MOST_S:.0f} s are the most: make it "
            "faster, or mark it with study.",
            pytrace=False,
        )


def slowness() -> float:
    """Ratio, 1 or more, of the time that a known sum takes at present to its time on a quiet core."""
    before_s = process_time()
    sum(k * k % 7 for k in range(1_000_000))
    return max(1.0, (process_time() - before_s) / SUM_S)


def processor_time_s() -> float:
    """Processor time of this process and of its children that have ended."""
    return sum(os.times()[:4])


@pytest.fixture
def advisor(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Advisor:
    """The command with all that ends it, in this process: starting another takes longer than most calls."""

    def call(*arguments: object) -> CompletedProcess[str]:
        monkeypatch.setattr("sys.argv", ["advisor", *map(str, arguments)])
        with pytest.raises(SystemExit) as ended:
            cli.main()
        assert isinstance(ended.value.code, int)
        return CompletedProcess("advisor", ended.value.code, *capsys.readouterr())

    return call


@pytest.fixture
def recorded_analyses(monkeypatch: pytest.MonkeyPatch) -> None:
    """Commands in this process read analyses that other tests of this run have made of the same logs."""
    from tests.recorded import use_recorded

    use_recorded(monkeypatch)


@pytest.fixture(scope="session", autouse=True)
def recorded_estimates() -> Iterator[None]:
    """Campaigns read estimates that other tests of this run have made of the same samples."""
    from tests.recorded import record_estimates

    with pytest.MonkeyPatch.context() as patch:
        record_estimates(patch)
        yield


@pytest.fixture(scope="session", autouse=True)
def few_diagnoses(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Let the whole diagnosis fail that is one too many, in whichever process of this run.

    Every diagnosis adds a byte to a file that all processes share. Runs of studies have no limit.
    """
    if request.config.getoption("markexpr") != "not study":
        yield
        return
    from advisor.gap import diagnose

    own = tmp_path_factory.getbasetemp()
    made = (own.parent if hasattr(request.config, "workerinput") else own) / "diagnoses"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(diagnose, "answer_of", counted(diagnose.answer_of, made))
        yield


def counted(answer: Callable[..., Any], made: Path) -> Callable[..., Any]:
    """The answer that ends a diagnosis, counted in the file before."""

    def one_more(*arguments: Any) -> Any:
        with made.open("ab", buffering=0) as file:
            file.write(b".")
            count = file.tell()
        assert count <= MOST_DIAGNOSES, (
            f"The tests make more than {MOST_DIAGNOSES} whole diagnoses: mark this one with study."
        )
        return answer(*arguments)

    return one_more
