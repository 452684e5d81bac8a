"""Start-up is cheap: help and a first paint do not wait for numerical libraries."""

import subprocess
import sys

import pytest

HEAVY = {"scipy", "matplotlib", "numba", "textual", "pymavlink", "jsbsim", "sim"}
HEAVY |= {"aiohttp", "jinja2", "textual_serve"}


def modules_after(statement: str) -> set[str]:
    code = f"import sys, contextlib\nwith contextlib.suppress(SystemExit):\n    {statement}\n"
    code += "print('\\n'.join(sys.modules), file=sys.stderr)"
    result = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=30, check=True
    )
    return set(result.stderr.split())


@pytest.mark.parametrize(
    "arguments",
    [["--help"], ["analyze", "--help"], ["live", "--help"], ["demo", "--help"], ["serve", "live", "--help"]],
)
def test_help_imports_no_heavy_library(arguments: list[str]) -> None:
    imported = modules_after(
        f"sys.argv = ['advisor', *{arguments}]; from advisor.cli.group import main; main()"
    )
    assert not imported.intersection(HEAVY)


def test_the_screens_wait_for_no_library_that_estimates() -> None:
    imported = modules_after(
        "import advisor.tui.app, advisor.cli.screen, advisor.session.remote; "
        "from tests.tui.flights import state; state(3)"  # all that a report is made of
    )
    assert {"textual.app", "advisor.decision.inputs"} <= imported
    assert not imported.intersection({"scipy", "numba", "pymavlink", "advisor.model.response"})


@pytest.mark.parametrize("module", ["advisor.analysis.gap", "advisor.campaign.campaign"])
def test_numbers_wait_for_no_library_that_takes_longer_to_import_than_its_use(module: str) -> None:
    imported = modules_after(f"import {module}")
    assert "scipy.linalg" in imported
    assert not imported.intersection({"scipy.signal", "scipy.stats", "scipy.interpolate", "scipy.optimize"})


def test_an_aircraft_file_without_effects_imports_no_catalogue_of_effects() -> None:
    imported = modules_after(
        "from pathlib import Path; from advisor.aircraft_file.read import load_aircraft; "
        "load_aircraft(Path('logs/arduplane-calm.yaml'))"
    )
    assert "advisor.aircraft_file.estimation" in imported
    assert not {name for name in imported if name.startswith("advisor.gap")}


def test_every_command_has_help_with_an_example() -> None:
    from click.testing import CliRunner

    from advisor.cli.group import COMMANDS, advisor

    for name in COMMANDS:
        result = CliRunner().invoke(advisor, [name, "--help"])
        assert result.exit_code == 0, name
        assert "Example:" in result.output, name
        assert f"advisor {name}" in result.output, name
