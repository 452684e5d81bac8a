"""Earlier flights come in short stretches, so that their campaign reports while it reads them."""

from pathlib import Path

import numpy as np

from advisor.analysis.marks_file import LogSeries
from advisor.session.replay import stretches
from tests.mavlink.ardupilot.test_autopilot_logs import dataflash_flight


def test_a_log_that_comes_as_a_whole_is_cut_into_stretches_and_nothing_is_lost(tmp_path: Path) -> None:
    path = tmp_path / "flight.bin"
    path.write_bytes(dataflash_flight(100.0))
    (whole,) = LogSeries([path]).batches()
    parts = list(stretches(LogSeries([path]).batches()))
    assert len(parts) == 4
    for name in {c.name for c in whole}:
        expected = np.concatenate([c.order for c in whole if c.name == name])
        pieces = [c for part in parts for c in part if c.name == name]
        np.testing.assert_array_equal(np.concatenate([c.order for c in pieces]), np.sort(expected))
        assert all(np.ptp(c.arrival_s) <= 30.1 for c in pieces)
