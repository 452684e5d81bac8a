"""A corrected JSBSim aircraft, loaded, trimmed and flown by JSBSim itself."""

import xml.etree.ElementTree as ET
from pathlib import Path

import jsbsim
import numpy as np
import pytest

from advisor.exports.models.formats.jsbsim_format import aircraft_text
from advisor.exports.models.improvement import SLOPES, ExportedServo
from advisor.exports.models.jsbsim.source import model_of, parse, surface_of
from advisor.gap.result import Value
from advisor.words.problems import ConfigurationError
from tests.exports.models.cases import air_at, improvement

FOOT_M = 0.3048
STEP_S = 1.0 / 240.0
AS_BELIEVED = dict.fromkeys(SLOPES, 1.0)


def loaded(file: Path):
    """The aircraft in JSBSim, with the engines of the installed package."""
    root = Path(jsbsim.get_default_root_dir())
    fdm = jsbsim.FGFDMExec(None)
    fdm.set_debug_level(0)
    fdm.set_dt(STEP_S)  # before loading: a servo computes its numbers from it
    fdm.load_model_with_paths(
        file.stem, str(file.parent.parent), str(root / "engine"), str(root / "systems"), True
    )
    return fdm


def trimmed(file: Path, airspeed_m_s: float):
    """The aircraft trimmed by JSBSim in level flight, 1,000 m above the sea."""
    fdm = loaded(file)
    fdm["ic/terrain-elevation-ft"] = -10000.0
    fdm["ic/h-sl-ft"], fdm["ic/vt-fps"] = 1000.0 / FOOT_M, airspeed_m_s / FOOT_M
    fdm["ic/gamma-deg"] = 0.0
    fdm["fcs/throttle-cmd-norm"], fdm["fcs/mixture-cmd-norm"] = 0.6, 0.9
    fdm.run_ic()
    fdm["propulsion/set-running"] = -1
    fdm["simulation/do_simple_trim"] = 1
    return fdm


def flown(file: Path, airspeed_m_s: float) -> dict[str, float]:
    """The six derivatives by regression over a small manoeuvre that JSBSim flies."""
    fdm = trimmed(file, airspeed_m_s)
    rows = []
    for i in range(round(3.0 / STEP_S)):
        t = i * STEP_S
        fdm["fcs/elevator-cmd-norm"] = 0.02 * np.sign(np.sin(6.0 * t)) + 0.01 * np.sin(11.0 * t)
        fdm.run()
        rows.append(
            [
                fdm["aero/alpha-rad"], fdm["velocities/q-rad_sec"], fdm["fcs/elevator-pos-rad"], 1.0,
                fdm["velocities/vt-fps"], fdm["attitude/theta-rad"],
                fdm["aero/alphadot-rad_sec"], fdm["accelerations/qdot-rad_sec2"],
            ]
        )  # fmt: skip
    data = np.array(rows)[5:]
    regressors = data[:, :6].copy()
    regressors[:, 4:] -= regressors[0, 4:]
    z, *_ = np.linalg.lstsq(regressors, data[:, 6])
    m, *_ = np.linalg.lstsq(regressors, data[:, 7])
    return dict(zip(SLOPES, [z[0], z[1] - 1.0, z[2], *m[:3]], strict=True))


def placed(text: str, folder: Path, name: str) -> Path:
    """The text where JSBSim looks for an aircraft of that name."""
    file = folder / name / f"{name}.xml"
    file.parent.mkdir()
    file.write_text(text)
    return file


def wanted(before: dict[str, float], factors: dict[str, float], airspeed_m_s: float, **changes: object):
    """An improvement that changes each derivative of an aircraft by a factor, and is sure of each."""
    model = {
        p: Value(factors[p] * value, 0.004 * abs(factors[p] * value) + 1e-6) for p, value in before.items()
    }
    return improvement(
        model=model, prior=before, airspeed_m_s=airspeed_m_s, air=air_at(1000.0),
        servo=changes.pop("servo", ExportedServo()), **changes,
    )  # fmt: skip


