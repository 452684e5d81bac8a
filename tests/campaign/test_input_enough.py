"""A multisine that a script flies is reported as enough once, while it is flown."""

import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.campaign.campaign import Campaign, CampaignEvent
from advisor.campaign.single_maneuver import ArrivingInformation, InputEnough
from advisor.decision.arriving import Arriving
from tests.flight.columns import Wire, fly, text

MULTISINE = "ADVISOR BEGIN 3 multisine"


def told(monkeypatch: pytest.MonkeyPatch, begin: str, percent: float) -> list[tuple[float, InputEnough]]:
    """Vehicle times and events while an input is flown, each second of which has this error."""
    found = Arriving(60.0, {"M_alpha": percent})
    monkeypatch.setattr(ArrivingInformation, "follow", lambda *_: found)
    wire = Wire()
    fly(wire, 1000.0, 50.0, [4.0], 14.0)
    text(wire, 1003.0, begin)
    heard: list[CampaignEvent] = []
    campaign = Campaign(Aircraft(), tell=heard.append, lateral=True)
    events: list[tuple[float, InputEnough]] = []
    for k in range(0, len(wire), 20):
        new = campaign.feed(wire.columns(range(k, min(k + 20, len(wire)))))
        events += [(campaign.state.now_s, event) for event in new if isinstance(event, InputEnough)]
    assert [event for event in heard if isinstance(event, InputEnough)] == [event for _, event in events]
    return events


def test_a_multisine_is_enough_once_and_before_its_end(monkeypatch: pytest.MonkeyPatch) -> None:
    ((at_s, event),) = told(monkeypatch, MULTISINE, 99.0)
    assert event == InputEnough(3)
    assert 53.0 <= at_s < 56.0


@pytest.mark.parametrize(("begin", "percent"), [(MULTISINE, 101.0), ("ADVISOR BEGIN 3 3-2-1-1", 99.0)])
def test_no_other_input_is_ended(begin: str, percent: float, monkeypatch: pytest.MonkeyPatch) -> None:
    assert told(monkeypatch, begin, percent) == []
