"""The whole flight in one picture: the manoeuvres of both axes over the channels that they concern."""

import re
from types import SimpleNamespace

import numpy as np

from advisor.flight.signals.record import Channel
from advisor.flight.signals.track import PowerOn
from advisor.report.page.flight_picture import flight_picture, thinned
from tests.campaign.side_builders import judged, state

NONE = np.empty(0, dtype=np.int64)
MODES = ((np.nan, "TAKEOFF"), (100.6, "MANUAL"), (160.0, "CRUISE"))


def flown(*side):
    """Return the content of a page on a flight of roll and yaw."""
    t = np.arange(100.0, 220.0, 0.1)
    names = ("elevator", "aileron", "rudder", "p", "r", "airspeed")
    channels = {name: Channel(name, t, np.sin(t), "test", "measured") for name in names}
    lateral = state(*side) if side else None
    return SimpleNamespace(
        state=SimpleNamespace(maneuvers=(), lateral=lateral),
        power_ons=((0, PowerOn(0, channels, NONE, NONE, MODES)),),
        names=("flight.tlog",),
    )


def test_manoeuvres_of_roll_and_yaw_are_marked_over_their_channels():
    section = flight_picture(flown(judged(1, "aileron"), judged(2, "rudder", accepted=False)))
    ((gallery),) = section.blocks
    svg = gallery.figures[0].svg()
    assert "R1✓" in svg
    assert "R2✗" in svg
    assert "δa" in svg
    assert "δe" not in svg.split('class="layer-')[0]


def test_a_flight_without_a_manoeuvre_has_no_picture():
    assert flight_picture(flown()) is None


def test_flight_modes_are_bands_named_inside_or_in_the_legend_where_they_are_narrow():
    (gallery,) = flight_picture(flown(judged(1, "aileron"))).blocks
    words = re.findall(r">([A-Z]{4,})<", gallery.figures[0].svg())
    assert words == ["MANUAL", "CRUISE", "TAKEOFF"]


def test_every_channel_is_a_hidden_layer_with_a_choice_of_its_own():
    (gallery,) = flight_picture(flown(judged(1, "aileron"))).blocks
    figure = gallery.figures[0]
    assert figure.layers == ("elevator", "aileron", "rudder", "p", "r", "airspeed")
    for drawn in (figure.svg(), figure.narrow()):
        assert re.findall(r'class="layer-(\w+)"', drawn) == list(figure.layers)


def test_the_number_of_a_manoeuvre_leads_to_its_row():
    (gallery,) = flight_picture(flown(judged(1, "aileron"))).blocks
    assert '"#lateral-maneuvers-1"' in gallery.figures[0].svg()


def test_a_thinned_line_keeps_its_peaks_and_breaks_in_a_gap() -> None:
    t = np.concatenate([np.arange(0.0, 100.0, 0.02), np.arange(200.0, 300.0, 0.02)])
    y = np.zeros(len(t))
    y[1234], y[7777] = 3.0, -2.0
    thin_t, thin_y = thinned(Channel("q", t, y), 200)
    assert len(thin_t) < 420
    assert (np.nanmax(thin_y), np.nanmin(thin_y)) == (3.0, -2.0)
    assert thin_t[np.flatnonzero(np.isnan(thin_y))] in (99.98, thin_t[thin_t < 150.0].max())