@pytest.fixture(scope="module")
def cessna() -> dict[str, float]:
    """What the unchanged Cessna does at 53 m/s."""
    return flown(model_of("c172p").file, 53.0)


def test_flown_again_each_derivative_has_changed_by_the_factor_asked_for(cessna, tmp_path):
    factors = AS_BELIEVED | {"M_alpha": 0.5, "M_q": 1.4, "M_delta_e": 0.8}
    made = aircraft_text(wanted(cessna, factors, 53.0), model_of("c172p"))
    again = flown(placed(made.text, tmp_path, "c172p"), 53.0)
    for parameter, factor in factors.items():
        if parameter not in ("Z_q", "Z_delta_e"):
            assert again[parameter] / cessna[parameter] == pytest.approx(factor, rel=0.03), parameter
    # The elevator's lift is too small for a ratio: the regression has it to a few hundredths.
    assert again["Z_delta_e"] == pytest.approx(cessna["Z_delta_e"], abs=0.06)


def test_a_corrected_lift_leaves_the_pitch_stiffness_as_the_flight_has_it(cessna, tmp_path):
    factors = AS_BELIEVED | {"Z_alpha": 1.25}
    made = aircraft_text(wanted(cessna, factors, 53.0), model_of("c172p"))
    again = flown(placed(made.text, tmp_path, "c172p"), 53.0)
    assert again["Z_alpha"] / cessna["Z_alpha"] == pytest.approx(1.25, rel=0.03)
    assert again["M_alpha"] / cessna["M_alpha"] == pytest.approx(1.0, rel=0.03)


def test_a_derivative_without_a_term_of_its_own_is_changed_too(tmp_path):
    model = model_of("737")
    before = flown(model.file, 150.0)
    found = {p: Value(value, 1e-3 * abs(value) + 1e-6) for p, value in before.items()}
    found["Z_q"] = Value(before["Z_q"] - 0.05, 1e-3)
    improved = improvement(
        model=found, prior=before, airspeed_m_s=150.0, air=air_at(1000.0), servo=ExportedServo()
    )
    made = aircraft_text(improved, model)
    assert 'name="aero/advisor/Z_q"' in made.text
    assert flown(placed(made.text, tmp_path, "737"), 150.0)["Z_q"] == pytest.approx(
        before["Z_q"] - 0.05, abs=0.005
    )


def test_what_the_interval_holds_is_left_as_the_model_has_it(cessna):
    made = aircraft_text(wanted(cessna, AS_BELIEVED, 53.0), model_of("c172p"))
    plain = parse(model_of("c172p").file.read_bytes(), "c172p")
    again = parse(made.text.encode(), "c172p")
    assert ET.tostring(again) == ET.tostring(plain)
    assert "Derivatives (SI): as they were" in made.text


def test_a_derivative_that_is_not_told_from_zero_becomes_zero_and_is_said(cessna, tmp_path):
    found = {p: Value(value, 1e-3 * abs(value) + 1e-6) for p, value in cessna.items()}
    found["M_q"] = Value(0.1 * cessna["M_q"], 0.1 * abs(cessna["M_q"]))
    improved = improvement(
        model=found, prior=cessna, airspeed_m_s=53.0, air=air_at(1000.0), servo=ExportedServo()
    )
    made = aircraft_text(improved, model_of("c172p"))
    assert made.left_out == ("M_q, which is not distinguished from zero and is 0",)
    again = flown(placed(made.text, tmp_path, "c172p"), 53.0)
    assert again["M_q"] == pytest.approx(0.0, abs=0.02 * abs(cessna["M_q"]))


