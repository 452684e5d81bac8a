"""Findings of roll and yaw as tables, from a hand-made state."""

from types import SimpleNamespace

import numpy as np
import pytest

from advisor.exports.flights.findings import findings
from tests.campaign.side_builders import estimate, judged, state

RECORD_OF = {(0, 0): 1}


def tables(lateral):
    """Return the tables of a flight without manoeuvres of the elevator, by name."""
    flown = SimpleNamespace(maneuvers=(), model=None, lateral=lateral)
    return {table.name: table for table in findings(flown, RECORD_OF)}


def column(table, name):
    (found,) = [one.values for one in table.columns if one.name == name]
    return found.tolist()


@pytest.fixture(scope="module")
def told():
    """Tables of a rudder doublet that is accepted, and an aileron doublet that is not."""
    both = (judged(1, "rudder"), judged(2, "aileron", accepted=False))
    return tables(state(*both, model=estimate("rudder")))


def test_manoeuvres_of_roll_and_yaw_have_a_table_of_their_own_with_their_verdicts(told):
    found = told["lateral_maneuvers"]
    assert column(found, "maneuver") == [1, 2]
    assert column(found, "input") == ["rudder doublet", "aileron doublet"]
    assert column(found, "accepted") == [True, False]
    assert all(np.isfinite(column(found, "rms_r")))


def test_the_joint_estimate_of_roll_and_yaw_is_number_0_with_units_and_covariances(told):
    found = told["lateral_estimates"]
    keys = list(zip(column(found, "maneuver"), column(found, "parameter"), strict=True))
    at = keys.index((0, "N_beta"))
    assert column(found, "unit")[at] == "1/s^2"
    assert column(found, "value")[at] == pytest.approx(2.9)
    assert column(found, "covariance_N_beta")[at] == pytest.approx(column(found, "std")[at] ** 2)


def test_residuals_are_those_of_the_accepted_manoeuvre(told):
    assert set(column(told["lateral_residuals_p"], "maneuver")) == {1}


def test_a_flight_without_manoeuvres_of_roll_and_yaw_has_no_table_of_them():
    assert not [name for name in tables(state()) if name.startswith("lateral")]
    assert not [name for name in tables(None) if name.startswith("lateral")]
