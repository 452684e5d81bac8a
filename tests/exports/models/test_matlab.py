"""The script for MATLAB and Octave: run by Octave, its matrices are those of the model found."""

import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from advisor.exports.models.formats.matlab_format import script_text
from advisor.exports.models.improvement import ExportedServo
from tests.exports.models.cases import MODEL, improvement

OCTAVE = shutil.which("octave-cli")
SPEED = 25.0


def run(folder: Path, asked: str, **changes: object) -> list[float]:
    """What Octave prints of an expression after it has run the script."""
    script = folder / "model.m"
    script.write_text(script_text(improvement(**changes)).text)
    code = f"run('{script}'); printf('%.12g\\n', {asked});"
    assert OCTAVE is not None
    done = subprocess.run(
        [OCTAVE, "--norc", "--quiet", "--eval", code], capture_output=True, text=True, timeout=60, check=True
    )
    return [float(line) for line in done.stdout.split()]


needs_octave = pytest.mark.skipif(OCTAVE is None, reason="octave-cli is not installed on this machine")


@needs_octave
def test_octave_finds_the_eigenvalues_that_numpy_finds(tmp_path):
    m = MODEL
    known = np.linalg.eigvals(np.array([[m["Z_alpha"], 1.0 + m["Z_q"]], [m["M_alpha"], m["M_q"]]]))
    found = run(tmp_path, "[real(eig(A)); imag(eig(A))]")
    assert sorted(found[2:]) == pytest.approx(sorted(known.imag), rel=1e-7)
    assert found[:2] == pytest.approx(known.real, rel=1e-7)


@needs_octave
def test_octave_reads_input_outputs_and_feedthrough(tmp_path):
    m = MODEL
    rows = [1.0, 0.0, SPEED * m["Z_alpha"], 0.0, 1.0, SPEED * m["Z_q"]]
    expected = [m["Z_delta_e"], m["M_delta_e"], *rows, 0.0, 0.0, SPEED * m["Z_delta_e"]]
    assert run(tmp_path, "[B(:); C(:); D(:)]") == pytest.approx(expected)


@needs_octave
def test_octave_reads_each_parameter_with_its_interval(tmp_path):
    asked = "[parameters.M_alpha.value, parameters.M_alpha.ci95, parameters.Z_0.value]"
    half = 1.96 * abs(MODEL["M_alpha"]) / 50.0
    expected = [MODEL["M_alpha"], MODEL["M_alpha"] - half, MODEL["M_alpha"] + half, MODEL["Z_0"]]
    assert run(tmp_path, asked) == pytest.approx(expected)


@needs_octave
def test_octave_reads_the_servo_as_numbers_of_its_own(tmp_path):
    servo = ExportedServo(delay_s=0.03, lag_s=0.08, play_rad=0.01)
    asked = "[servo.delay_s, servo.lag_s, servo.backlash_rad, isinf(servo.rate_limit_rad_s)]"
    assert run(tmp_path, asked, servo=servo) == pytest.approx([0.03, 0.08, 0.01, 1.0])


def matrix(name: str) -> np.ndarray:
    """A matrix of the script, read without Octave: semicolons end rows, commas end columns."""
    text = next(
        line for line in script_text(improvement()).text.splitlines() if line.startswith(f"{name} = [")
    )
    rows = text.removeprefix(f"{name} = [").removesuffix("];").split(";")
    return np.array([[product(entry) for entry in row.split(",")] for row in rows])


def product(entry: str) -> float:
    """The value of a number, or of V times a number in brackets."""
    return SPEED * float(entry.strip()[3:-1]) if "V*" in entry else float(entry)


def test_the_matrices_are_the_state_space_of_the_eight_parameters() -> None:
    """α̇ = Z_α·α + (1 + Z_q)·q + Z_δe·δe, and a_z = V·(α̇ - q)."""
    m = MODEL
    assert matrix("A") == pytest.approx(np.array([[m["Z_alpha"], 1.0 + m["Z_q"]], [m["M_alpha"], m["M_q"]]]))
    assert matrix("B") == pytest.approx(np.array([[m["Z_delta_e"]], [m["M_delta_e"]]]))
    normal = [SPEED * m["Z_alpha"], SPEED * m["Z_q"]]
    assert matrix("C") == pytest.approx(np.array([[1.0, 0.0], [0.0, 1.0], normal]))
    assert matrix("D") == pytest.approx(np.array([[0.0], [0.0], [SPEED * m["Z_delta_e"]]]))


def test_each_parameter_is_written_with_its_interval() -> None:
    written = dict(re.findall(r"parameters\.(\w+\.\w+) = (.*?);", script_text(improvement()).text))
    for name, value in MODEL.items():
        half = 1.96 * abs(value) / 50.0
        assert float(written[f"{name}.value"]) == pytest.approx(value)
        interval = [float(end) for end in written[f"{name}.ci95"].strip("[]").split(",")]
        assert interval == pytest.approx([value - half, value + half])


def test_each_of_the_eight_parameters_has_a_unit_in_its_comment():
    lines = [line for line in script_text(improvement()).text.splitlines() if ".value = " in line]
    units = [line.split("%")[1].strip() for line in lines]
    assert units == ["rad/s", "1/s", "1", "1/s", "rad/s^2", "1/s^2", "1/s", "1/s^2"]


def test_an_effect_that_no_matrix_carries_is_listed():
    assert script_text(improvement(effects={"turbulence": {}})).left_out == ("turbulence",)