def step_response(file: Path) -> tuple[np.ndarray, np.ndarray]:
    """Times, and the elevator's position over its whole change, after a step of the command in flight."""
    fdm = trimmed(file, 53.0)
    rest = fdm["fcs/elevator-pos-rad"]
    for _ in range(240):
        fdm.run()
    assert fdm["fcs/elevator-pos-rad"] == pytest.approx(rest, abs=1e-3)
    fdm["fcs/elevator-cmd-norm"] = fdm["fcs/elevator-cmd-norm"] + 0.1
    t, moved = [], []
    for i in range(240):
        fdm.run()
        t.append((i + 1) * STEP_S)
        moved.append(fdm["fcs/elevator-pos-rad"] - rest)
    return np.array(t), np.array(moved)


def flown_with(servo: ExportedServo, before: dict[str, float], folder: Path) -> tuple[np.ndarray, np.ndarray]:
    made = aircraft_text(wanted(before, AS_BELIEVED, 53.0, servo=servo), model_of("c172p"))
    return step_response(placed(made.text, folder, "c172p"))


def test_the_surface_lags_by_the_time_found(cessna, tmp_path):
    t, moved = flown_with(ExportedServo(lag_s=0.12), cessna, tmp_path)
    assert np.interp(1.0 - np.exp(-1.0), moved / moved[-1], t) == pytest.approx(0.12, abs=2.0 * STEP_S)


def test_the_surface_waits_for_the_delay_found(cessna, tmp_path):
    t, moved = flown_with(ExportedServo(delay_s=0.1), cessna, tmp_path)
    assert t[np.argmax(moved > 0.5 * moved[-1])] == pytest.approx(0.1, abs=2.0 * STEP_S)


def test_the_surface_moves_no_faster_than_the_limit_found(cessna, tmp_path):
    _, moved = flown_with(ExportedServo(rate_rad_s=0.1), cessna, tmp_path)
    assert np.max(np.abs(np.diff(moved))) / STEP_S == pytest.approx(0.1, rel=0.02)


def test_the_surface_misses_half_of_the_play_found(cessna, tmp_path):
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    _, whole = flown_with(ExportedServo(lag_s=0.01), cessna, tmp_path / "a")
    _, with_play = flown_with(ExportedServo(play_rad=0.02), cessna, tmp_path / "b")
    assert whole[-1] - with_play[-1] == pytest.approx(0.01, abs=2e-3)


def test_a_lag_of_second_order_begins_gently_and_trails_a_ramp_by_its_time(cessna, tmp_path):
    _, moved = flown_with(ExportedServo(lag_s=0.1, damping=0.7), cessna, tmp_path)
    share = moved / moved[-1]
    # The delay of a linear system at low frequency is the area above its step response.
    assert np.sum(1.0 - share) * STEP_S == pytest.approx(0.1, abs=0.01)
    assert share[2] < 0.02


def test_what_the_user_wrote_stays_and_each_changed_derivative_adds_one_function(cessna):
    made = aircraft_text(wanted(cessna, AS_BELIEVED | {"M_q": 1.3}, 53.0), model_of("c172p"))
    plain = model_of("c172p").file.read_text()
    assert made.text.count("<!--") == plain.count("<!--") + 1
    assert made.text.count("<function") == plain.count("<function") + 1
    assert 'name="aero/advisor/M_q"' in made.text


def test_an_aircraft_that_does_not_trim_at_the_speed_flown_is_refused(cessna):
    with pytest.raises(ConfigurationError, match=r"does not load and trim c172p\.xml at 5 m/s"):
        aircraft_text(wanted(cessna, AS_BELIEVED, 5.0), model_of("c172p"))


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (b"no xml", "is no XML"),
        (b"<sdf/>", "has no aerodynamics with the axes LIFT and PITCH"),
        (b"<fdm_config/>", "has no aerodynamics with the axes LIFT and PITCH"),
    ],
)
def test_a_file_that_is_no_aircraft_is_refused_by_name(tmp_path, content, sentence):
    file = tmp_path / "mine.xml"
    file.write_bytes(content)
    with pytest.raises(ConfigurationError, match=rf"mine\.xml {sentence}"):
        aircraft_text(improvement(), model_of(str(file)))


