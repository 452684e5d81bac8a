"""Trimmed logs: smaller, and the same for the advisor."""

import numpy as np
import pytest

from advisor.mavlink.wire.frames import FrameScanner
from benchmarks.trim import trim
from tests.mavlink.builders import one_by_one
from tests.mavlink.wire.test_frames import mixed_stream


def test_a_trimmed_log_has_the_same_messages_but_those_dropped() -> None:
    log = mixed_stream(seed=8, count=300)
    trimmed = trim(log, drop=["VFR_HUD"])
    before = [m for m in one_by_one(FrameScanner().feed(log)) if m.name != "VFR_HUD"]
    columns = FrameScanner().feed(trimmed)
    assert one_by_one(columns) == before
    stamps = np.sort(np.concatenate([column.arrival_s for column in columns]))
    assert np.all(np.isin(stamps, np.concatenate([c.arrival_s for c in FrameScanner().feed(log)])))
    assert len(trimmed) < len(log)


def test_a_name_that_is_no_message_is_refused() -> None:
    with pytest.raises(KeyError, match="VFR_HUT"):
        trim(b"", drop=["VFR_HUT"])
