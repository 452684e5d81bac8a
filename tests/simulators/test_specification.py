"""The simulators that a specification names, and the message for one that names none."""

from pathlib import Path

import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft_file.read import parse_aircraft
from advisor.simulators import specification
from advisor.simulators.linear import LinearSimulator
from advisor.simulators.specification import simulator_of
from advisor.words.problems import ConfigurationError, UnusableInputError
from tests.simulators.test_increments import MODEL


def nothing_read(log: Path) -> list:
    """Return a log without manoeuvres."""
    return []


@pytest.mark.parametrize(
    ("named", "sentence"),
    [
        ("xplane", "'xplane' is no kind of simulator; give linear, jsbsim:MODEL"),
        ("fmu:", "nothing follows the colon; write fmu:FILE"),
        ("linear:x", "linear takes nothing"),
        ("linear", "the aircraft file's model lacks Z_alpha"),
        ("log:model.xml", "a log ends with .tlog, .bin, .ulg"),
    ],
)
def test_what_names_no_simulator_is_refused_in_one_sentence_with_the_mend(named, sentence):
    with pytest.raises(ConfigurationError) as refused:
        simulator_of(named, Aircraft(), nothing_read)
    assert sentence in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_simulators_log_that_is_missing_ends_like_a_flights_log_that_is_missing():
    with pytest.raises(UnusableInputError, match=r"There is no file nowhere\.tlog\."):
        simulator_of("log:nowhere.tlog", Aircraft(), nothing_read)


def test_a_kind_whose_package_is_missing_names_the_extra(monkeypatch):
    monkeypatch.setattr(specification, "find_spec", lambda name: None)
    with pytest.raises(ConfigurationError, match=r"install inflight-advisor\[fmu\]"):
        simulator_of("fmu:model.fmu", Aircraft(), nothing_read)


def test_linear_is_the_aircraft_files_model_at_its_reference_speed():
    aircraft = Aircraft(model=MODEL, reference_airspeed_m_s=25.0)
    assert simulator_of("linear", aircraft, nothing_read) == LinearSimulator(MODEL, 25.0)


def test_a_log_without_manoeuvres_is_no_simulator(tmp_path):
    log = tmp_path / "sim.tlog"
    log.write_bytes(b"")
    with pytest.raises(UnusableInputError, match="holds 0 elevator manoeuvres; two are needed"):
        simulator_of(f"log:{log}", Aircraft(), nothing_read)


def test_the_aircraft_file_names_a_simulator():
    assert parse_aircraft({"simulator": "jsbsim:c172p"}).simulator == "jsbsim:c172p"
    assert parse_aircraft({}).simulator is None
