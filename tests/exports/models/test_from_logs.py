"""Roll and yaw for the files of a diagnosis of pitch: the campaign is judged only where they were flown."""

from pathlib import Path

import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.exports.models.axes import handed_over as roll_and_yaw

BIN = Path(__file__).parents[2] / "cases" / "base.bin"


def test_a_flight_without_aileron_and_rudder_inputs_is_read_once_and_judged_never(monkeypatch):
    def judged(*_, **__):
        raise AssertionError

    monkeypatch.setattr(roll_and_yaw, "read_whole", judged)
    assert roll_and_yaw.side_of_logs([BIN], Aircraft()) is None


def test_a_log_that_cannot_be_read_tells_nothing_of_roll_and_yaw(tmp_path):
    (tmp_path / "x.tlog").write_bytes(b"")
    assert roll_and_yaw.side_of_logs([tmp_path / "x.tlog"], Aircraft()) is None


@pytest.mark.parametrize("flies", [True, False])
def test_the_campaign_is_judged_where_a_control_of_roll_and_yaw_was_flown(monkeypatch, flies):
    class JudgedError(Exception):
        pass

    def judged(*_, **__):
        raise JudgedError

    monkeypatch.setattr(roll_and_yaw, "flies_roll_or_yaw", lambda *_: flies)
    monkeypatch.setattr(roll_and_yaw, "read_whole", judged)
    if flies:
        with pytest.raises(JudgedError):
            roll_and_yaw.side_of_logs([BIN], Aircraft())
    else:
        assert roll_and_yaw.side_of_logs([BIN], Aircraft()) is None
