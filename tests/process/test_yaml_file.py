"""Files that YAML allows and the advisor does not take: one sentence each, at once."""

import os
import time

import pytest

from advisor.aircraft_file.read import load_aircraft
from advisor.process.yaml_file import read_yaml
from advisor.words.problems import ConfigurationError

REFUSED = {
    "a cycle": ("&a [*a]", r"line 1: the reference \*a is not read"),
    "a reference": ("name: &n x\nother: *n", r"line 2: the reference \*n is not read"),
    "a list of lists": ("[" * 1500 + "]" * 1500, "line 1: nested more than 32 deep"),
    "a map of maps": ("{a: " * 3000 + "1" + "}" * 3000, "line 1: nested more than 32 deep"),
    "a key twice": ("name: a\nname: b", "line 2: the key 'name' is repeated"),
    "a key twice in a section": ("elevator: {lag_s: 0.1, lag_s: 0.2}", "the key 'lag_s' is repeated"),
    "a date that is none": ("name: 2026-02-31", "holds a value that is none"),
    "half a list": ("name: [", "not a YAML file, line"),
    "200,000 points": ("points:\n" + "- [1, 2]\n" * 200_000, "larger than 256 kB"),
}


@pytest.mark.parametrize(("text", "reason"), REFUSED.values(), ids=REFUSED)
def test_a_file_that_no_crew_writes_is_one_sentence(tmp_path, text, reason):
    path = tmp_path / "aircraft.yaml"
    path.write_text(text)
    with pytest.raises(ConfigurationError, match=reason) as refused:
        read_yaml(path)
    assert "\n" not in str(refused.value)


def test_a_file_in_utf_16_is_told_so(tmp_path):
    path = tmp_path / "aircraft.yaml"
    path.write_text("name: x\n", encoding="utf-16")
    with pytest.raises(ConfigurationError, match="it is no text in UTF-8"):
        read_yaml(path)


def test_a_byte_order_mark_changes_nothing(tmp_path):
    path = tmp_path / "aircraft.yaml"
    path.write_text("name: x\n", encoding="utf-8-sig")
    assert read_yaml(path) == {"name": "x"}


def test_the_same_key_in_two_sections_is_no_repetition(tmp_path):
    path = tmp_path / "aircraft.yaml"
    path.write_text("a: {x: 1}\nb: {x: 2}\n")
    assert read_yaml(path) == {"a": {"x": 1}, "b": {"x": 2}}


def test_an_aircrafts_name_keeps_no_control_characters(tmp_path):
    path = tmp_path / "aircraft.yaml"
    path.write_text(r'name: "boo\e[31m\a [/]"')
    assert load_aircraft(path).name == "boo[31m [/]"


def test_two_hundred_thousand_points_are_one_sentence_within_a_second(tmp_path):
    file = tmp_path / "aircraft.yaml"
    file.write_text("elevator: {calibration: [" + "[1,2]," * 40_000 + "]}")
    began = time.monotonic()
    with pytest.raises(ConfigurationError, match="more than 20000 values") as refused:
        load_aircraft(file)
    assert time.monotonic() - began < 1.0
    assert len(str(refused.value)) < 300


def test_a_calibration_has_no_more_points_than_a_servo_has_steps(tmp_path):
    file = tmp_path / "aircraft.yaml"
    points = ", ".join(f"[{900 + i / 10}, {i / 100}]" for i in range(5_000))
    file.write_text(f"elevator: {{calibration: [{points}]}}")
    with pytest.raises(ConfigurationError, match="5000 points; give at most 500"):
        load_aircraft(file)


def test_of_many_mistakes_the_first_are_listed_and_the_rest_counted(tmp_path):
    file = tmp_path / "aircraft.yaml"
    file.write_text("".join(f"key{i}: 1\n" for i in range(500)))
    with pytest.raises(ConfigurationError, match="and 480 more"):
        load_aircraft(file)


def test_a_pipe_is_refused_without_waiting_for_it(tmp_path):
    os.mkfifo(tmp_path / "aircraft.yaml")
    with pytest.raises(ConfigurationError, match="pipe or a device"):
        load_aircraft(tmp_path / "aircraft.yaml")