def test_an_aircraft_that_jsbsim_lacks_is_refused_by_name():
    with pytest.raises(ConfigurationError, match="JSBSim has no model 'sopwith'"):
        model_of("sopwith")


@pytest.mark.parametrize(("name", "surface"), [("c172p", "rad"), ("T38", "norm")])
def test_the_elevators_position_is_the_property_on_which_the_moment_depends(name, surface):
    root = parse(model_of(name).file.read_bytes(), name)
    assert surface_of(root) == f"fcs/elevator-pos-{surface}"


def test_an_elevator_without_an_angle_is_compared_only_by_ratio():
    model = model_of("T38")
    before = {"Z_alpha": -0.7, "Z_q": 0.0, "M_alpha": -1.8, "M_q": -1.4}
    found = {p: Value(v, 1.0) for p, v in before.items()} | {
        "Z_delta_e": Value(-0.1, 1e-4), "M_delta_e": Value(-9.0, 1e-3)
    }  # fmt: skip
    made = aircraft_text(
        improvement(model=found, prior=before, airspeed_m_s=150.0, servo=ExportedServo()), model
    )
    assert made.left_out == (
        "Z_delta_e: the elevator's position is no angle", "M_delta_e: the elevator's position is no angle"
    )  # fmt: skip


def pushed(fdm, alpha_step: float) -> None:
    """Hold the trimmed aircraft at another angle of attack until the forces rest."""
    fdm.suspend_integration()
    fdm["ic/alpha-rad"] = fdm["aero/alpha-rad"] + alpha_step
    fdm.run_ic()
    for _ in range(10):
        fdm.run()


def test_a_bent_moment_is_a_square_and_a_cube_about_the_trim(cessna, tmp_path):
    effects = {"nonlinear_pitching_moment": {"M_alpha2": 120.0, "M_alpha3": -900.0}}
    made = aircraft_text(wanted(cessna, AS_BELIEVED, 53.0, effects=effects), model_of("c172p"))
    assert made.left_out == ()
    bent = trimmed(placed(made.text, tmp_path, "c172p"), 53.0)
    plain = trimmed(model_of("c172p").file, 53.0)
    at_rest = [fdm["accelerations/qdot-rad_sec2"] for fdm in (bent, plain)]
    assert at_rest == pytest.approx([0.0, 0.0], abs=1e-3)
    for fdm in (bent, plain):
        pushed(fdm, 0.05)
    more = bent["accelerations/qdot-rad_sec2"] - plain["accelerations/qdot-rad_sec2"]
    assert more == pytest.approx(120.0 * 0.05**2 - 900.0 * 0.05**3, rel=0.03)


def test_a_moment_by_the_rate_of_alpha_is_carried(cessna, tmp_path):
    made = aircraft_text(
        wanted(cessna, AS_BELIEVED, 53.0, effects={"alpha_dot": {"M_alpha_dot": -3.0}}), model_of("c172p")
    )
    fdm = trimmed(placed(made.text, tmp_path, "c172p"), 53.0)
    pushed(fdm, 0.02)
    moment = fdm["aero/advisor/alpha_dot"] / fdm["inertia/iyy-slugs_ft2"]
    assert moment == pytest.approx(-3.0 * fdm["aero/alphadot-rad_sec"], rel=0.02)


def test_a_separated_flow_is_listed_as_left_out(cessna):
    effects = {"nonlinear_lift": {"stall_rad": 0.25, "sharpness": 20.0}, "turbulence": {}}
    made = aircraft_text(wanted(cessna, AS_BELIEVED, 53.0, effects=effects), model_of("c172p"))
    assert made.left_out == ("nonlinear lift", "turbulence")


def test_a_trim_beyond_the_tables_of_the_lift_is_no_condition(cessna):
    with pytest.raises(ConfigurationError, match=r"does not load and trim minisgs\.xml at 20 m/s"):
        aircraft_text(wanted(cessna, AS_BELIEVED, 20.0), model_of("minisgs"))
