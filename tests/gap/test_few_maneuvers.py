"""Diagnoses of a single manoeuvre and of two."""

import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import PARAMETERS
from advisor.gap.fitting.whitening import Filters
from advisor.gap.records.prepare import prepare
from advisor.gap.search.baseline import fit_baseline
from advisor.words.problems import UnusableInputError
from tests.gap.diagnosed import diagnose
from tests.gap.generator import Setup, fly

# One diagnosis serves two tests.
pytestmark = pytest.mark.xdist_group("few manoeuvres")

MODEL = dict(zip(PARAMETERS, (0.04, -4.3, -0.03, -0.28, 0.0, -37.0, -4.8, -52.0), strict=True))


@pytest.fixture(scope="module")
def once():
    """Return one manoeuvre of an aircraft whose pitching moment is not the simulator's."""
    return diagnose(fly(Setup(maneuvers=3, seed=4))[:1], Aircraft(model={**MODEL, "M_alpha": -25.0}))


def test_one_manoeuvre_tells_where_and_proves_no_cause(once):
    assert (once.verdict, once.causes, once.shrink) == ("unknown", (), None)
    assert once.where.block == "moment_equation"
    assert "in the pitching moment" in once.sentence
    assert "one manoeuvre cannot prove" in once.sentence


def test_one_manoeuvre_shows_whether_its_channels_agree(once):
    assert once.kinematics.finding == "consistent"


def test_without_a_manoeuvre_nothing_is_said():
    with pytest.raises(UnusableInputError, match="No usable manoeuvre"):
        diagnose([], Aircraft())


def test_the_air_of_two_short_records_is_no_white_noise():
    flights = prepare(fly(Setup(maneuvers=2, gust_std=0.5, seed=5), duration=5.4), Aircraft())
    problem, _ = fit_baseline(flights, Aircraft())
    assert isinstance(problem.whitening, Filters)
