"""The whole flight in one picture: the manoeuvres of both axes over the channels that they concern."""

from types import SimpleNamespace

import numpy as np

from advisor.flight.signals.record import Channel
from advisor.report.page.flight_picture import flight_picture
from tests.campaign.side_builders import judged, state


def flown(*side):
    """Return the content of a page on a flight of roll and yaw."""
    t = np.arange(100.0, 220.0, 0.1)
    names = ("elevator", "aileron", "rudder", "p", "r", "airspeed")
    channels = {name: Channel(name, t, np.sin(t), "test", "measured") for name in names}
    lateral = state(*side) if side else None
    return SimpleNamespace(
        state=SimpleNamespace(maneuvers=(), lateral=lateral),
        power_ons=((0, SimpleNamespace(boot=0, channels=channels)),),
        names=("flight.tlog",),
    )


def test_manoeuvres_of_roll_and_yaw_are_marked_over_their_channels():
    section = flight_picture(flown(judged(1, "aileron"), judged(2, "rudder", accepted=False)))
    ((gallery),) = section.blocks
    svg = gallery.figures[0].svg()
    assert "R1✓" in svg
    assert "R2✗" in svg
    assert "δa" in svg
    assert "δe" not in svg


def test_a_flight_without_a_manoeuvre_has_no_picture():
    assert flight_picture(flown()) is None
