"""Which simulator the lateral gap is compared with, by the aircraft file's ``simulator``."""

from types import SimpleNamespace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis import axis_flown as side_gap
from advisor.gap.result import Diagnosis, Gap
from advisor.words.problems import ConfigurationError

STATE = SimpleNamespace(lateral=SimpleNamespace(model="as logged"))


@pytest.fixture
def compared(monkeypatch):
    """Return what ``compare_axis`` is given, with manoeuvres and simulators made by hand."""
    seen = SimpleNamespace(closed=0, specification=None)

    def close():
        seen.closed += 1

    def named(specification, *_):
        seen.specification = specification
        return SimpleNamespace(close=close)

    def compare(_, maneuvers, aircraft, prior, logged, as_logged):
        seen.maneuvers, seen.aircraft, seen.logged = maneuvers, aircraft, logged
        seen.as_logged = as_logged
        return Diagnosis(axis="lateral", verdict="untested", sentence="", gap=Gap(), model={})

    monkeypatch.setattr(side_gap, "read_whole", lambda *_, **__: SimpleNamespace(state=STATE))
    monkeypatch.setattr(side_gap, "accepted_of", lambda _: ["as flown"])
    monkeypatch.setattr(side_gap, "compare_axis", compare)
    monkeypatch.setattr(side_gap, "simulator_of", named)
    monkeypatch.setattr(
        side_gap, "side_without_difference", lambda flown, *_: (["beside"], Aircraft(model={"L_p": -1.0}))
    )
    return seen


@pytest.mark.parametrize("specification", [None, "linear"])
def test_the_aircraft_files_own_numbers_are_compared_without_a_replay(compared, specification):
    side_gap.compare_side_flown(STATE, Aircraft(simulator=specification))
    assert compared.maneuvers == ["as flown"]
    assert compared.as_logged
    assert compared.specification is None


def test_a_simulator_flies_the_manoeuvres_and_is_closed(compared):
    side_gap.compare_side_flown(STATE, Aircraft(simulator="jsbsim:c172p"))
    assert compared.specification == "jsbsim:c172p"
    assert (compared.maneuvers, compared.logged) == (["beside"], "as logged")
    assert not compared.as_logged
    assert compared.aircraft.model == {"L_p": -1.0}
    assert compared.closed == 1


def test_a_simulator_that_refuses_is_closed_too(compared, monkeypatch):
    def refuse(*_):
        raise ConfigurationError("no")

    monkeypatch.setattr(side_gap, "side_without_difference", refuse)
    with pytest.raises(ConfigurationError):
        side_gap.compare_side_flown(STATE, Aircraft(simulator="jsbsim:c172p"))
    assert compared.closed == 1


def test_the_derivatives_of_a_simulators_log_are_its_numbers(compared, monkeypatch, tmp_path):
    found = SimpleNamespace(theta=np.arange(15.0), not_identifiable={"Y_beta": "still"}, airspeed_m_s=30.0)
    monkeypatch.setattr(side_gap, "estimate_axis", lambda *_: found)
    log = tmp_path / "simulated.tlog"
    log.touch()
    side_gap.compare_side_flown(STATE, Aircraft(simulator=f"log:{log}"))
    assert "Y_beta" not in compared.aircraft.model
    assert compared.aircraft.model["Y_p"] == 1.0
    assert compared.aircraft.reference_airspeed_m_s == 30.0


def test_a_log_that_is_not_there_is_one_sentence(compared):
    with pytest.raises(ConfigurationError, match="there is no such file"):
        side_gap.compare_side_flown(STATE, Aircraft(simulator="log:nowhere.tlog"))
