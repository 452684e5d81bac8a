"""What the motion tells of sense, unit and clock of the instruments, on flights whose truth is known."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.flight.instruments.evidence import stds_of_delays
from advisor.flight.instruments.examination import examine
from advisor.flight.instruments.measured import Measured
from advisor.flight.signals.derived_alpha import DERIVED_ALPHA
from advisor.flight.signals.record import Channel

T = np.arange(0.0, 8.0, 0.02)
SPEED = 20.0
Channels = dict[str, Channel]


def flight(source: str = "AOA_SSA.AOA", provenance: str = "derived") -> Channels:
    """Return an exact flight: an oscillating angle of attack, and the path that its lift bends."""
    alpha = 0.05 + 0.06 * np.sin(5.0 * T) * np.exp(-0.4 * T) + 0.02 * np.sin(2.0 * T)
    bending = 4.0 * (alpha - np.mean(alpha))
    path = np.concatenate(([0.0], np.cumsum(np.diff(T) * (bending[1:] + bending[:-1]) / 2.0)))
    theta = alpha + path
    a_x = GRAVITY_M_S2 * np.sin(theta)
    a_z = (a_x * np.sin(alpha) - SPEED * bending - GRAVITY_M_S2 * np.cos(path)) / np.cos(alpha)
    values = {
        "theta": theta,
        "q": np.gradient(theta, T),
        "a_x": a_x,
        "a_z": a_z,
        "airspeed": np.full(len(T), SPEED),
        "climb_rate": SPEED * np.sin(path),
        "alpha": alpha,
    }
    sources = {"alpha": (source, provenance), "a_x": ("RAW_IMU.xacc", ""), "a_z": ("RAW_IMU.zacc", "")}
    return {name: Channel(name, T, y, *sources.get(name, ())) for name, y in values.items()}


def times(factor: float, *names: str) -> Callable[[Channels], Channels]:
    return lambda channels: channels | {n: replace(channels[n], y=factor * channels[n].y) for n in names}


def late(by_s: float, *names: str) -> Callable[[Channels], Channels]:
    return lambda channels: channels | {n: replace(channels[n], t=channels[n].t + by_s) for n in names}


def codes(channels: Channels) -> list[tuple[str, bool]]:
    return [(found.code, found.used) for found in examine(channels).findings]


@pytest.mark.parametrize("provenance", ["derived", "vane"])
def test_a_sound_flight_contradicts_nothing(provenance: str) -> None:
    assert codes(flight(provenance=provenance)) == []


@pytest.mark.parametrize(
    ("fault", "code", "found"),
    [
        (times(-1.0, "alpha"), "alpha_sign", "nose down"),
        (times(np.pi / 180.0, "alpha"), "alpha_unit", "rad"),
        (times(180.0 / np.pi, "alpha"), "alpha_unit", "deg"),
        (times(-1.0, "q"), "q_sign", "nose down"),
        (times(-1.0, "theta"), "theta_sign", "nose down"),
        (times(180.0 / np.pi, "q"), "q_unit", "deg/s"),
        (times(180.0 / np.pi, "theta"), "theta_unit", "deg"),
        (times(1.944, "airspeed"), "airspeed_unit", "knots"),
        (times(3.6, "airspeed"), "airspeed_unit", "km/h"),
    ],
)
def test_a_wrong_sense_or_unit_is_named_and_refused(
    fault: Callable[[Channels], Channels], code: str, found: str
) -> None:
    (wrong,) = examine(fault(flight())).findings
    assert (wrong.code, wrong.value, wrong.refuses) == (code, found, True)
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
def test_a_known_unit_or_sense_of_the_force_is_corrected_and_named(
    factors: tuple[float, float], code: str, found: str
) -> None:
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


def test_an_attitude_later_than_the_rates_of_its_own_message_is_set_right_at_any_rate() -> None:
    (wrong,) = examine(delayed(0.1, "theta", slow(flight()))).findings
    assert (wrong.code, wrong.used) == ("theta_delay_s", True)
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
