import json
from pathlib import Path

import pytest

from tests.conftest import Advisor
from tests.scripts.engine import Engine

LOG = Path(__file__).parents[2] / "logs" / "arduplane-default-rates.tlog"


def test_a_script_is_written_without_file_and_log(advisor: Advisor, tmp_path: Path) -> None:
    out = tmp_path / "inflight.lua"
    done = advisor("script", "ardupilot", "-o", out)
    assert (done.returncode, done.stderr) == (0, "")
    assert "6  multisine, 20 s, then 4 s hands off: elevator 2.0 deg" in done.stdout
    engine = Engine()
    engine.load(out.read_text(encoding="utf-8"))
    assert engine.said("ADVISOR CANNOT") == []


def test_the_document_has_the_table_of_inputs(advisor: Advisor, tmp_path: Path) -> None:
    inputs = "--inputs", "rudder doublet,3-2-1-1"
    done = advisor("script", "ardupilot", "-o", tmp_path / "x.lua", "--period", 0.8, *inputs, "--json")
    document = json.loads(done.stdout)
    assert (document["schema"], document["usable"], document["switch"]) == ("advisor.script/1", True, 7)
    assert [one["name"] for one in document["inputs"]] == ["rudder doublet", "3-2-1-1"]
    steps = document["inputs"][1]["moves"]["elevator"]["steps"]
    assert [step["end_s"] for step in steps] == [0.6, 1.0, 1.2, 1.4]
    assert document["why"]["period_s"] == "--period"


def test_the_period_and_the_limits_are_those_of_the_aircraft_file(advisor: Advisor, tmp_path: Path) -> None:
    file = tmp_path / "aircraft.yaml"
    file.write_text(
        "name: my own\nlimits: {bank_deg: 22}\nmodel: {M_alpha: -40, M_q: -4, Z_alpha: -5, M_delta_e: -60}\n"
    )
    out = tmp_path / "x.lua"
    assert advisor("script", "ardupilot", "--aircraft", file, "-o", out).returncode == 0
    script = out.read_text(encoding="utf-8")
    assert 'local AIRCRAFT = "my own"' in script
    assert "local BANK_DEG = 22 " in script
    assert "-- Short period 0.811 s (the aircraft file's model)." in script


def test_a_log_gives_the_limits_of_the_outputs(advisor: Advisor, tmp_path: Path) -> None:
    out = tmp_path / "x.lua"
    assert advisor("script", "ardupilot", LOG, "-o", out).returncode == 0
    assert "SERVO2_TRIM = 1500" in out.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        (["--inputs", "3-2-1"], 2, "--inputs: '3-2-1' is no input; choose from 3-2-1-1, "),
        (["--switch", "99"], 2, "--switch: 99 is no channel; give 1 to 16, or the RCn_OPTION 300 to 307"),
        (["none.tlog"], 3, "none.tlog"),
    ],
)
def test_bad_words_are_refused_in_one_sentence(words, code, said, advisor, tmp_path):
    done = advisor("script", "ardupilot", *words, "-o", tmp_path / "x.lua")
    assert done.returncode == code
    assert said in done.stderr
    assert not (tmp_path / "x.lua").exists()


def test_a_file_in_no_folder_is_refused_before_any_work(advisor: Advisor, tmp_path: Path) -> None:
    done = advisor("script", "ardupilot", "-o", tmp_path / "none" / "x.lua")
    assert done.returncode == 2
    assert "there is no folder" in done.stderr
