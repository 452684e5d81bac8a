"""The course of a whole flight: nothing is missed between two looks, and a thinned line looks the same."""

import numpy as np

from advisor.aircraft import Aircraft
from advisor.campaign.campaign import Campaign
from advisor.flight.record import Channel
from advisor.mavlink.logs import open_log
from advisor.report.page.course import CourseWatch, slices, thinned
from tests.flights import TWO, recorded

LOG = recorded("linear", 1.0, maneuvers=TWO)


def test_a_log_in_slices_loses_no_message_and_keeps_its_order() -> None:
    batch = [columns for part in open_log(LOG) for columns in part]
    pieces = list(slices(batch))
    assert len(pieces) > 1
    for name in ("ATTITUDE", "VFR_HUD"):
        whole = np.concatenate([c.order for c in batch if c.name == name])
        again = np.concatenate([c.order for piece in pieces for c in piece if c.name == name])
        np.testing.assert_array_equal(again, np.sort(whole))


def test_the_course_holds_every_sample_since_the_first_heartbeat() -> None:
    campaign = Campaign(Aircraft())
    watch = CourseWatch(campaign)
    stamps = []
    for batch in open_log(LOG):
        for piece in slices(batch):
            stamps += [c.fields["time_boot_ms"] for c in piece if c.name == "ATTITUDE"]
            campaign.feed(piece)
            watch.look()
    (course,) = watch.courses
    q = next(channel for channel in course.channels if channel.name == "q")
    # The first ATTITUDE of the log comes before the vehicle is known.
    np.testing.assert_allclose(q.t, np.unique(np.concatenate(stamps))[1:] / 1e3)


def test_a_thinned_line_keeps_its_peaks_and_breaks_in_a_gap() -> None:
    t = np.concatenate([np.arange(0.0, 100.0, 0.02), np.arange(200.0, 300.0, 0.02)])
    y = np.zeros(len(t))
    y[1234], y[7777] = 3.0, -2.0
    thin_t, thin_y = thinned(Channel("q", t, y), 200)
    assert len(thin_t) < 420
    assert (np.nanmax(thin_y), np.nanmin(thin_y)) == (3.0, -2.0)
    assert thin_t[np.flatnonzero(np.isnan(thin_y))] in (99.98, thin_t[thin_t < 150.0].max())
