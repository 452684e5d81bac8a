"""Single models of JSBSim: their own actuators, a flight control that feeds back, wrong files."""

import re
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.simulators import jsbsim
from advisor.simulators.jsbsim import Jsbsim, make_jsbsim
from advisor.simulators.jsbsim_model import find_model
from advisor.simulators.protocol import Condition, Inputs
from advisor.words.problems import ConfigurationError, UnusableInputError
from sim.jsbsim_aircraft import JsbsimAircraft
from sim.motion import HOME_HEIGHT_M
from tests.simulators.makeshift import Damping

T = 0.005 * (np.arange(400) + 0.5)
LEVEL = Condition(50.0, 1000.0)


def step(size_rad: float) -> Inputs:
    return Inputs(T, np.where(T > 0.5, size_rad, 0.0))


@pytest.mark.parametrize(("model", "condition"), [("c172p", LEVEL), ("A320", Condition(150.0, 3000.0))])
def test_the_bundled_simulators_coding_of_jsbsim_flies_the_same(model: str, condition: Condition) -> None:
    dt, seconds = 0.0025, 4.0
    other = JsbsimAircraft(model, condition.airspeed_m_s, condition.height_m, dt)
    trim = other.trim._replace(aileron=other._fdm["fcs/aileron-cmd-norm"])
    t = dt * np.arange(round(seconds / dt) + 1)
    moved = np.where((t > 0.5) & (t < 1.5), 0.02, 0.0)
    flown = [other.motion()]
    flown += [other.step(trim._replace(elevator=trim.elevator + now), dt) for now in moved[1:]]
    middles = 0.005 * (np.arange(round(seconds / 0.005)) + 0.5)
    high = replace(condition, height_m=condition.height_m + HOME_HEIGHT_M)
    ours = Jsbsim(find_model(model)).replay(high, Inputs(middles, np.interp(middles, t, moved)))
    q = np.interp(t, ours.t, ours.q) - np.array([one.q for one in flown])
    alpha = np.interp(t, ours.t, ours.alpha) - np.array([one.alpha for one in flown])
    assert np.std(q) < 0.02 * np.std(ours.q)
    assert np.std(alpha) < 0.02 * np.std(ours.alpha)


def test_engines_are_found_two_folders_above_a_users_model(tmp_path: Path) -> None:
    shipped = find_model("c172p")
    engines = shipped.parents[2] / "engine"
    (tmp_path / "aircraft" / "mine").mkdir(parents=True)
    (tmp_path / "engine").mkdir()
    text = shipped.read_text()
    for name in re.findall(r'<(?:engine|thruster) file="(\w+)"', text):
        shutil.copy(engines / f"{name}.xml", tmp_path / "engine" / f"my_{name}.xml")
        text = text.replace(f'file="{name}"', f'file="my_{name}"')
    path = tmp_path / "aircraft" / "mine" / "mine.xml"
    path.write_text(text)
    mine = Jsbsim(path).replay(LEVEL, step(-0.02))
    assert mine.q.tolist() == Jsbsim(shipped).replay(LEVEL, step(-0.02)).q.tolist()


def test_a_model_in_a_folder_behind_a_link_loads(tmp_path: Path) -> None:
    deep = tmp_path / "far" / "away" / "c172p"
    shutil.copytree(find_model("c172p").parent, deep)
    (tmp_path / "link").symlink_to(deep, target_is_directory=True)
    Jsbsim(find_model(str(tmp_path / "link" / "c172p.xml")))


def test_a_hysteresis_of_the_models_own_actuator_stays_in_the_path() -> None:
    c172x = Jsbsim(find_model("c172x"))  # its elevator rests within 0.025 rad of where it stands
    assert np.max(np.abs(c172x.replay(LEVEL, step(0.02)).q)) < 1e-4
    assert np.min(c172x.replay(LEVEL, step(0.06)).q) < -0.05


def test_a_lag_written_into_a_users_model_delays_its_answer(tmp_path: Path) -> None:
    plain = find_model("c172p")
    slow = re.sub(
        r"<output>fcs/elevator-pos-rad</output>\s*</aerosurface_scale>",
        "<output>fcs/elevator-asked-rad</output></aerosurface_scale>"
        '<actuator name="slow"><input>fcs/elevator-asked-rad</input><lag>3</lag>'
        "<output>fcs/elevator-pos-rad</output></actuator>",
        plain.read_text(),
    )
    path = tmp_path / "slow.xml"
    path.write_text(slow)
    quick_q = Jsbsim(plain).replay(LEVEL, step(-0.02)).q
    slow_q = Jsbsim(path).replay(LEVEL, step(-0.02)).q
    assert slow_q[120] < 0.5 * quick_q[120]
    assert slow_q[-1] > 0.0


def test_a_flight_control_that_feeds_back_is_bypassed_at_the_surface() -> None:
    f16 = Jsbsim(find_model("f16"))
    f16.replay(Condition(160.0, 3000.0), step(0.01))
    start = f16._trims[Condition(160.0, 3000.0)].elevator
    assert f16._flight.fdm["fcs/elevator-pos-rad"] == pytest.approx(start + 0.01, abs=1e-9)


def test_a_command_that_moves_no_surface_is_one_sentence() -> None:
    with pytest.raises(
        UnusableInputError, match="No elevator command moves the surface fcs/elevator-pos-rad of JSBSim T38"
    ):
        Jsbsim(find_model("T38")).replay(Condition(160.0, 4000.0), step(0.01))


