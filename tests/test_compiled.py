"""Machine code is kept for as long as all that it was compiled from is the same, and no longer."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

# One compilation comes before what all tests change of its sources.
pytestmark = pytest.mark.xdist_group("compiled")

ROOT = Path(__file__).parents[1]

_CALL = """
import sys
sys.path[:0] = sys.argv[1:]
from flown.motion import moved
print(moved(1.0), sum(moved.stats.cache_hits.values()))
"""


@pytest.fixture(scope="module")
def compiled(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder in which the kernel was compiled."""
    folder = tmp_path_factory.mktemp("compiled")
    _write(folder, factor=2.0)
    assert _call(folder) == (2.0, 0)
    return folder


@pytest.fixture
def folder(compiled: Path, tmp_path: Path) -> Path:
    """That folder with its machine code, for a test to change."""
    return shutil.copytree(compiled, tmp_path / "copy")


def test_a_kernel_is_loaded_where_nothing_changed(folder: Path) -> None:
    assert _call(folder) == (2.0, 1)


def test_a_kernel_is_compiled_anew_after_a_change_of_a_constant_of_another_module(folder: Path) -> None:
    _write(folder, factor=3.0)
    assert _call(folder) == (3.0, 0)


def test_a_kernel_is_compiled_anew_after_a_change_two_imports_away(folder: Path) -> None:
    _write(folder, factor=2.0, unit=10.0)
    assert _call(folder) == (20.0, 0)


def test_a_kernel_is_loaded_after_a_change_of_a_module_that_it_does_not_import(folder: Path) -> None:
    (folder / "flown" / "other.py").write_text("ELSEWHERE = 1.0\n")
    assert _call(folder) == (2.0, 1)


def _write(folder: Path, *, factor: float, unit: float = 1.0) -> None:
    """A package of a kernel, the constant that the kernel reads, and the constant which that is made of."""
    package = folder / "flown"
    package.mkdir(exist_ok=True)
    (package / "__init__.py").write_text("")
    (package / "unit.py").write_text(f"UNIT = {unit}\n")
    (package / "factor.py").write_text(f"from flown import unit\n\nFACTOR = {factor} * unit.UNIT\n")
    (package / "motion.py").write_text(
        "from advisor.compiled import kernel\nfrom flown.factor import FACTOR\n\n\n"
        "@kernel()\ndef moved(x):\n    return FACTOR * x\n"
    )


def _call(folder: Path) -> tuple[float, int]:
    """What the kernel makes of 1 in a new process, and how often its machine code was loaded."""
    run = subprocess.run(
        [sys.executable, "-B", "-c", _CALL, str(folder), str(ROOT)],
        capture_output=True,
        text=True,
        check=True,
    )
    value, loaded = run.stdout.split()
    return float(value), int(loaded)
