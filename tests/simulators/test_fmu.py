"""An FMU as the user's simulator: one compiled here from C, of FMI 2 and of FMI 3, run by FMPy."""

import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import FmuTrim, FmuVariables
from advisor.aircraft_file.read import parse_aircraft
from advisor.process.arrays import FloatArray
from advisor.simulators.fmu import FmuSimulator, make_fmu
from advisor.simulators.protocol import Condition, Inputs, Replay
from advisor.words.problems import ConfigurationError, UnusableInputError
from tests.simulators.makeshift import Constant, Damping
from tests.simulators.small_fmu import build, described

LIFT, C, M0, MA, MD, MQ, GRAVITY = 0.04, 0.1, 0.0004, -0.01, -0.02, -0.08, 9.80665
T = 0.005 * (np.arange(600) + 0.5)
DOUBLET = 0.02 * (((T > 0.5) & (T < 1.0)) * 1.0 - ((T > 1.0) & (T < 1.5)) * 1.0)
LEVEL = Condition(30.0, 500.0)
TRIM = FmuTrim(airspeed="V", height="h", alpha="alpha_0", theta="theta_0")
NAMES = FmuVariables(
    elevator="delta_e",
    alpha="alpha",
    q="q",
    theta="theta",
    a_z="n_z",
    airspeed="V",
    height="h",
    force_increment="force",
    moment_increment="moment",
    scale={"a_z": -GRAVITY},
    step_s=0.01,
    trim=TRIM,
)

both = pytest.mark.parametrize("fmi", [2, 3])


def exact(elevator: FloatArray, condition: Condition, force: float = 0.0, damping: float = 0.0) -> FloatArray:
    """Return α, q and θ at multiples of 0.01 s, from the C model's linear equations by their exponential."""
    v = condition.airspeed_m_s
    # Steady: lift balances weight and the moment is zero.
    alpha, delta = np.linalg.solve([[LIFT * v, LIFT * v * C], [MA, MD]], [GRAVITY / v, -M0])
    # State α, q, θ, and the constants 1 and elevator of one step.
    rates = np.zeros((5, 5))
    rates[0] = -LIFT * v, 1.0, 0.0, GRAVITY / v + force, -LIFT * v * C
    rates[1] = v * v * MA, MQ * v + damping, 0.0, v * v * M0, v * v * MD
    rates[2, 1] = 1.0
    over_a_step, x = expm(0.01 * rates), np.array([alpha, 0.0, alpha])
    rows = [x]
    for e in delta + np.interp(0.01 * np.arange(300) + 0.005, T, elevator):
        x = (over_a_step @ [*x, 1.0, e])[:3]
        rows.append(x)
    return np.array(rows).T


def assert_flown(flown: Replay, alpha: FloatArray, q: FloatArray, theta: FloatArray, within: float) -> None:
    assert flown.alpha == pytest.approx(alpha, abs=within * np.ptp(alpha))
    assert flown.q == pytest.approx(q, abs=within * np.ptp(q))
    assert flown.theta == pytest.approx(theta, abs=within * np.ptp(theta))


def simulator(folder: Path, fmi: int, names: FmuVariables = NAMES) -> FmuSimulator:
    return FmuSimulator(build(folder, fmi), names, 15.0)


@both
@pytest.mark.parametrize("speed", [25.0, 40.0])
def test_an_fmu_trims_at_the_flown_speed_and_answers_by_its_own_equations(tmp_path, fmi, speed):
    condition = Condition(speed, 800.0)
    flown = simulator(tmp_path, fmi).replay(condition, Inputs(T, DOUBLET))
    assert flown.t == pytest.approx(0.01 * np.arange(301))
    assert_flown(flown, *exact(DOUBLET, condition), within=1e-3)
    assert flown.a_z[0] == pytest.approx(-GRAVITY, rel=1e-4)
    assert set(flown.airspeed_m_s) == {speed}
    assert set(flown.height_m) == {800.0}


@both
def test_increments_of_force_and_moment_enter_at_their_inputs(tmp_path: Path, fmi: int) -> None:
    fmu = simulator(tmp_path, fmi)
    assert fmu.takes_increments
    forced = fmu.replay(LEVEL, Inputs(T, DOUBLET), Constant(0.03, 0.0))
    assert_flown(forced, *exact(DOUBLET, LEVEL, force=0.03), within=1e-3)
    damped = fmu.replay(LEVEL, Inputs(T, DOUBLET), Damping(-1.5))
    assert_flown(damped, *exact(DOUBLET, LEVEL, damping=-1.5), within=5e-3)


