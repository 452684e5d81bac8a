"""What is kept of one manoeuvre for its verdict."""

from dataclasses import replace

import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.campaign import single_maneuver
from advisor.campaign.single_maneuver import assess
from advisor.oem.estimate import NoEstimate
from tests.decision.campaigns import estimate


@pytest.mark.parametrize(
    ("found", "moved"),
    [
        (estimate(), False),
        (replace(estimate(), gust_rad=0.01), True),
        (NoEstimate("diverged", "The model runs away."), False),
    ],
    ids=["calm", "gusts", "no estimate"],
)
def test_the_air_moved_where_the_estimate_found_gusts(monkeypatch, found, moved):
    monkeypatch.setattr(single_maneuver, "estimate", lambda *_: found)
    monkeypatch.setattr(single_maneuver, "judge", lambda *_: ())
    monkeypatch.setattr(single_maneuver, "cautions_of", lambda *_: [])
    assert assess(None, Aircraft()).air_moved == moved
