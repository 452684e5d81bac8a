"""A thinned line looks as the whole line does."""

import numpy as np

from advisor.flight.signals.record import Channel
from advisor.report.page.flight_picture import thinned


def test_a_thinned_line_keeps_its_peaks_and_breaks_in_a_gap() -> None:
    t = np.concatenate([np.arange(0.0, 100.0, 0.02), np.arange(200.0, 300.0, 0.02)])
    y = np.zeros(len(t))
    y[1234], y[7777] = 3.0, -2.0
    thin_t, thin_y = thinned(Channel("q", t, y), 200)
    assert len(thin_t) < 420
    assert (np.nanmax(thin_y), np.nanmin(thin_y)) == (3.0, -2.0)
    assert thin_t[np.flatnonzero(np.isnan(thin_y))] in (99.98, thin_t[thin_t < 150.0].max())
