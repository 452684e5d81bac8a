"""Fields of a log by name: values, sums, and a refusal of an unknown name."""

from pathlib import Path

import numpy as np
import pytest

from advisor.analysis.field_sums import field_sums
from advisor.mavlink.logs.raw_fields import read_raw
from advisor.words.problems import ConfigurationError
from tests.conftest import Advisor

LOG = Path(__file__).parents[1] / "cases" / "base.bin"


def test_a_field_has_the_values_and_stamps_of_the_log():
    (roll,) = field_sums(LOG, ["ATT.Roll"])
    table = read_raw(LOG, ["ATT"])["ATT"]
    assert np.array_equal(roll.t, table.t)
    assert np.array_equal(roll.y, table.fields["Roll"])


def test_a_plus_sums_fields_also_of_two_messages_at_the_first_ones_stamps():
    outputs, mixed = field_sums(LOG, ["RCOU.C1+RCOU.C3", "ATT.Pitch+RCOU.C2"])
    table = read_raw(LOG, ["RCOU"])["RCOU"]
    assert np.array_equal(outputs.y, table.fields["C1"] + table.fields["C3"])
    pitch = read_raw(LOG, ["ATT"])["ATT"]
    moved = np.interp(pitch.t, table.t, table.fields["C2"])
    inside = np.isfinite(mixed.y)
    assert inside.mean() > 0.9
    assert mixed.y[inside] == pytest.approx((pitch.fields["Pitch"] + moved)[inside])


def test_an_unknown_field_is_refused_by_name_with_the_nearest_names():
    with pytest.raises(ConfigurationError, match=r"--field ATT\.Rol: base\.bin .*nearest: ATT\.Roll"):
        field_sums(LOG, ["ATT.Rol"])


def test_the_command_refuses_an_unknown_field_with_exit_code_2(advisor: Advisor, tmp_path: Path):
    result = advisor("report", LOG, "--field", "ATT.Rol", "-o", tmp_path / "page.html")
    assert result.returncode == 2
    assert "ATT.Roll" in result.stderr
    assert not (tmp_path / "page.html").exists()
