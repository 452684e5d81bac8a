"""Each key of the aircraft file is described once, and every reader of the description agrees."""

import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.key import keys_of, sections_of
from advisor.aircraft_file.read import aircraft_schema, parse_aircraft
from advisor.words.problems import ConfigurationError


def test_the_schema_explains_every_key_with_its_meaning_and_cost():
    schema = aircraft_schema()
    lag = schema["$defs"]["Elevator"]["properties"]["lag_s"]["description"]
    assert lag.startswith("First-order lag of the servo, s.")
    assert "Without it: The lag is estimated with the derivatives" in lag
    parts = [schema["properties"], *(part["properties"] for part in schema["$defs"].values())]
    silent = {name for part in parts for name, one in part.items() if "description" not in one}
    sections = {path.rpartition(".")[2].removesuffix("[]") for path, _ in sections_of(Aircraft) if path}
    assert silent <= sections


def test_a_key_has_its_path_its_unit_and_its_default():
    keys = {key.path: key for key in keys_of(Aircraft)}
    assert keys["reference.iyy_kg_m2"].unit == "kg m²"
    assert keys["limits.bank_deg"].default == 30.0
    assert keys["elevator.outputs[].weight"].unit == ""


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ({"elevator": {"lag_s": 2.5}}, "elevator.lag_s: 2.5 s is outside 0..2"),
        ({"reference": {"chord_m": 0.0}}, "reference.chord_m: must be above 0, is 0.0"),
        ({"reference": {"air_temperature_c": 61.0}}, "61.0 °C is outside -80..60"),
        ({"markers": {"above_us": 700.0}}, "markers.above_us: 700.0 us is outside 800..2200"),
    ],
)
def test_a_number_outside_the_bounds_of_its_key_is_refused(content: dict, said: str):
    with pytest.raises(ConfigurationError, match=said.replace(".", r"\.")):
        parse_aircraft(content)
