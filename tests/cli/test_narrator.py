"""The process that estimates for the text mode says how long it may be silent."""

from contextlib import suppress
from math import inf

import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.campaign.campaign import Campaign
from advisor.cli.narrator import narrate_here
from advisor.process.liveness import Beat
from advisor.session.replay import LogPlayer
from advisor.words.problems import UnusableInputError
from tests.tui.stand_ins import columns


@pytest.mark.parametrize("lateral", [False, True])
def test_no_campaign_asks_for_patience_while_it_waits_for_data(lateral: bool) -> None:
    source = LogPlayer("x", lambda: [columns([0, 1], [1.7e9, 1.7e9 + 0.1], "ATTITUDE")], inf)
    beats: list[Beat] = []
    with suppress(UnusableInputError):
        narrate_here(source, Campaign(Aircraft(), lateral=lateral), lambda line: None, beats.append)
    assert not beats[-1].busy
