import numpy as np
import pytest

from advisor.doctor.examination import Limit, in_order
from advisor.doctor.limits import clock_limits, clock_notes, repeat_limits
from advisor.doctor.survey import Arrival, Survey
from advisor.flight.signals.messages import Carrier, Columns
from advisor.flight.vehicle.vehicle import Vehicle
from tests.doctor.builders import among, aoa, attitude, columns, hud


def surveyed(*batches: list[Columns], carrier: Carrier = "telemetry") -> tuple[Survey, dict[str, Arrival]]:
    survey = Survey(Vehicle(1, 1, "ardupilot", 1, carrier=carrier))
    for batch in batches:
        survey.feed(batch)
    return survey, {arrival.name: arrival for arrival in survey.arrivals}


def test_an_even_message_has_its_rate_no_jitter_and_no_gap() -> None:
    _, arrivals = surveyed([attitude(np.arange(0.0, 20.0, 0.02))])
    found = arrivals["ATTITUDE"]
    assert found.rate_hz == pytest.approx(50.0)
    assert found.lowest_hz == pytest.approx(50.0, abs=0.2)
    assert found.jitter_ms == pytest.approx(0.0, abs=1e-6)
    assert found.largest_gap_s == pytest.approx(0.02)
    assert found.renewed_hz == pytest.approx(50.0)


def test_a_loop_of_50_hz_that_delivers_20_20_20_40_ms_is_called_40_hz() -> None:
    t = np.cumsum(np.tile([0.02, 0.02, 0.02, 0.04], 100))
    _, arrivals = surveyed([attitude(t)])
    assert arrivals["ATTITUDE"].rate_hz == pytest.approx(40.0, rel=0.01)
    assert arrivals["ATTITUDE"].jitter_ms == pytest.approx(8.66, rel=0.02)


def test_a_value_repeated_under_fresh_stamps_is_not_called_renewed() -> None:
    t = np.arange(0.0, 20.0, 0.02)
    master = attitude(t)
    _, arrivals = surveyed([master, aoa(t, among(master, t, t), renewed_hz=20.0)])
    assert arrivals["AOA_SSA"].rate_hz == pytest.approx(50.0, rel=0.01)
    assert arrivals["AOA_SSA"].renewed_hz == pytest.approx(20.0, rel=0.01)


def test_a_rate_cut_in_flight_shows_in_its_worst_five_seconds_not_in_its_pace() -> None:
    t = np.concatenate([np.arange(0.0, 30.0, 0.02), np.arange(30.0, 40.0, 0.25), np.arange(40.0, 70.0, 0.02)])
    _, arrivals = surveyed([attitude(t)])
    assert arrivals["ATTITUDE"].lowest_hz == pytest.approx(4.0, abs=0.3)
    assert arrivals["ATTITUDE"].rate_hz > 49.0


def test_a_silence_is_a_gap_and_does_not_lower_the_rate() -> None:
    t = np.concatenate([np.arange(0.0, 10.0, 0.02), np.arange(14.0, 24.0, 0.02)])
    _, arrivals = surveyed([attitude(t)])
    assert arrivals["ATTITUDE"].largest_gap_s == pytest.approx(4.02)
    assert arrivals["ATTITUDE"].rate_hz == pytest.approx(50.0)


def test_a_message_without_a_stamp_is_timed_by_the_attitude_before_it() -> None:
    t, slow = np.arange(0.0, 20.0, 0.02), np.arange(0.0, 20.0, 0.1)
    master = attitude(t)
    _, arrivals = surveyed([master, hud(slow, among(master, slow, t))])
    assert arrivals["VFR_HUD"].rate_hz == pytest.approx(10.0, rel=0.01)


def test_duplicates_and_overtaking_packets_change_no_rate() -> None:
    dice = np.random.default_rng(3)
    t = np.arange(0.0, 20.0, 0.02)
    late = t + dice.uniform(0.0, 0.2, len(t))
    mixed = np.repeat(t[np.argsort(late)], 1 + (dice.random(len(t)) < 0.1))
    _, arrivals = surveyed([attitude(mixed)])
    assert arrivals["ATTITUDE"].rate_hz == pytest.approx(50.0)
    assert arrivals["ATTITUDE"].largest_gap_s == pytest.approx(0.02)


def test_batches_make_no_difference() -> None:
    t = np.arange(0.0, 20.0, 0.02)
    master = attitude(t)
    alpha = aoa(t, among(master, t, t), renewed_hz=20.0)

    def cut(part: Columns, a: int, b: int) -> Columns:
        fields = {name: values[a:b] for name, values in part.fields.items()}
        return Columns(part.name, 1, 1, part.order[a:b], part.arrival_s[a:b], fields)

    whole, _ = surveyed([master, alpha])
    pieces, _ = surveyed(*([cut(master, i, i + 7), cut(alpha, i, i + 7)] for i in range(0, len(t), 7)))
    assert pieces.arrivals == whole.arrivals
    assert pieces.clocks == whole.clocks


def test_a_reboot_is_counted_and_its_silence_is_no_gap() -> None:
    first, second = np.arange(100.0, 110.0, 0.02), np.arange(3.0, 13.0, 0.02)
    together = np.concatenate([first, second])
    survey, arrivals = surveyed([attitude(together, arrival_s=np.arange(len(together)) * 0.02)])
    assert survey.clocks.boots == 2
    assert arrivals["ATTITUDE"].largest_gap_s == pytest.approx(0.02)


def test_drift_and_jitter_of_arrival_are_told_against_the_hosts_clock() -> None:
    dice = np.random.default_rng(1)
    t = np.arange(0.0, 60.0, 0.02)
    survey, _ = surveyed([attitude(t, arrival_s=t / 1.03 + dice.normal(0.0, 0.004, len(t)))])
    assert survey.clocks.drift_percent == pytest.approx(3.0, abs=0.05)
    assert survey.clocks.arrival_jitter_ms == pytest.approx(4.0, rel=0.1)


