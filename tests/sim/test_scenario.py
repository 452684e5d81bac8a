"""Scenario files: defaults, and every mistake named."""

import pytest

from sim.loading import ScenarioError
from sim.maneuvers import STEPS, elevator_input
from sim.scenario import Scenario, read_scenario, scenario_from


def test_without_a_file_the_papers_campaign_is_flown_at_one_percent_noise():
    scenario = Scenario()
    assert [m.input for m in scenario.maneuvers] == ["3211", "rev", "rev", "3211", "rev", "3211", "rev"]
    assert scenario.noise.percent == 1.0


def test_every_mistake_is_listed_with_its_path():
    with pytest.raises(ScenarioError) as caught:
        scenario_from(
            {
                "colour": "red",
                "seed": 1.5,
                "noise": {"precent": 2},
                "maneuvers": ["3211", {"input": "loop"}, {"bank": 3}],
                "rates": {"ATITUDE": 50},
                "input": "wobbly",
            }
        )
    text = "\n".join(caught.value.problems)
    assert "colour: unknown key" in text
    assert "seed: must be a whole number, not 1.5" in text
    assert "noise.precent: unknown key" in text
    assert "maneuvers[2].bank: unknown key" in text
    assert "rates.ATITUDE: unknown message" in text
    assert "input: 'wobbly' is none of linear, held" in text


def test_contradictions_are_listed_too():
    with pytest.raises(ScenarioError) as caught:
        scenario_from({"step_s": 0.01, "maneuvers": ["loop"], "link": {"drop": 1.0}})
    text = "\n".join(caught.value.problems)
    assert "maneuvers[0].input: 'loop' is none of 3211" in text
    assert "step_s: must be above 0 and at most 0.0025" in text
    assert "link.drop" in text


def test_a_file_that_is_no_yaml_is_refused_by_name(tmp_path):
    path = tmp_path / "broken.yaml"
    path.write_text("maneuvers: [3211,", encoding="utf-8")
    with pytest.raises(ScenarioError, match=r"broken\.yaml: cannot be read as YAML"):
        read_scenario(path)


def test_rates_given_change_only_themselves():
    scenario = scenario_from({"rates": {"ATTITUDE": 4}})
    assert scenario.rates["ATTITUDE"] == 4
    assert scenario.rates["AOA_SSA"] == 50


@pytest.mark.parametrize("name", ["3211", "rev", "doublet", "121"])
def test_the_areas_of_an_input_are_balanced(name):
    assert sum(units * level for units, level in STEPS[name]) == pytest.approx(0.0, abs=1e-12)


def test_the_reverse_is_the_mirror_of_the_3211():
    there, back = elevator_input("3211", 0.1, 0.3), elevator_input("rev", 0.1, 0.3)
    assert there.duration_s == pytest.approx(2.1)
    assert all(there.pull(0.01 * i) == -back.pull(0.01 * i) for i in range(-10, 250))


def test_a_multisine_stays_near_its_amplitude_and_begins_and_ends_at_rest():
    stick = elevator_input("multisine", 0.1, 0.3)
    values = [stick.pull(0.01 * i) for i in range(-5, int(100 * stick.duration_s) + 5)]
    assert 0.05 < max(map(abs, values)) < 0.2
    assert abs(values[5]) < 0.01
    assert abs(values[-6]) < 0.02
