"""The simulators that a specification names, and the message for one that names none."""

import re
from pathlib import Path

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft_file.read import parse_aircraft
from advisor.analysis.gap import compare_logs, named_simulator
from advisor.analysis.gap_flights import maneuvers_of
from advisor.simulators import specification
from advisor.simulators.by_log import IdentifiedSimulator
from advisor.simulators.fmu import FmuSimulator
from advisor.simulators.increments import lagging
from advisor.simulators.jsbsim import make_jsbsim
from advisor.simulators.jsbsim_model import find_model
from advisor.simulators.linear import LinearSimulator
from advisor.simulators.protocol import Condition, Inputs, Replay, Simulator
from advisor.simulators.specification import make_python, simulator_of
from advisor.words.problems import ConfigurationError, UnusableInputError
from sim.effects.fitting import flight_of
from sim.record import record
from sim.scenario import Scenario
from tests.simulators.test_fmu import NAMES
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


def logged(folder: Path, name: str, seed: int, **effects: dict[str, float]) -> Path:
    """Return a log of the bundled aircraft."""
    path = folder / f"{name}.tlog"
    record(flight_of(Scenario(aircraft="uav", seed=seed, effects=effects)), path)
    return path


@pytest.fixture(scope="module")
def logs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("logs")
    slow = {"actuator_lag": {"lag_s": 0.12}}
    return logged(folder, "plain", 3), logged(folder, "other", 4), logged(folder, "slow", 5, **slow)


def diagnosed(flight: Path, simulator: Path):
    """Return the diagnosis of a flight relative to the simulator that wrote a log."""
    return compare_logs([flight], Aircraft(simulator=f"log:{simulator}")).diagnosis


@pytest.mark.study
def test_two_logs_of_one_aircraft_show_no_gap_and_the_notes_give_what_was_identified(logs):
    plain, other, _ = logs
    found = diagnosed(plain, other)
    assert found.verdict == "none"
    assert any("M_alpha" in note and "±" in note for note in found.notes)
    assert found.in_simulator.simulator == "the simulator that wrote other.tlog"


@pytest.mark.study
def test_a_lag_that_the_simulators_log_lacks_is_named_and_added_to_the_simulator(logs):
    plain, _, slow = logs
    found = diagnosed(slow, plain)
    assert found.causes[0].effect == "actuator_lag"
    assert found.causes[0].parameters["lag_s"].value == pytest.approx(0.12, abs=0.02)
    assert found.in_simulator.percent > 90.0


@pytest.mark.study
def test_a_servo_that_the_simulators_log_shows_is_the_simulators(logs):
    _, _, slow = logs
    simulator = named_simulator(Aircraft(simulator=f"log:{slow}"))
    assert isinstance(simulator, IdentifiedSimulator)
    shown = simulator.as_file.elevator.lag_s or simulator.as_file.effects["actuator_lag"]["lag_s"]
    assert shown == pytest.approx(0.12, abs=0.02)


@pytest.mark.study
def test_a_lag_that_only_the_simulator_has_is_said_to_be_too_much(logs):
    plain, _, slow = logs
    found = diagnosed(plain, slow)
    assert found.causes[0].effect in ("actuator_lag", "transport_delay")
    assert "too " in found.sentence
    assert len(maneuvers_of([plain], Aircraft()).maneuvers) > 2


pytest.importorskip("jsbsim")
pytest.importorskip("fmpy")
LAG_S = 0.1
T = 0.005 * (np.arange(400) + 0.5)
STEP = Inputs(T, np.where(T > 0.5, 0.005, 0.0))


def of_python(folder: Path, lags: bool) -> tuple[Simulator, Condition]:
    factory = "make_slow" if lags else "make"
    return make_python(f"tests.simulators.nonlinear:{factory}", Aircraft()), Condition(25.0, 300.0)


def of_fmu(folder: Path, lags: bool) -> tuple[Simulator, Condition]:
    from tests.simulators.small_fmu import build

    file = build(folder, 2, lag_s=LAG_S if lags else None)
    return FmuSimulator(file, NAMES, 15.0), Condition(30.0, 500.0)


def of_jsbsim(folder: Path, lags: bool) -> tuple[Simulator, Condition]:
    text = find_model("c172p").read_text()
    if lags:
        text = re.sub(
            r"<output>fcs/elevator-pos-rad</output>\s*</aerosurface_scale>",
            "<output>fcs/asked</output></aerosurface_scale><lag_filter name='slow'><input>fcs/asked</input>"
            f"<c1>{1.0 / LAG_S}</c1><output>fcs/elevator-pos-rad</output></lag_filter>",
            text,
        )
    path = folder / "mine.xml"
    path.write_text(text)
    return make_jsbsim(str(path), Aircraft()), Condition(50.0, 1000.0)


def flown(simulator: Simulator, condition: Condition) -> Replay:
    try:
        return simulator.replay(condition, STEP)
    finally:
        simulator.close()


@pytest.mark.parametrize("of", [of_python, of_fmu, of_jsbsim])
def test_a_lag_in_the_users_simulator_keeps_its_time_constant(of, tmp_path):
    quick, slow = (flown(*of(tmp_path, lags)) for lags in (False, True))
    h = float(quick.t[1] - quick.t[0])
    # A linear aircraft behind a lag answers as its own answer behind that lag.
    sizes = np.arange(0.5, 1.5, 0.01) * LAG_S
    misses = [float(np.std(lagging(quick.q, h, size) - slow.q)) for size in sizes]
    assert sizes[int(np.argmin(misses))] == pytest.approx(LAG_S, rel=0.03)
    assert min(misses) < 0.01 * np.ptp(slow.q)
