"""The newest value of a channel, for the line of limits."""

import numpy as np
import pytest

from advisor.flight.signals.channels import Decoded
from advisor.flight.signals.track import Track
from advisor.flight.signals.tracks import Tracks


@pytest.mark.parametrize("cuts", [[5], [1, 2, 3, 4], [3]])
def test_the_newest_value_is_that_of_the_latest_stamp_however_the_samples_come(cuts: list[int]) -> None:
    t = np.array([1.0, 2.0, 3.0, 3.0, 2.5])
    y = np.array([10.0, 20.0, 30.0, 31.0, 25.0])
    track = Track("bank", "ATTITUDE.roll", "measured")
    for part in np.split(np.arange(5), cuts):
        track.append(t[part], y[part], part.astype(np.int64))
    assert track.status.newest == 30.0


def test_an_angle_of_attack_derived_from_the_climb_rate_shows_no_climb_rate() -> None:
    tracks = Tracks("derived")
    t, order = np.arange(0.0, 4.0, 0.1), np.arange(40)
    for channel, source, value in (
        ("climb_rate", "VFR_HUD.climb", 3.0),
        ("airspeed", "VFR_HUD.airspeed", 25.0),
        ("theta", "ATTITUDE.pitch", 0.1),
    ):
        tracks.append(Decoded(channel, source, "measured", t, np.full(40, value), order))
    assert tracks.statuses()["climb_rate"].newest == 3.0
    assert np.isnan(tracks.statuses()["alpha"].newest)