def test_a_rate_that_falls_for_most_of_a_record_is_the_mean_and_no_row_of_gaps() -> None:
    """50 Hz for 14 s, then 6.25 Hz for 62 s."""
    t = np.concatenate([np.arange(0.0, 14.0, 0.02), np.arange(14.0, 76.0, 0.16)])
    _, arrivals = surveyed([attitude(t)])
    assert arrivals["ATTITUDE"].rate_hz == pytest.approx(1088 / 76.0, rel=0.005)
    assert arrivals["ATTITUDE"].lowest_hz == pytest.approx(6.25, abs=0.3)


@pytest.mark.parametrize("times", [5.0, 1.0 / 3.0])
def test_the_clock_of_a_simulator_is_no_defect_and_is_said(times: float) -> None:
    t = np.arange(0.0, 60.0, 0.02)
    survey, _ = surveyed([attitude(t, arrival_s=t / times)])
    assert clock_limits(survey.clocks) == []
    (said,) = clock_notes(survey.clocks)
    assert f"runs {times:.2g} times as fast" in said


def test_a_clock_that_errs_by_three_percent_is_a_defect() -> None:
    t = np.arange(0.0, 60.0, 0.02)
    survey, _ = surveyed([attitude(t, arrival_s=t / 1.03)])
    assert [limit.code for limit in clock_limits(survey.clocks)] == ["clock_drift"]
    assert clock_notes(survey.clocks) == []


def test_stamps_of_another_clock_are_counted_as_strayed() -> None:
    t = np.arange(0.0, 20.0, 0.02)
    master = attitude(t)
    foreign = aoa(t + 500.0, among(master, t, t), renewed_hz=50.0)
    survey, _ = surveyed([master, foreign])
    assert survey.clocks.strayed == {"AOA_SSA": pytest.approx(1.0)}


def test_a_32_bit_counter_that_wraps_is_no_stray() -> None:
    wrap_s = 2.0**32 * 1e-6
    t = np.arange(wrap_s - 5.01, wrap_s + 5.0, 0.02)  # no stamp of exactly 0, which means none
    master = attitude(t)
    wrapped = columns(
        "SERVO_OUTPUT_RAW",
        t,
        among(master, t, t),
        time_usec=(np.round(t * 1e6) % 2**32).astype(np.uint32),
        port=0,
        servo1_raw=np.arange(len(t)),
    )
    survey, arrivals = surveyed([master, wrapped])
    assert survey.clocks.strayed == {}
    assert arrivals["SERVO_OUTPUT_RAW"].largest_gap_s == pytest.approx(0.02)


def test_another_system_is_not_counted() -> None:
    t = np.arange(0.0, 20.0, 0.02)
    other = attitude(np.arange(0.0, 20.0, 0.25))
    other = Columns("ATTITUDE", 9, 1, other.order, other.arrival_s, other.fields)
    _, arrivals = surveyed([attitude(t), other])
    assert arrivals["ATTITUDE"].count == len(t)


@pytest.mark.parametrize(("carrier", "told"), [("telemetry", 0), ("dataflash", 1), ("ulog", 1)])
def test_a_stretch_without_any_record_is_a_pause_of_a_log_and_a_fault_of_a_link(carrier, told):
    t = np.concatenate([np.arange(0.0, 20.0, 0.02), np.arange(43.0, 60.0, 0.02)])
    master = attitude(t)
    survey, arrivals = surveyed([master, aoa(t, among(master, t, t), renewed_hz=20.0)], carrier=carrier)
    assert len(survey.pauses) == told
    assert all("from 0:20.0 to 0:43.0" in sentence for sentence in survey.pauses)
    assert (arrivals["ATTITUDE"].largest_gap_s > 1.0) is (told == 0)
    assert (arrivals["AOA_SSA"].lowest_hz < 40.0) is (told == 0)
    assert survey.clocks.boots == 1


def test_a_record_that_stays_away_while_others_come_is_no_pause() -> None:
    t = np.arange(0.0, 60.0, 0.02)
    some = t[(t < 20.0) | (t > 43.0)]
    master = attitude(t)
    survey, arrivals = surveyed([master, aoa(some, among(master, some, t), 20.0)], carrier="dataflash")
    assert survey.pauses == []
    assert arrivals["AOA_SSA"].largest_gap_s == pytest.approx(23.0, abs=0.1)


def arrival(name: str, rate_hz: float, renewed_hz: float) -> Arrival:
    return Arrival(name, 1000, rate_hz, 0.1, 0.02, renewed_hz, rate_hz)


def test_a_stream_sent_twice_is_named_with_the_rate_that_counts() -> None:
    (limit,) = repeat_limits([arrival("ATTITUDE", 100.0, 50.0)])
    assert "its values change at 50 Hz only" in limit.text
    assert not limit.stops


def test_a_sound_stream_is_no_defect() -> None:
    assert repeat_limits([arrival("ATTITUDE", 50.0, 49.5), arrival("RAW_IMU", 50.0, float("nan"))]) == []


def test_defects_of_the_data_are_said_before_numbers_of_the_file() -> None:
    limits = [
        Limit("calibration", "not calibrated", "calibrate"),
        Limit("repeats", "repeats", "send once"),
        Limit("servo_limits", "assumed", "record them"),
        Limit("no_elevator", "no elevator", "give it", stops=True),
        Limit("clock_drift", "drifts", "compare"),
    ]
    said = [limit.code for limit in in_order(limits)]
    assert said == ["no_elevator", "repeats", "clock_drift", "calibration", "servo_limits"]