def test_degrees_and_scales_are_undone_on_the_way_in_and_out(tmp_path: Path) -> None:
    plain = simulator(tmp_path, 2).replay(LEVEL, Inputs(T, DOUBLET))
    degrees = replace(NAMES, units="deg", trim=FmuTrim())
    flown = simulator(tmp_path, 2, degrees).replay(LEVEL, Inputs(T, DOUBLET))
    at_rest = simulator(tmp_path, 2, degrees).replay(LEVEL, Inputs(T, 0.0 * DOUBLET))
    # The FMU is linear: whatever angle its numbers mean, the departure is the same.
    assert flown.q - at_rest.q == pytest.approx(plain.q, abs=1e-6)
    reversed_sign = replace(NAMES, scale={"a_z": -GRAVITY, "elevator": -1.0})
    mirrored = simulator(tmp_path, 2, reversed_sign).replay(LEVEL, Inputs(T, -DOUBLET))
    assert mirrored.q == pytest.approx(plain.q, abs=1e-6)


def test_a_state_whose_start_value_can_be_set_serves_for_trim(tmp_path: Path) -> None:
    # As Modelica exports it: the start of the state is no parameter of its own.
    file = build(tmp_path, 2)
    with zipfile.ZipFile(file) as archive:
        contents = {name: archive.read(name) for name in archive.namelist()}
    text = contents["modelDescription.xml"].decode()
    parameter = 'name="alpha_0" valueReference="5" causality="parameter" variability="fixed"'
    state = 'name="alpha_0" valueReference="5" causality="local" variability="continuous" initial="exact"'
    assert parameter in text
    contents["modelDescription.xml"] = text.replace(parameter, state).encode()
    with zipfile.ZipFile(file, "w") as archive:
        for name, content in contents.items():
            archive.writestr(name, content)
    flown = FmuSimulator(file, NAMES, 15.0).replay(LEVEL, Inputs(T, DOUBLET))
    assert_flown(flown, *exact(DOUBLET, LEVEL), within=1e-3)


def test_without_trim_an_fmu_begins_where_it_begins(tmp_path: Path) -> None:
    flown = simulator(tmp_path, 3, replace(NAMES, trim=FmuTrim())).replay(LEVEL, Inputs(T, DOUBLET))
    assert flown.alpha[0] == 0.0


def test_the_fmus_own_step_serves_where_the_file_gives_none(tmp_path: Path) -> None:
    flown = simulator(tmp_path, 2, replace(NAMES, step_s=None)).replay(LEVEL, Inputs(T, DOUBLET))
    assert flown.t[1] == pytest.approx(0.02)


def test_speed_and_height_that_are_not_mapped_stay_at_the_conditions(tmp_path: Path) -> None:
    names = replace(NAMES, airspeed=None, height=None)
    flown = simulator(tmp_path, 2, names).replay(Condition(30.0, 700.0), Inputs(T, DOUBLET))
    assert set(flown.airspeed_m_s) == {30.0}
    assert set(flown.height_m) == {700.0}


def test_an_fmu_that_begins_at_another_speed_is_refused_with_both(tmp_path: Path) -> None:
    fmu = simulator(tmp_path, 2, replace(NAMES, trim=FmuTrim()))
    with pytest.raises(UnusableInputError, match="begins at 30 m/s, but the flight was flown at 45 m/s"):
        fmu.replay(Condition(45.0), Inputs(T, DOUBLET))


def test_an_fmu_whose_elevator_moves_nothing_does_not_trim(tmp_path: Path) -> None:
    fmu = simulator(tmp_path, 2, replace(NAMES, elevator="force", force_increment="delta_e", q="h"))
    with pytest.raises(UnusableInputError, match=r"finds no steady flight at 30 m/s and 500 m"):
        fmu.replay(LEVEL, Inputs(T, DOUBLET))


def test_in_a_process_of_its_own_an_fmu_flies_the_same(tmp_path: Path) -> None:
    here = simulator(tmp_path, 3).replay(LEVEL, Inputs(T, DOUBLET))
    apart = make_fmu(str(tmp_path / "short_period.fmu"), Aircraft(fmu=NAMES))
    there = apart.replay(LEVEL, Inputs(T, DOUBLET))
    assert apart.takes_increments
    assert apart.linearise(LEVEL) is None
    apart.close()
    assert there.q.tolist() == here.q.tolist()


@pytest.mark.parametrize(
    ("fmi", "fault", "words"),
    [
        (2, 1, "FMU short_period.fmu ended during a replay by signal SIGABRT"),
        (3, 2, "FMU short_period.fmu does not finish a replay within 1 s"),
    ],
)
def test_an_fmu_that_crashes_or_hangs_is_one_sentence(tmp_path, fmi, fault, words):
    fmu = make_fmu(str(build(tmp_path, fmi, fault)), Aircraft(fmu=NAMES))
    fmu.speed_limit_s = 1.0
    with pytest.raises(UnusableInputError, match=words):
        fmu.replay(LEVEL, Inputs(T, DOUBLET))
    fmu.close()


@both
def test_an_fmu_that_refuses_a_step_is_one_sentence(tmp_path: Path, fmi: int) -> None:
    fmu = FmuSimulator(build(tmp_path, fmi, fault=3), NAMES, 15.0)
    words = r"short_period.fmu fails at 0.06 s: fmi\dDoStep failed with status 3"
    with pytest.raises(UnusableInputError, match=words):
        fmu.replay(LEVEL, Inputs(T, DOUBLET))


