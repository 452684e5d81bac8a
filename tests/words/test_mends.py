"""The words of a mend are those of the autopilot and of the record that fell short."""

import re

import pytest

from advisor.words.mends import mends_of

MESSAGES = ("ATTITUDE", "SERVO_OUTPUT_RAW", "VFR_HUD", "RAW_IMU", "NAMED_VALUE_FLOAT", "GLOBAL_POSITION_INT")
ARDUPILOTS = re.compile(r"SR\d_|MAV\d_(EXTRA|RAW|RC|POS)|LOG_BITMASK|SERVOn?_F")
PX4S = re.compile(r"SDLOG|mavlink stream|MAV_\d_|vehicle_|actuator_")
RECORDS = [("ardupilot", "telemetry"), ("ardupilot", "dataflash"), ("px4", "telemetry"), ("px4", "ulog")]


def said(autopilot, record):
    mends = mends_of(autopilot, record)
    return [
        *(mends.faster(m) for m in MESSAGES),
        *(mends.called(m) for m in MESSAGES),
        mends.present(MESSAGES),
    ]


@pytest.mark.parametrize(("autopilot", "record"), RECORDS)
def test_no_mend_speaks_of_another_autopilots_settings(autopilot, record):
    foreign = PX4S if autopilot == "ardupilot" else ARDUPILOTS
    assert not [text for text in said(autopilot, record) if foreign.search(text)]


@pytest.mark.parametrize(("autopilot", "record"), [("ardupilot", "dataflash"), ("px4", "ulog")])
def test_an_autopilots_own_log_is_not_mended_by_asking_over_a_link(autopilot, record):
    assert not [text for text in said(autopilot, record) if "--request-rates" in text or "stream" in text]


def test_an_unknown_autopilot_is_told_no_parameter():
    assert not [text for text in said("generic", "telemetry") if ARDUPILOTS.search(text) or PX4S.search(text)]


def test_a_slow_topic_of_px4_is_mended_by_the_bit_that_logs_it_at_its_full_rate():
    assert "bit 4 of SDLOG_PROFILE" in mends_of("px4", "ulog").faster("ATTITUDE")
    assert "bit 1 of SDLOG_PROFILE" in mends_of("px4", "ulog").faster("VFR_HUD")


@pytest.mark.parametrize(
    ("profile", "message", "advice"),
    [
        (1, "SERVO_OUTPUT_RAW", "bit 4 of"),
        (0b10001, "SERVO_OUTPUT_RAW", "bit 3 of"),
        (0b11001, "SERVO_OUTPUT_RAW", "SDLOG_PROFILE 25 already logs actuator_outputs"),
        (0b00010, "VFR_HUD", "SDLOG_PROFILE 2 already logs airspeed"),
    ],
)
def test_no_advice_names_a_bit_that_the_log_shows_as_set(profile, message, advice):
    assert advice in mends_of("px4", "ulog", profile).faster(message)


def test_a_topic_of_a_set_that_is_logged_is_missing_because_nothing_publishes_it():
    assert "SDLOG_PROFILE 1 already logs" in mends_of("px4", "ulog", 1).present(["ATTITUDE"])
    assert "bit 5 of" in mends_of("px4", "ulog", 1).present(["ATTITUDE", "NAMED_VALUE_FLOAT"])
