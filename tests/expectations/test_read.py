"""An expectations file: what it may hold, and one sentence for every mistake."""

from pathlib import Path

import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.expectations.read import Near, read_expectations
from advisor.words.problems import ConfigurationError

AIRCRAFT = Aircraft(model={"Z_alpha": -1.0, "M_alpha": -5.0, "M_q": -1.5})


def read(folder: Path, text: str, aircraft: Aircraft = AIRCRAFT):
    file = folder / "expectations.yaml"
    file.write_text(text, encoding="utf-8")
    return read_expectations(file, aircraft)


def test_a_derivative_may_be_expected_near_a_number_or_near_the_files_model(tmp_path):
    expected = read(
        tmp_path, "derivatives:\n  M_q: {of: -4, within: 1}\n  M_alpha: {of: model, within_percent: 5}"
    )
    assert expected.derivatives == {
        "M_q": Near(value=-4.0, within=1.0),
        "M_alpha": Near(origin="model", within_percent=5.0),
    }


def test_one_level_holds_for_every_category(tmp_path):
    expected = read(tmp_path, "levels: {pitch: 2, lateral: {B: 1}}")
    assert expected.levels == {"pitch": {"A": 2, "B": 2, "C": 2}, "lateral": {"B": 1}}


def test_a_log_lies_relative_to_the_file(tmp_path):
    (tmp_path / "first.tlog").touch()
    assert read(tmp_path, "alarms: 0\nlog: first.tlog").log == tmp_path / "first.tlog"


WRONG = {
    "acepted: {pitch: 1}": "acepted: unknown key (did you mean accepted?)",
    "accepted: {pitch: 0}": "accepted.pitch: must be a whole number of at least 1, is 0",
    "accepted: {pitch: true}": "accepted.pitch: must be a whole number of at least 1, is True",
    "accepted: 3": "accepted: must hold keys with values",
    "accepted: {roll: 3}": "accepted.roll: unknown key (the keys are pitch, lateral)",
    "derivatives: {M_alfa: {of: 1, within: 1}}": "derivatives.M_alfa: unknown key (did you mean M_alpha?)",
    "derivatives: {M_q: -4}": "derivatives.M_q: must hold keys with values",
    "derivatives: {M_q: {of: -4}}": "derivatives.M_q: needs a tolerance: within, within_percent, known_to",
    "derivatives: {M_q: {within: 1}}": "derivatives.M_q.of: is missing",
    "derivatives: {M_q: {of: 0, within_percent: 5}}": "derivatives.M_q.within_percent: gives no tolerance",
    "derivatives: {M_q: {of: four, within: 1}}": "derivatives.M_q.of: must be a number, model, or log",
    "derivatives: {M_q: {of: -4, within: -1}}": "derivatives.M_q.within: must be a number above 0, is -1",
    "derivatives: {M_q: {of: .nan, within: 1}}": "M_q.of: must be a number, model, or log, is nan",
    "derivatives: {L_p: {of: model, within: 1}}": "derivatives.L_p.of: the aircraft file's model has no L_p",
    "derivatives: {M_q: {of: log, within: 1}}": "log: is missing",
    "modes: {dutch_roll_zeta: {of: model, within: 1}}": "the aircraft file's model has no Y_beta",
    "levels: {pitch: 4}": "levels.pitch.A: must be a level of 1 to 3, is 4",
    "gap: {lateral: 1}": "gap.lateral: the aircraft file gives no simulator of this axis",
    "longest_pause_s: {q: 0}": "longest_pause_s.q: must be a number above 0, is 0",
    "log: nowhere.tlog": "log: there is no file",
    "": "file: expects nothing",
}  # fmt: skip


@pytest.mark.parametrize(("text", "sentence"), WRONG.items())
def test_a_mistake_is_named_with_its_path(tmp_path, text, sentence):
    with pytest.raises(ConfigurationError) as refused:
        read(tmp_path, text)
    assert sentence in str(refused.value)


def test_all_mistakes_are_listed_at_once(tmp_path):
    with pytest.raises(ConfigurationError) as refused:
        read(tmp_path, "alarms: -1\naccepted: {pitch: 1.5}\nderivatives: {M_q: {of: x, within: 0}}")
    paths = ("alarms:", "accepted.pitch:", "derivatives.M_q.of:", "derivatives.M_q.within:")
    assert all(path in str(refused.value) for path in paths)
