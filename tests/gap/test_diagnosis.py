"""The diagnosis names effects of an aircraft that neither it nor the simulator has coded."""

import json

import pytest
import yaml

from advisor.aircraft.aircraft import Aircraft, CampaignPlan, Limits
from advisor.aircraft.reference import PARAMETERS, FmuTrim, FmuVariables
from advisor.aircraft_file.read import parse_aircraft
from advisor.report.gap_document import gap_document
from advisor.report.improved import improved_file, text_of
from tests.gap.diagnosed import diagnose
from tests.gap.generator import Setup, fly
from tests.schemas import breaches

# One diagnosis serves several tests.
pytestmark = pytest.mark.xdist_group("diagnosis")

MODEL = dict(zip(PARAMETERS, (0.04, -4.3, -0.03, -0.28, 0.0, -37.0, -4.8, -52.0), strict=True))


@pytest.fixture(scope="module")
def delayed():
    return diagnose(fly(Setup(maneuvers=4, switches={"delay": 0.06}, seed=3)), Aircraft(name="test"))


def test_a_delay_is_named_sized_and_removed_on_manoeuvres_kept_out(delayed):
    assert delayed.verdict == "effect"
    assert delayed.causes[0].effect == "transport_delay"
    assert delayed.causes[0].parameters["delay_s"].value == pytest.approx(0.06, abs=0.003)
    assert delayed.where.block == "input"
    assert delayed.shrink.percent > 97.0
    assert "ms too early" in delayed.sentence


def test_the_document_is_json_without_nan_and_has_every_key_of_the_contract(delayed):
    document = json.loads(json.dumps(gap_document(delayed), allow_nan=False))
    assert breaches("gap", document) == []
    assert set(document) >= {
        "usable", "problems", "verdict", "gap", "where", "causes", "shrink", "waterfall", "cannot_see",
        "improved_model",
    }  # fmt: skip
    assert set(document["gap"]) >= {"before", "floor", "by_channel", "by_maneuver", "by_phase", "by_band_hz"}
    assert set(document["gap"]["floor"]) == {"alpha", "q", "a_z", "theta"}
    assert set(document["where"]) >= {"block", "share", "ranking"}
    assert set(document["causes"][0]) >= {
        "effect", "probability", "parameters", "cannot_be_told_from", "tell_apart_by", "gap_after",
    }  # fmt: skip
    assert set(document["shrink"]) >= {"holdout", "before", "after", "percent", "ci95_percent"}
    assert sum(c["probability"] for c in document["causes"]) <= 1.0 + 1e-9
    assert document["shrink"]["before"] == pytest.approx(document["gap"]["before"])


def test_the_improved_simulators_file_keeps_what_else_the_crew_wrote_about_its_aircraft(delayed):
    crews = Aircraft(
        name="ours",
        airspeed_m_s=22.0,
        limits=Limits(bank_deg=20.0),
        campaign=CampaignPlan(rule="information", tolerance={"M_0": 0.1}),
        fmu=FmuVariables("delta_e", "alpha", "q", "theta", "n_z", trim=FmuTrim(airspeed="V")),
    )
    written = parse_aircraft(improved_file(delayed, crews))
    assert (written.limits, written.campaign, written.airspeed_m_s) == (crews.limits, crews.campaign, 22.0)
    assert written.fmu == crews.fmu
    assert written.name == "ours, improved"


def test_the_improved_simulator_is_a_file_with_the_effect_in_it(delayed, tmp_path):
    path = tmp_path / "improved.yaml"
    path.write_text(text_of(improved_file(delayed, Aircraft(name="test"))), encoding="utf-8")
    written = yaml.safe_load(path.read_text())
    assert written["effects"]["transport_delay"]["delay_s"] == pytest.approx(0.06, abs=0.003)
    assert set(written["model"]) == set(PARAMETERS)
    assert improved_file(delayed, Aircraft())["name"].endswith("improved")
