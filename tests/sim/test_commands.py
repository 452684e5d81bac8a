"""``python -m sim`` as a user types it: what it writes, and how it refuses."""

import json
import subprocess
import sys
from dataclasses import replace

import pytest
import yaml

from sim.__main__ import run
from sim.blind import draw
from sim.linear import RESEARCH_JET
from sim.sealed.cases import key_beside


@pytest.fixture
def sim(capsys):
    """Run the command in this process; return (exit code, stdout, stderr)."""

    def run_it(*arguments):
        with pytest.raises(SystemExit) as left:
            run([str(argument) for argument in arguments])
        return (left.value.code or 0, *capsys.readouterr())

    return run_it


def test_recording_in_another_process_gives_the_same_bytes(tmp_path, sim):
    scenario = tmp_path / "short.yaml"
    scenario.write_text(yaml.safe_dump({"maneuvers": ["3211"], "aircraft": "linear"}))
    options = ("--scenario", scenario, "--seed", 3)
    assert sim("record", "--out", tmp_path / "a.tlog", *options)[:2] == (0, "")
    command = [sys.executable, "-m", "sim", "record", "--out", tmp_path / "b.tlog", *options]
    subprocess.run([str(word) for word in command], check=True, capture_output=True, timeout=100)
    assert (tmp_path / "a.tlog").read_bytes() == (tmp_path / "b.tlog").read_bytes()


@pytest.mark.parametrize(
    ("scenario", "sentence"),
    [
        ({"colour": 1, "seed": "x"}, "colour: unknown key"),
        ({"aircraft": "zeppelin"}, "'zeppelin' is none of uav, light, linear"),
        ({"effects": {"wobble": {}}}, "effects.wobble: unknown effect"),
        ({"airspeed_m_s": 6.0}, "no level flight at 6 m/s"),
        ({"engine": "jsbsim", "aircraft": "sopwith"}, "JSBSim has no 'sopwith'"),
    ],
)
def test_a_mistake_ends_with_code_2_and_a_sentence_but_no_traceback(tmp_path, sim, scenario, sentence):
    path = tmp_path / "scenario.yaml"
    path.write_text(yaml.safe_dump(scenario))
    code, _, said = sim("record", "--out", tmp_path / "x.tlog", "--scenario", path)
    assert code == 2
    assert sentence in said
    assert "Traceback" not in said
    assert not (tmp_path / "x.tlog").exists()


def test_inputs_flown_again_need_an_aircraft_file(tmp_path, sim):
    code, _, said = sim("record", "--out", tmp_path / "x.tlog", "--replay-inputs", tmp_path / "y.tlog")
    assert code == 2
    assert "--replay-inputs needs --aircraft FILE" in said


def test_an_aircraft_file_is_flown_and_its_flight_flown_again(tmp_path, sim):
    aircraft, scenario = tmp_path / "jet.yaml", tmp_path / "short.yaml"
    aircraft.write_text(yaml.safe_dump({"model": RESEARCH_JET.as_dict(), "airspeed_m_s": 100.0}))
    scenario.write_text(yaml.safe_dump({"maneuvers": ["3211"]}))
    first, again = tmp_path / "first.tlog", tmp_path / "again.tlog"
    assert sim("record", "--out", first, "--aircraft", aircraft, "--scenario", scenario)[0] == 0
    assert sim("record", "--out", again, "--aircraft", aircraft, "--replay-inputs", first)[0] == 0
    assert again.stat().st_size == pytest.approx(first.stat().st_size, rel=0.02)


def test_sealed_cases_are_made_committed_and_revealed(tmp_path, sim, monkeypatch):
    scenario_of = draw.scenario_of

    def of_two(*given):
        scenario, background = scenario_of(*given)
        return replace(scenario, maneuvers=scenario.maneuvers[:2]), background

    monkeypatch.setattr(draw, "scenario_of", of_two)
    folder, answers = tmp_path / "cases", tmp_path / "answers.jsonl"
    assert sim("blind", "--cases", 2, "--seed", 4, "--out", folder, "--only", "none")[0] == 0
    names = sorted(path.name for path in folder.iterdir() if path.is_dir())
    answers.write_text("\n".join(json.dumps({"case": name, "answer": {"verdict": "none"}}) for name in names))
    code, _, said = sim("reveal", folder, answers)
    assert code == 2
    assert "answers are not committed" in said
    assert sim("commit", folder, answers)[0] == 0
    code, table, _ = sim("reveal", folder, answers)
    assert code == 0
    assert "false alarms without an effect" in table
    assert key_beside(folder).exists()
    code, document, _ = sim("reveal", folder, answers, "--json")
    assert code == 0
    alarms = {"name": "false alarms without an effect", "trials": 2, "hits": 0}
    assert alarms in json.loads(document)["figures"]


@pytest.mark.parametrize(
    ("m_alpha", "said"), [(400.0, "grows without bound"), (float("nan"), "must be a number")]
)
def test_an_aircraft_that_cannot_fly_is_refused_in_a_sentence(sim, tmp_path, m_alpha, said):
    path = tmp_path / "aircraft.yaml"
    model = dict.fromkeys(("Z_0", "Z_q", "Z_delta_e", "M_0"), 0.0)
    model |= {"Z_alpha": -1.0, "M_alpha": m_alpha, "M_q": -1.5, "M_delta_e": -7.2}
    path.write_text(yaml.safe_dump({"model": model, "airspeed_m_s": 22.0}))
    code, _, error = sim("record", "--aircraft", path, "--out", tmp_path / "flight.tlog")
    assert code == 2
    assert said in error
    assert error.count("\n") == 1