def test_a_turboprop_begins_with_its_power() -> None:
    twin = Jsbsim(find_model("DHC6")).replay(Condition(70.0, 1000.0), step(0.0))
    assert np.ptp(twin.airspeed_m_s) < 0.05
    assert np.ptp(twin.alpha) < 1e-3


def test_a_glider_keeps_its_speed_on_a_level_path() -> None:
    glider = Jsbsim(find_model("minisgs")).replay(Condition(12.0, 300.0), step(0.0))
    assert np.ptp(glider.airspeed_m_s) < 0.05


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "no element found"),
        (b"<aircraft/>", "not <fdm_config>"),
        (b"<fdm_config", "unclosed token"),
        (b"\xff\xfe\x00", "plane.xml does not load as a JSBSim aircraft"),
        (b"<fdm_config name='x'/>", "plane.xml does not load as a JSBSim aircraft"),
    ],
)
def test_a_file_that_is_no_model_is_one_sentence(tmp_path: Path, content: bytes, words: str) -> None:
    path = tmp_path / "plane.xml"
    path.write_bytes(content)
    with pytest.raises(ConfigurationError, match=words) as caught:
        make_jsbsim(str(path), Aircraft())
    assert "\n" not in str(caught.value)


def test_a_path_that_is_no_file_is_one_sentence(tmp_path: Path) -> None:
    with pytest.raises(UnusableInputError, match="Give the path of the model's XML"):
        make_jsbsim(str(tmp_path / "none.xml"), Aircraft())


@pytest.mark.parametrize(
    ("before", "added"),
    [
        (
            '<axis name="LIFT">',
            '<axis name="LIFT"><function name="aero/x"><product><property>systems/flaps/power</property>'
            "<property>aero/qbar-psf</property></product></function>",
        ),
        (
            '<channel name="Pitch">',
            '<channel name="Pitch"><switch name="fcs/zz"><default value="0"/>'
            '<test value="1">/sim/time/elapsed-sec gt 1</test></switch>',
        ),
    ],
    ids=["in a function", "in a test"],
)
def test_properties_that_flightgear_writes_are_0_and_said(tmp_path: Path, before: str, added: str) -> None:
    path = tmp_path / "mine.xml"
    path.write_text(find_model("c172p").read_text().replace(before, added, 1))
    apart = make_jsbsim(str(path), Aircraft())
    try:
        flown = apart.replay(LEVEL, step(0.01))
    finally:
        apart.close()
    name = "systems/flaps/power" if "power" in added else "/sim/time/elapsed-sec"
    assert apart.notes == (
        f"The JSBSim model reads properties that FlightGear writes, and they are 0 here: {name}.",
    )
    assert flown.q.tolist() == Jsbsim(find_model("c172p")).replay(LEVEL, step(0.01)).q.tolist()


def test_shipped_models_read_no_foreign_property_that_they_write_themselves() -> None:
    for model in ("c172p", "c172x", "737", "f16"):
        assert Jsbsim(find_model(model)).notes == ()


def test_a_models_own_output_writes_no_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    text = find_model("c172p").read_text()
    path = tmp_path / "talker.xml"
    path.write_text(
        text.replace("</fdm_config>", '<output name="talk.csv" type="CSV" rate="10"/></fdm_config>')
    )
    Jsbsim(path).replay(LEVEL, step(0.0))
    assert sorted(one.name for one in tmp_path.iterdir()) == ["talker.xml"]


def test_a_model_on_which_jsbsim_crashes_is_one_sentence(tmp_path: Path) -> None:
    text = find_model("c172p").read_text()
    no_range = '<aerosurface_scale name="bare"><input>fcs/none</input></aerosurface_scale>'
    bare = f'<channel name="x">{no_range}</channel></flight_control>'
    path = tmp_path / "bare.xml"
    path.write_text(text.replace("</flight_control>", bare))
    with pytest.raises(ConfigurationError, match="JSBSim bare ended during its start by signal SIGSEGV"):
        make_jsbsim(str(path), Aircraft())


def test_a_replay_that_diverges_is_one_sentence_and_the_next_flies() -> None:
    c172p = Jsbsim(find_model("c172p"))
    before = c172p.replay(LEVEL, step(0.01))
    with pytest.raises(UnusableInputError) as caught:
        c172p.replay(LEVEL, step(0.01), Damping(1e6))
    assert caught.value.problem.code == "simulator_diverges"
    assert c172p.replay(LEVEL, step(0.01)).q == pytest.approx(before.q, abs=1e-4)


def test_a_trim_begins_at_that_of_the_condition_before(monkeypatch: pytest.MonkeyPatch) -> None:
    """An engine takes seconds of frozen flight at each throttle that is tried."""
    throttles: list[float] = []
    steady = jsbsim._steady

    def counted(flight, condition, guess):
        throttles.append(guess.throttle)
        return steady(flight, condition, guess)

    monkeypatch.setattr(jsbsim, "_steady", counted)
    one, fresh = Jsbsim(find_model("c172p")), Jsbsim(find_model("c172p"))
    first, second = Condition(53.0, 1800.0), Condition(53.2, 1801.0)
    one._steady(first)
    begun = len(throttles)
    after = one._steady(second)
    nearby, throttles[:] = throttles[begun:], []
    alone = fresh._steady(second)
    assert len(nearby) <= 4 < len(throttles)
    assert (after.alpha, after.elevator) == pytest.approx((alone.alpha, alone.elevator), abs=1e-5)
    assert abs(after.axial) < 1e-3 * one._flight.mass_slug / 0.3048  # of the force in lb
