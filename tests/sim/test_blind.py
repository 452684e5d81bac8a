"""Sealed cases of the bundled aircraft: fairly drawn, honestly sealed."""

import json
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import yaml

from sim.blind import draw, simulated
from sim.blind.draw import SMALLEST_GAP, draw_case
from sim.blind.generate import aircraft_file, generate
from sim.blind.simulated import draw_simulated
from sim.blind.sizes import INSIDE, OUTSIDE
from sim.blind.visibility import structural_gap
from sim.effects import catalogue, outside
from sim.effects.fitting import flight_of
from sim.flight import noise_sigma
from sim.scenario import Maneuver, Noise, Scenario
from sim.sealed.cases import key_beside
from sim.sealed.reveal import report
from sim.sealed.seal import SEAL, SealError, commit, seal, unseal
from sim.tlog import read_tlog

# Cases take seconds to draw.
pytestmark = pytest.mark.xdist_group("sealed cases")


@pytest.fixture(scope="module", autouse=True)
def brief():
    """Draw flights of two manoeuvres instead of nine."""
    scenario_of = draw.scenario_of

    def of_two(*given):
        scenario, background = scenario_of(*given)
        return replace(scenario, maneuvers=scenario.maneuvers[:2]), background

    with pytest.MonkeyPatch.context() as patch:
        for module in (draw, simulated):
            patch.setattr(module, "scenario_of", of_two)
        yield


@cache
def drawn(group):
    return draw_case(group, np.random.default_rng(2))


@pytest.fixture(scope="module")
def cases(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sealed") / "cases"
    generate(2, 5, folder, ("none", "parameters"))
    return folder


def key_of(folder):
    return json.loads(key_beside(folder).read_text())["key"]


def test_every_effect_has_sizes_to_draw_from():
    assert sorted(INSIDE) == sorted(catalogue.CATALOGUE)
    assert sorted(OUTSIDE) == sorted(outside.OUTSIDE)


def test_names_files_and_keys_say_nothing(cases):
    folders = sorted(path for path in cases.iterdir() if path.is_dir())
    assert all(len(path.name) == 12 and int(path.name, 16) >= 0 for path in folders)
    descriptions = [yaml.safe_load((path / "aircraft.yaml").read_text()) for path in folders]
    assert all(set(d) == set(descriptions[0]) for d in descriptions)
    times = {path.stat().st_mtime for folder in folders for path in folder.iterdir()}
    assert len(times) == 1
    parameters = [
        sorted({m.param_id for _, m in read_tlog(folder / "flight.tlog", ["PARAM_VALUE"])})
        for folder in folders
    ]
    assert all(names == parameters[0] for names in parameters)


def test_the_key_lies_outside_the_folder_and_matches_the_seal(cases, tmp_path):
    assert not list(cases.glob("**/*key*"))
    answers = tmp_path / "answers.jsonl"
    answers.write_text("")
    with pytest.raises(SealError, match="not committed"):
        unseal(cases, answers, key_beside(cases))
    commit(cases, answers)
    try:
        assert unseal(cases, answers, key_beside(cases)) == key_of(cases)
        answers.write_text("{}")
        with pytest.raises(SealError, match="not the answers that were committed"):
            unseal(cases, answers, key_beside(cases))
        with pytest.raises(SealError, match="other answers were committed before"):
            commit(cases, answers)
        answers.write_text("")
        forged = tmp_path / "key.json"
        forged.write_text(key_beside(cases).read_text().replace("none", "outside"))
        with pytest.raises(SealError, match="not the key that was sealed"):
            unseal(cases, answers, forged)
    finally:
        (cases / "COMMITMENT").unlink()
    assert len((cases / SEAL).read_text().strip()) == 64


def test_a_report_lists_every_figure_with_its_interval(cases, tmp_path):
    answers = tmp_path / "answers.jsonl"
    lines = [json.dumps({"case": name, "answer": {"verdict": "none"}}) for name in key_of(cases)]
    answers.write_text("\n".join(lines))
    commit(cases, answers)
    try:
        text = "\n".join(report(cases, answers, key_beside(cases), details=True))
    finally:
        (cases / "COMMITMENT").unlink()
    nothing = sum(case["kind"] == "none" for case in key_of(cases).values())
    assert "2 cases, 2 answered" in text
    assert f"n={nothing}" in next(line for line in text.splitlines() if line.startswith("false alarms"))


def test_a_key_of_an_earlier_version_is_refused_in_a_sentence(tmp_path):
    folder, answers = tmp_path / "cases", tmp_path / "answers.jsonl"
    folder.mkdir()
    answers.write_text("")
    seal({"0001": {"group": "none", "effects": {}}}, key_beside(folder), folder)
    commit(folder, answers)
    with pytest.raises(SealError, match="sealed by an earlier version; score it with that version"):
        list(report(folder, answers, key_beside(folder)))


@pytest.mark.parametrize(
    "group", ["outside", "two", *(pytest.param(g, marks=pytest.mark.study) for g in ("clean", "jsbsim"))]
)
def test_a_drawn_effect_is_visible_above_the_noise(group):
    case = drawn(group)
    assert case.gap >= SMALLEST_GAP
    assert len(case.effects) == (2 if group == "two" else 1)
    assert set(case.effects) <= set(OUTSIDE if group == "outside" else INSIDE)
    assert set(aircraft_file(case)["model"]) == set(case.prior.as_dict())


def test_the_same_numbers_draw_the_same_case():
    assert draw_case("outside", np.random.default_rng(2)) == drawn("outside")


PLAIN = Scenario(
    maneuvers=(Maneuver("3211"), Maneuver("rev")),
    noise=Noise(),
    speed="held",
    lead_in_s=3.0,
    gap_s=4.0,
    free_s=3.0,
)


def gap_of(changed):
    noise = replace(PLAIN, noise=Noise(percent=1.0))
    plain = flight_of(PLAIN)
    before, after = list(plain.samples()), list(flight_of(changed).samples())
    return structural_gap(before, after, plain.engine.truth, noise_sigma(noise), 0.02)


def test_a_change_that_eight_parameters_can_hide_has_hardly_a_structural_gap():
    power = replace(PLAIN, airframe={"cm_delta_e": -1.15 * 1.02})
    delayed = replace(PLAIN, effects={"transport_delay": {"delay_s": 0.02}})
    assert gap_of(PLAIN) == pytest.approx(0.0, abs=1e-12)
    assert gap_of(power) < 0.02 * gap_of(delayed)


def test_the_structural_gap_grows_with_the_square_of_a_small_effect():
    small, large = (gap_of(replace(PLAIN, effects={"alpha_lag": {"lag_s": lag}})) for lag in (0.004, 0.008))
    assert large / small == pytest.approx(4.0, rel=0.15)


def test_a_case_of_the_group_simulator_names_jsbsim_and_no_model():
    case = draw_simulated(np.random.default_rng(3))
    file = aircraft_file(case)
    assert file["simulator"] == f"jsbsim:{case.scenario.aircraft}"
    assert "model" not in file


def test_an_effect_of_the_simulator_alone_stands_in_its_servo_and_not_in_the_aircraft(monkeypatch):
    monkeypatch.setattr(simulated, "WITHOUT", 0.0)
    monkeypatch.setattr(simulated, "MIRRORED", 1.0)
    case = draw_simulated(np.random.default_rng(4))
    ((effect, sizes),) = case.effects.items()
    key = simulated.SERVO[effect]
    assert sizes[key] < 0.0
    assert aircraft_file(case)["elevator"][key] == -sizes[key]
    assert case.scenario.effects == {}
