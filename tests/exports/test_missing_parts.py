"""An export that a fault ends is named, and the other files are written."""

from typing import Any, NoReturn

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.exports.flights import mat_file, mcap_files
from advisor.exports.flights.formats import write_formats
from advisor.exports.models.flown import FlownModel
from advisor.exports.models.formats import ardupilot_format, matlab_format
from advisor.exports.models.improvement import Exported
from advisor.exports.models.write import carry_out, order_of

NO_DATA: Any = None


def fails(*_: object) -> NoReturn:
    raise np.linalg.LinAlgError("Singular matrix")


def test_a_format_that_fails_is_named_and_the_next_one_is_written(monkeypatch, tmp_path):
    monkeypatch.setattr(mat_file, "write_mat", fails)
    monkeypatch.setattr(mcap_files, "write_mcap", lambda data, folder: (folder / "x.mcap").touch())
    (failed,) = write_formats(NO_DATA, tmp_path, ("mat", "mcap"))
    assert failed.part == "export mat"
    assert failed.reason == "LinAlgError: Singular matrix"
    assert (tmp_path / "x.mcap").exists()


def test_a_fault_that_is_none_of_numbers_ends_the_export(monkeypatch, tmp_path):
    def broken(*_: object) -> NoReturn:
        raise TypeError("no number")

    monkeypatch.setattr(mat_file, "write_mat", broken)
    with pytest.raises(TypeError):
        write_formats(NO_DATA, tmp_path, ("mat",))


def test_a_model_that_cannot_be_written_is_named_and_the_next_one_is_written(monkeypatch, tmp_path):
    monkeypatch.setattr(matlab_format, "both_axes_text", fails)
    monkeypatch.setattr(ardupilot_format, "parameters_text", lambda _: Exported("SERVO2_RATE 50\n"))
    orders = [order_of(f"matlab:{tmp_path}/model.m"), order_of(f"ardupilot:{tmp_path}/servo.parm")]
    failed, written = carry_out(orders, FlownModel(Aircraft(), None, None))
    assert "A fault of the advisor, not yours, ended this part: export matlab" in failed.problem
    assert "LinAlgError: Singular matrix" in failed.problem
    assert not (tmp_path / "model.m").exists()
    assert written.problem == ""
    assert (tmp_path / "servo.parm").read_text(encoding="utf-8") == "SERVO2_RATE 50\n"
