"""Machine code is kept for as long as all that it was compiled from is the same, and no longer."""

import os
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

# One compilation comes before what all tests change of its sources.
pytestmark = pytest.mark.xdist_group("compiled")

ROOT = Path(__file__).parents[2]

_CALL = """
import os, resource, sys
sys.path[:0] = sys.argv[1:]
if "at_most" in os.environ:  # bytes of a file, as on a full disk
    resource.setrlimit(resource.RLIMIT_FSIZE, (int(os.environ["at_most"]), resource.RLIM_INFINITY))
from flown.motion import moved
print(moved(1.0), sum(moved.stats.cache_hits.values()))
"""


@pytest.fixture(scope="module")
def compiled(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder in which the kernel was compiled."""
    folder = tmp_path_factory.mktemp("compiled")
    _write(folder, unit=1.0)
    assert _call(folder) == (2.0, 0)
    return folder


@pytest.fixture
def folder(compiled: Path, tmp_path: Path) -> Path:
    """That folder with its machine code, for a test to change."""
    return shutil.copytree(compiled, tmp_path / "copy")


def test_a_kernel_is_compiled_anew_after_a_change_at_the_end_of_a_chain_of_imports(folder: Path) -> None:
    _write(folder, unit=10.0)
    assert _call(folder) == (20.0, 0)


def test_a_kernel_runs_where_no_folder_can_keep_its_machine_code(folder: Path) -> None:
    shutil.rmtree(folder / "flown" / "__pycache__")
    nowhere = folder / "a file"
    nowhere.touch()
    (folder / "flown" / "__pycache__").touch()  # a file in the way: not even root can write into it
    assert _call(folder, NUMBA_CACHE_DIR="", HOME=str(nowhere), XDG_CACHE_HOME=str(nowhere)) == (2.0, 0)


def test_a_full_disk_keeps_no_machine_code_and_never_calls_old_code_fresh(folder: Path) -> None:
    _write(folder, unit=10.0)
    assert _call(folder, at_most="2000") == (20.0, 0)
    assert _call(folder) == (20.0, 0)
    assert _call(folder) == (20.0, 1)


@pytest.mark.parametrize("kind", ["nbi", "nbc"])
def test_a_file_of_machine_code_that_is_cut_off_is_written_again(folder: Path, kind: str) -> None:
    (file,) = (folder / "flown" / "__pycache__").glob(f"*.{kind}")
    file.write_bytes(file.read_bytes()[:-20])
    assert _call(folder) == (2.0, 0)
    assert _call(folder) == (2.0, 1)


def test_a_kernel_is_loaded_where_only_a_module_changed_that_it_does_not_import(folder: Path) -> None:
    (folder / "flown" / "other.py").write_text("ELSEWHERE = 1.0\n")
    assert _call(folder) == (2.0, 1)


def test_the_contract_of_imports_names_every_module_with_a_compiled_function() -> None:
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]["contracts"]
    (named,) = (one["source_modules"] for one in contracts if one["name"].startswith("Compiled functions"))
    texts = {file: file.read_text() for room in ("advisor", "sim") for file in (ROOT / room).rglob("*.py")}
    compiled = {
        file.relative_to(ROOT).with_suffix("") for file, text in texts.items() if "\n@kernel(" in text
    }
    assert len(compiled) > 10
    assert {".".join(path.parts) for path in compiled} <= set(named)


def _write(folder: Path, *, unit: float) -> None:
    """A package of a kernel that reads a constant, which is made of others by every form of import."""
    package = folder / "flown"
    package.mkdir(exist_ok=True)
    (package / "__init__.py").write_text("")
    (package / "unit.py").write_text(f"UNIT = {unit}\n")
    (package / "double.py").write_text("from flown import unit\n\nDOUBLE = 2.0 * unit.UNIT\n")
    (package / "factor.py").write_text("from flown.double import DOUBLE\n\nFACTOR = DOUBLE\n")
    (package / "motion.py").write_text(
        "from advisor.process.compiled import kernel\nfrom .factor import FACTOR\n\n\n"
        "@kernel()\ndef moved(x):\n    return FACTOR * x\n"
    )


def _call(folder: Path, **environment: str) -> tuple[float, int]:
    """What the kernel makes of 1 in a new process, and how often its machine code was loaded."""
    run = subprocess.run(
        [sys.executable, "-B", "-c", _CALL, str(folder), str(ROOT)],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, **environment},
    )
    value, loaded = run.stdout.split()
    return float(value), int(loaded)