@both
@pytest.mark.parametrize(
    ("names", "words"),
    [
        (replace(NAMES, q="pitch_rate"), "no variable 'pitch_rate', which fmu.q of the aircraft file names"),
        (
            replace(NAMES, elevator="alpha"),
            "'alpha', which fmu.elevator names, as output, which cannot be set",
        ),
        (replace(NAMES, trim=FmuTrim(airspeed="V_0")), "'V_0', which fmu.trim.airspeed of the aircraft file"),
    ],
)
def test_a_variable_that_the_fmu_has_not_is_named(tmp_path, fmi, names, words):
    with pytest.raises(UnusableInputError, match=words):
        simulator(tmp_path, fmi, names)


@both
def test_an_fmu_of_another_platform_is_refused_with_those_it_has(tmp_path: Path, fmi: int) -> None:
    file = build(tmp_path, fmi, platform="darwin64" if fmi == 2 else "aarch64-darwin")
    with pytest.raises(UnusableInputError, match=r"has no binary for .*; it has: .*darwin"):
        FmuSimulator(file, NAMES, 15.0)


def test_a_file_that_is_no_fmu_is_one_sentence(tmp_path: Path) -> None:
    file = tmp_path / "x.fmu"
    file.write_bytes(b"PK no")
    with pytest.raises(ConfigurationError, match=r"x.fmu is no FMU: File is not a zip file"):
        make_fmu(str(file), Aircraft(fmu=NAMES))
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("readme", "nothing")
    with pytest.raises(UnusableInputError, match=r"x.fmu is no FMU: .*modelDescription.xml"):
        FmuSimulator(file, NAMES, 15.0)
    with pytest.raises(UnusableInputError, match="Give the path of an"):
        make_fmu(str(tmp_path / "y.fmu"), Aircraft(fmu=NAMES))


@pytest.mark.parametrize("kind", ["<ScheduledExecution", "<ModelExchange"])
def test_an_fmu_that_is_not_for_co_simulation_is_refused_with_its_mend(tmp_path: Path, kind: str) -> None:
    file = tmp_path / "other.fmu"
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("modelDescription.xml", described(3).replace("<CoSimulation", kind))
    with pytest.raises(UnusableInputError, match=r"other.fmu is for no co-simulation") as refused:
        FmuSimulator(file, NAMES, 15.0)
    assert "Export it for co-simulation" in str(
        refused.value.fix if hasattr(refused.value, "fix") else refused.value
    )


def test_an_aircraft_file_without_names_is_told_what_to_add(tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match="add a section fmu: with elevator, alpha, q, theta and a_z"):
        make_fmu(str(build(tmp_path, 2)), Aircraft())


SECTION = {"elevator": "delta_e", "alpha": "alpha", "q": "q", "theta": "theta", "a_z": "n_z"}


def test_the_section_fmu_of_the_aircraft_file_is_read() -> None:
    more = {"units": "deg", "scale": {"a_z": -9.80665}, "step_s": 0.02, "trim": {"airspeed": "V"}}
    fmu = parse_aircraft({"fmu": {**SECTION, **more}}).fmu
    assert fmu == FmuVariables(
        "delta_e", "alpha", "q", "theta", "n_z",
        units="deg", scale={"a_z": -9.80665}, step_s=0.02, trim=FmuTrim(airspeed="V"),
    )  # fmt: skip


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"elevatr": "x"}, "fmu.elevatr: unknown key"),
        ({"trim": {"speed": "x"}}, "fmu.trim.speed: unknown key"),
        ({"scale": {"nz": 1.0}}, "fmu.scale.nz: unknown key, the variables are elevator alpha q"),
        ({"scale": {"a_z": 0.0}}, "fmu.scale.a_z: must not be 0"),
        ({"step_s": 0.5}, "fmu.step_s: 0.5 s is outside"),
        ({"units": "mrad"}, "fmu.units: "),
        ({"force_increment": "f"}, "fmu.force_increment: needs fmu.moment_increment"),
        ({"trim": {"theta": "x"}}, "fmu.trim.theta: needs fmu.trim.alpha"),
    ],
)
def test_a_mistake_in_the_section_fmu_is_told_with_its_path(wrong: dict[str, object], words: str) -> None:
    with pytest.raises(ConfigurationError, match=words):
        parse_aircraft({"fmu": {**SECTION, **wrong}})


def test_a_name_that_is_missing_is_told_with_its_path() -> None:
    with pytest.raises(ConfigurationError, match=r"fmu.q: field required"):
        parse_aircraft({"fmu": {name: value for name, value in SECTION.items() if name != "q"}})


def test_roll_and_yaw_are_read_from_the_named_variables_in_the_fmus_unit(tmp_path):
    names = replace(NAMES, p="q", beta="alpha", scale={**NAMES.scale, "p": 2.0})
    flown = simulator(tmp_path, 2, names).replay(LEVEL, Inputs(T, DOUBLET))
    assert flown.p == pytest.approx(2.0 * flown.q)
    assert flown.beta == pytest.approx(flown.alpha)
    assert flown.r is None
