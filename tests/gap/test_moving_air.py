"""The air moves where a gust angle is large enough to be one."""

from pathlib import Path

from advisor.aircraft_file.read import load_aircraft
from advisor.analysis.gap import maneuvers_of
from advisor.gap.records.prepare import prepare
from advisor.gap.search.air import moving_air
from advisor.gap.search.baseline import fit_baseline

CALM = Path(__file__).parents[2] / "logs" / "arduplane-calm.tlog"


def test_a_rest_of_the_model_that_gusts_imitate_is_no_moving_air():
    aircraft = load_aircraft(CALM.with_suffix(".yaml"))
    flights = prepare(maneuvers_of([CALM], aircraft).maneuvers, aircraft)
    sought = moving_air(*fit_baseline(flights, aircraft))
    assert sought.gain > 30.0
    assert sought.found is None
