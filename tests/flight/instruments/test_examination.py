"""What the motion tells of sense, unit and clock of the instruments, on flights whose truth is known."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from advisor.flight.instruments.axes.side_instruments import examine_side
from advisor.flight.instruments.evidence import stds_of_delays
from advisor.flight.instruments.examination import examine
from advisor.flight.instruments.examined import ExaminedRecords
from advisor.flight.instruments.measured import Evidence, Measured
from advisor.flight.signals.derived_alpha import DERIVED_ALPHA
from advisor.flight.signals.record import Channel
from advisor.flight.signals.trust import InstrumentFinding
from tests.flight.instruments.flights import (
    SPEED,
    Channels,
    T,
    doublets,
    flight,
    found_in_pitch,
    found_in_roll_and_yaw,
    late,
    times,
)

Found = Callable[..., dict[str, InstrumentFinding]]


def codes(channels: Channels) -> list[tuple[str, bool]]:
    return [(found.code, found.used) for found in examine(channels).findings]


@pytest.mark.parametrize(
    ("found_in", "instruments"),
    [
        *((found_in_pitch, {"provenance": provenance}) for provenance in ("derived", "vane")),
        *((found_in_roll_and_yaw, {"vane": vane}) for vane in (True, False)),
    ],
)
def test_a_sound_flight_contradicts_nothing(found_in: Found, instruments: dict[str, object]) -> None:
    assert found_in(dict, **instruments) == {}


@pytest.mark.parametrize(
    ("found_in", "fault", "code", "value"),
    [
        (found_in_pitch, times(-1.0, "alpha"), "alpha_sign", "nose down"),
        (found_in_pitch, times(np.pi / 180.0, "alpha"), "alpha_unit", "rad"),
        (found_in_pitch, times(180.0 / np.pi, "alpha"), "alpha_unit", "deg"),
        (found_in_pitch, times(-1.0, "q"), "q_sign", "nose down"),
        (found_in_pitch, times(-1.0, "theta"), "theta_sign", "nose down"),
        (found_in_pitch, times(180.0 / np.pi, "q"), "q_unit", "deg/s"),
        (found_in_pitch, times(180.0 / np.pi, "theta"), "theta_unit", "deg"),
        (found_in_pitch, times(1.944, "airspeed"), "airspeed_unit", "knots"),
        (found_in_pitch, times(3.6, "airspeed"), "airspeed_unit", "km/h"),
        *((found_in_roll_and_yaw, times(-1.0, n), f"{n}_sign", "left") for n in ("a_y", "beta", "r", "p")),
        (found_in_roll_and_yaw, times(-1.0, "p", "bank"), "bank_sign", "left"),
        (found_in_roll_and_yaw, times(180.0 / np.pi, "p"), "p_unit", "deg/s"),
        (found_in_roll_and_yaw, times(1e-3, "a_y"), "a_y_unit", "g"),
        (partial(found_in_roll_and_yaw, vane=False), times(1e-3, "a_y"), "a_y_unit", "g"),
        (partial(found_in_roll_and_yaw, vane=False), times(-1.0, "a_y"), "a_y_sign", "left"),
    ],
)
def test_a_wrong_sense_or_unit_is_named_and_refused(found_in, fault, code, value):
    ((named, wrong),) = found_in(fault).items()
    assert (named, wrong.value, wrong.refuses) == (code, value, True)
    assert wrong.fix


@pytest.mark.parametrize(
    ("factors", "code", "found"),
    [
        ((-1.0, 1.0), "a_z_sign", "z up"),
        ((2.048, 2.048), "a_z_unit", "2048 counts a g"),
        ((-2.048, 2.048), "a_z_unit", "2048 counts a g"),
        ((0.001, 0.001), "a_z_unit", "g"),
    ],
)
def test_a_known_unit_or_sense_of_the_force_is_corrected_and_named(factors, code, found):
    sound = flight()
    examined = examine(times(factors[1], "a_x")(times(factors[0], "a_z")(sound)))
    (wrong,) = examined.findings
    assert (wrong.code, wrong.value, wrong.used) == (code, found, True)
    for name in ("a_x", "a_z"):
        np.testing.assert_allclose(examined.channels[name].y, sound[name].y, atol=1e-9)


def test_a_force_in_an_unknown_unit_is_refused() -> None:
    (wrong,) = examine(times(0.5, "a_z", "a_x")(flight())).findings
    assert (wrong.code, wrong.refuses) == ("a_z_scale", True)
    assert wrong.value == pytest.approx(0.5, abs=0.05)


def test_a_late_force_is_set_right_where_alpha_has_one_clock() -> None:
    examined = examine(late(0.12, "a_z", "a_x")(flight()))
    (wrong,) = examined.findings
    assert (wrong.code, wrong.used) == ("a_z_delay_s", True)
    assert wrong.value == pytest.approx(0.12, abs=0.004)
    assert examined.channels["a_z"].t[0] == pytest.approx(T[0], abs=0.004)


def test_a_late_force_is_refused_where_the_climb_rate_may_be_late_as_well() -> None:
    (wrong,) = examine(late(0.12, "a_z", "a_x")(flight(DERIVED_ALPHA))).findings
    assert (wrong.code, wrong.refuses) == ("a_z_delay_s", True)
    assert "at least" in wrong.text


def test_a_late_pitch_rate_is_set_right_where_the_force_confirms_it() -> None:
    examined = examine(late(0.12, "q")(flight()))
    (wrong,) = examined.findings
    assert (wrong.code, wrong.used) == ("q_delay_s", True)
    assert wrong.value == pytest.approx(0.12, abs=0.004)


def test_pitch_rate_and_force_of_one_late_clock_are_both_named() -> None:
    found = {wrong.code: wrong for wrong in examine(late(0.12, "q", "a_z", "a_x")(flight())).findings}
    assert found.keys() == {"q_delay_s", "a_z_delay_s"}
    assert found["q_delay_s"].value == pytest.approx(0.12, abs=0.004)


def test_an_alpha_counted_to_360_deg_is_turned_and_named() -> None:
    sound = times(1.0, "alpha")(flight())
    below = sound | {"alpha": replace(sound["alpha"], y=sound["alpha"].y - 0.05)}
    examined = examine(below | {"alpha": replace(below["alpha"], y=below["alpha"].y % (2.0 * np.pi))})
    assert [(wrong.code, wrong.used) for wrong in examined.findings] == [("alpha_unit", True)]
    np.testing.assert_allclose(examined.channels["alpha"].y, below["alpha"].y, atol=1e-9)


@pytest.mark.parametrize("by_s", [0.03, 0.1, 0.2])
def test_a_late_alpha_is_left_to_the_fit(by_s: float) -> None:
    assert codes(late(by_s, "alpha")(flight())) == []


def slow(channels: Channels) -> Channels:
    """Return every fifth sample, at 10 Hz."""
    return {name: replace(c, t=c.t[::5], y=c.y[::5]) for name, c in channels.items()}


def delayed(by_s: float, name: str, channels: Channels) -> Channels:
    """Return the flight with earlier values of a channel at the same stamps, as a late filter gives them."""
    old = channels[name]
    return channels | {name: replace(old, y=np.interp(old.t - by_s, old.t, old.y))}


@pytest.mark.parametrize(
    ("found_in", "fault", "code"),
    [
        (found_in_pitch, lambda channels: delayed(0.1, "theta", slow(channels)), "theta_delay_s"),
        (found_in_roll_and_yaw, late(0.1, "bank"), "bank_delay_s"),
    ],
)
def test_an_attitude_later_than_its_rates_is_set_right(found_in, fault, code):
    ((named, wrong),) = found_in(fault).items()
    assert (named, wrong.used) == (code, True)
    assert wrong.value == pytest.approx(0.1, abs=0.01)


def test_half_an_interval_between_two_messages_is_no_late_attitude() -> None:
    assert codes(late(0.05, "theta")(slow(flight()))) == []


@pytest.mark.parametrize("arm_m", [0.5, 2.0])
def test_a_vane_ahead_of_the_centre_of_gravity_is_no_contradiction(arm_m: float) -> None:
    sound = flight(provenance="vane")
    reads = sound["alpha"].y - arm_m * sound["q"].y / SPEED
    assert codes(sound | {"alpha": replace(sound["alpha"], y=reads)}) == []


def test_filters_of_an_autopilot_are_no_contradiction() -> None:
    assert codes(late(0.011, "q", "a_z", "a_x")(flight())) == []


@pytest.mark.parametrize("name", ["q", "theta", "a_z", "a_x", "airspeed", "climb_rate", "alpha"])
def test_a_missing_or_frozen_channel_contradicts_nothing(name: str) -> None:
    sound = flight()
    assert codes({other: c for other, c in sound.items() if other != name}) == []
    if name not in ("a_z", "airspeed"):
        still = replace(sound[name], y=np.full(len(T), sound[name].y[0]))
        assert not any(found.channel == "a_z" for found in examine(sound | {name: still}).findings)


def test_earlier_evidence_counts_for_a_record_without_motion() -> None:
    earlier = {"alpha_scale": Measured(-1.0, 0.02)}
    at_rest = {name: c.cut(0.0, 0.5) for name, c in flight().items()}
    assert [found.code for found in examine(at_rest, earlier).findings] == ["alpha_sign"]


def test_a_gap_leaves_the_pitch_rate_without_an_integral() -> None:
    kept = (T < 2.0) | (T > 5.0)
    torn = {n: replace(c, t=T[kept], y=c.y[kept]) for n, c in times(-1.0, "q")(flight()).items()}
    assert codes(torn) == []


def test_a_steady_turn_is_no_contradiction() -> None:
    bank, turn, theta = np.radians(50.0), 0.5, np.radians(4.0) * np.sin(4.0 * T)
    q = np.gradient(theta, T) / np.cos(bank) + turn * np.sin(bank)
    values = {"theta": theta, "q": q, "r": np.full(len(T), turn * np.cos(bank))}
    values["bank"] = np.full(len(T), bank)
    assert codes({name: Channel(name, T, y) for name, y in values.items()}) == []


@pytest.mark.parametrize("unit", [1.944, 3.6])
def test_an_air_speed_in_another_unit_shows_without_a_measured_alpha(unit: float) -> None:
    sound = flight(DERIVED_ALPHA)
    changing = SPEED + 1.5 * np.sin(0.8 * T)
    force = sound["a_x"].y + np.gradient(changing, T)
    faster = sound | {"airspeed": Channel("airspeed", T, changing), "a_x": Channel("a_x", T, force)}
    assert codes(faster) == []
    (wrong,) = examine(times(unit, "airspeed")(faster)).findings
    assert (wrong.code, wrong.refuses) == ("airspeed_unit", True)


def test_a_late_force_shows_by_the_climb_rate_without_alpha_and_air_speed() -> None:
    sound = {name: c for name, c in flight().items() if name not in ("alpha", "airspeed")}
    assert codes(sound) == []
    assert codes(late(0.2, "climb_rate")(sound)) == []
    (wrong,) = examine(late(0.12, "a_z", "a_x")(sound)).findings
    assert (wrong.code, wrong.refuses) == ("a_z_delay_s", True)
    assert wrong.value == pytest.approx(0.12, abs=0.01)


def test_where_round_off_decides_on_the_variance_of_a_delay_no_delay_is_told():
    assert stds_of_delays(np.array([[1.0, 1.0], [1.0, 1.0]])) is None
    assert stds_of_delays(np.array([[4.0, 0.0], [0.0, -1e-18]])) is None
    assert stds_of_delays(np.array([[9.0, 0.0], [0.0, 16.0]])) == pytest.approx((5.0, 4.0))


@pytest.mark.parametrize("by_s", [1.7, -1.5])
def test_a_sideslip_of_another_clock_is_not_accused_of_its_sign(by_s: float) -> None:
    (found,) = examine_side(late(by_s, "beta")(doublets()[0])).findings
    assert found.code == "beta_delay_s"
    assert found.value == pytest.approx(by_s, abs=0.3)
    assert ("late" if by_s > 0.0 else "early") in found.text


def test_the_sentence_of_a_wrong_sign_holds_the_number_that_excludes_the_right_one() -> None:
    text = found_in_roll_and_yaw(times(-1.0, "beta"))["beta_sign"].text
    value, half = (float(x) for x in text.partition("with ")[2].split(" ")[:3:2])
    assert value + half < 0.0


def test_a_late_roll_rate_refuses() -> None:
    assert found_in_roll_and_yaw(late(0.1, "p"))["p_delay_s"].refuses


def test_a_vertical_force_of_an_unknown_unit_is_blamed_before_the_side_force() -> None:
    def of_another_unit(channels: Channels) -> Channels:
        bank = channels["bank"]
        third = np.full(len(bank.t), -9.81 / 3.0)
        a_z = Channel("a_z", bank.t, third, "RAW_IMU.zacc", "measured")
        return times(-1.0, "a_y")({**channels, "a_z": a_z})

    assert list(found_in_roll_and_yaw(of_another_unit)) == ["a_z_scale"]


FAULTS = {
    "unit": times(1000.0 / 9.80665, "a_z", "a_x"),
    "clock": late(0.2, "theta"),
    "sound": times(1.0, "q"),
}


def so_far(channels: Channels, end_s: float) -> Channels:
    return {name: channel.cut(-np.inf, end_s) for name, channel in channels.items()}


@pytest.mark.parametrize("fault", FAULTS)
def test_the_corrections_of_the_first_part_are_those_of_the_whole_record(fault: str) -> None:
    channels = FAULTS[fault](flight())
    whole = examine(channels)
    growing = ExaminedRecords(examine).so_far(channels, 0.0, float(T[-1]))
    for name, channel in whole.channels.items():
        assert growing.channels[name].t == pytest.approx(channel.t, abs=0.02)
        assert growing.channels[name].y == pytest.approx(channel.y, rel=1e-9)


def test_a_record_is_examined_again_when_its_length_has_doubled() -> None:
    examined = []

    def counted(channels: Channels, earlier: Evidence) -> object:
        examined.append(len(channels["q"]))
        return examine(channels, earlier)

    records = ExaminedRecords(counted)
    for end_s in T[10::10]:
        found = records.so_far(so_far(flight(), float(end_s)), 0.0, float(end_s))
        assert len(found.channels["q"]) == np.sum(end_s >= T)
    assert examined == [np.sum(s >= T) for s in (0.125, 0.25, 0.5, 1.0, 2.0, 4.0)]


def test_another_record_is_examined_by_itself() -> None:
    records = ExaminedRecords(examine)
    records.so_far(late(0.2, "theta")(flight()), 0.0, float(T[-1]))
    assert records.so_far(flight(), 0.5, float(T[-1])).findings == ()
