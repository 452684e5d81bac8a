"""The stream of one vehicle: the same manoeuvres however messages are batched, delayed or mixed."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from advisor.aircraft.aircraft import Aircraft, Alpha, Elevator
from advisor.flight.maneuvers.maneuver import (
    Activity,
    ManeuverFlown,
    ManeuverStarted,
    ModeChanged,
    Notice,
    Rebooted,
    VehicleFound,
)
from advisor.flight.signals.derived_alpha import DERIVED_ALPHA
from advisor.flight.stream.stream import FlightStream
from tests.flight.columns import Wire, aoa, attitude, fly, heartbeat, hud, parameter, servo

WRAP_S = 2**32 / 1e6
ONE = [4.0]


def flown(wire, aircraft=None, batches=None, **options):
    stream = FlightStream(aircraft or Aircraft(), **options)
    events = []
    for rows in batches or [range(len(wire))]:
        events += stream.feed(wire.columns(rows))
    return stream, events + stream.finish()


def maneuvers(events):
    return [event.maneuver for event in events if isinstance(event, ManeuverFlown)]


def as_plain(events):
    """Events with every array spelt out, so that two runs can be compared to the last bit."""
    plain = []
    for event in events:
        if isinstance(event, ManeuverFlown):
            m = event.maneuver
            data = {
                name: (c.t.tolist(), c.y.tolist(), c.source, c.provenance) for name, c in m.channels.items()
            }
            plain.append((m.number, m.boot, m.span, m.mode, data))
        else:
            plain.append(repr(event))
    return plain


@pytest.fixture(scope="module")
def eventful():
    """Two boots, a second vehicle, a ground station, a mode change, late packets."""
    wire = Wire()
    heartbeat(wire, 999.0, autopilot=8, kind=6, system=255, component=190)
    fly(wire, 1000.0, 50.0, ONE, 12.0, rate_hz=12.5)
    fly(wire, 1000.5, 900.0, [2.0], 10.0, rate_hz=12.5, system=9)
    heartbeat(wire, 1008.6)
    heartbeat(wire, 1009.5, mode=7)
    aoa(wire, 1009.0, 58.52, 2.0)
    fly(wire, 1015.0, 3.0, ONE, 11.0, rate_hz=12.5)
    return wire


@pytest.fixture(scope="module")
def whole(eventful):
    """What is told of that flight where all of it arrives at once."""
    _, events = flown(eventful)
    return events


@settings(max_examples=8, deadline=None)
@given(data=st.data())
def test_no_result_depends_on_how_messages_are_batched(eventful, whole, data):
    n = len(eventful)
    cuts = sorted(data.draw(st.sets(st.integers(1, n - 1), max_size=40)))
    edges = [0, *cuts, n]
    _, cut = flown(eventful, batches=[range(a, b) for a, b in pairwise(edges)])
    assert len(maneuvers(whole)) == 2
    assert as_plain(cut) == as_plain(whole)


def test_one_message_at_a_time_gives_what_the_whole_log_gives(eventful, whole):
    _, single = flown(eventful, batches=[[i] for i in range(len(eventful))])
    assert as_plain(single) == as_plain(whole)


def test_each_boot_is_a_flight_of_its_own(eventful):
    stream, events = flown(eventful)
    first, second = maneuvers(events)
    assert (first.boot, second.boot) == (0, 1)
    assert first.span.start_s == pytest.approx(54.0, abs=0.1)
    assert second.span.start_s == pytest.approx(7.0, abs=0.1)
    assert [event for event in events if isinstance(event, Rebooted)] == [Rebooted(1)]
    assert stream.duration_s == pytest.approx(23.0, abs=0.6)


def test_only_the_vehicle_followed_counts_and_the_others_are_mentioned(eventful):
    _, events = flown(eventful)
    _, other = flown(eventful, target_system=9)
    assert [e.vehicle.system for e in events if isinstance(e, VehicleFound)] == [1]
    assert any(isinstance(e, Notice) and "--target-system" in e.text for e in events)
    (maneuver,) = maneuvers(other)
    assert maneuver.span.start_s == pytest.approx(902.0, abs=0.1)


def test_mode_changes_are_told_and_end_the_free_response(eventful):
    _, events = flown(eventful)
    modes = [e.mode for e in events if isinstance(e, ModeChanged)]
    first, _ = maneuvers(events)
    assert modes == ["MANUAL", "CRUISE", "MANUAL"]
    assert first.mode == "MANUAL"
    # Between the last heartbeat in MANUAL and the first in CRUISE nobody knows which of the two it was.
    assert first.span.end_s == pytest.approx(58.6, abs=0.1)


def test_each_power_on_keeps_its_flight_modes(eventful):
    stream, _ = flown(eventful, keep_all=True)
    kept = [[mode for _, mode in power_on.modes if mode] for power_on in stream.power_ons]
    assert kept == [["MANUAL", "CRUISE", "MANUAL"], ["MANUAL"]]


def test_a_free_response_that_was_over_before_its_mode_change_was_heard_of_is_cut_all_the_same():
    wire = Wire()
    fly(wire, 1000.0, 50.0, ONE, 14.0)
    for second in range(1, 10):
        heartbeat(wire, 1000.2 + second)
    heartbeat(wire, 1010.2, mode=7)
    (maneuver,) = maneuvers(flown(wire)[1])
    assert maneuver.span.end_s == pytest.approx(59.2, abs=0.05)
    assert maneuver.channels["q"].t[-1] <= 59.2
    assert maneuver.span.closed_by == "mode change"


def test_channels_carry_units_sources_and_provenance():
    wire = Wire()
    fly(wire, 1000.0, 50.0, ONE, 14.0)
    for k in range(700):
        wire.send(
            "RAW_IMU", 1000.01 + k / 50, time_usec=50_000_000 + 20_000 * k, xacc=100, zacc=-1000 - k % 2
        )
    _, events = flown(wire)
    (maneuver,) = maneuvers(events)
    c = maneuver.channels
    assert np.max(c["elevator"].y) == pytest.approx(np.radians(1.25))
    assert c["elevator"].source == "SERVO_OUTPUT_RAW.servo2_raw"
    assert c["elevator"].provenance == "commanded"
    assert np.max(c["alpha"].y) == pytest.approx(np.radians(3.0))
    assert (c["alpha"].source, c["alpha"].provenance) == ("AOA_SSA.AOA", "derived")
    assert np.max(c["a_z"].y) == pytest.approx(-9.80665)
    assert c["throttle"].y[0] == pytest.approx(0.5)
    assert c["airspeed"].t[0] in c["q"].t
    assert set(c) >= {"aileron", "rudder", "theta", "bank", "climb_rate"}


@pytest.mark.parametrize("message", ["SCALED_IMU", "SCALED_IMU2", "SCALED_IMU3"])
def test_the_specific_force_of_a_further_sensor_is_read_where_the_first_is_not_sent(message):
    wire = Wire()
    fly(wire, 1000.0, 50.0, ONE, 14.0)
    for k in range(700):
        wire.send(message, 1000.01 + k / 50, time_boot_ms=50_000 + 20 * k, xacc=100, zacc=-1000 - k % 2)
    (maneuver,) = maneuvers(flown(wire)[1])
    assert maneuver.channels["a_z"].source == f"{message}.zacc"
    assert np.max(maneuver.channels["a_z"].y) == pytest.approx(-9.80665)


@pytest.mark.parametrize("boot_s", [round(WRAP_S - 7.0), round(3 * WRAP_S - 5.0), round(2**32 / 1e3 - 6.0)])
def test_counters_that_wrap_during_a_manoeuvre_leave_no_trace(boot_s):
    wire, plain = Wire(), Wire()
    fly(wire, 1000.0, boot_s, ONE, 14.0)
    fly(plain, 1000.0, 50.0, ONE, 14.0)
    (wrapped,) = maneuvers(flown(wire)[1])
    (reference,) = maneuvers(flown(plain)[1])
    shift = boot_s - 50.0
    for name, channel in reference.channels.items():
        expected = channel.cut(53.49, 58.01)
        inside = wrapped.channels[name].cut(53.49 + shift, 58.01 + shift)
        assert inside.t - shift == pytest.approx(expected.t, abs=2e-3)
        assert np.array_equal(inside.y, expected.y)


def test_duplicated_and_reordered_packets_change_nothing():
    rng = np.random.default_rng(5)
    clean, poor = Wire(), Wire()
    fly(clean, 1000.0, 50.0, ONE, 14.0)
    fly(poor, 1000.0, 50.0, ONE, 14.0)
    arrived = [(at if name == "HEARTBEAT" else at + rng.uniform(0.0, 0.2), *rest)
               for at, _, name, *others in poor._sent if (rest := (0, name, *others))]  # fmt: skip
    again = [arrived[i] for i in rng.integers(0, len(arrived), 300)]
    poor._sent = [
        (at + 0.01 * (i >= len(arrived)), i, *rest[1:]) for i, (at, *rest) in enumerate(arrived + again)
    ]
    (reference,) = maneuvers(flown(clean)[1])
    (maneuver,) = maneuvers(flown(poor)[1])
    assert maneuver.span == reference.span
    for name in ("elevator", "q", "alpha", "theta"):
        assert np.array_equal(maneuver.channels[name].t, reference.channels[name].t)
        assert np.array_equal(maneuver.channels[name].y, reference.channels[name].y)


def test_alpha_is_derived_from_pitch_and_climb_where_nothing_else_says():
    wire = Wire()
    heartbeat(wire, 1000.0)
    parameter(wire, 1000.0, "SERVO2_FUNCTION", 19.0)
    for k in range(700):
        boot = 50.0 + k / 50
        attitude(wire, 1000.01 + k / 50, boot, pitch=0.05 + 0.01 * np.sin(boot))
        servo(wire, 1000.012 + k / 50, boot, {2: 1520 if 54.0 <= boot < 54.4 else 1500})
        hud(wire, 1000.013 + k / 50)
    aircraft = Aircraft(alpha=Alpha(source="derived"))
    (maneuver,) = maneuvers(flown(wire, aircraft)[1])
    alpha = maneuver.channels["alpha"]
    assert (alpha.source, alpha.provenance) == (DERIVED_ALPHA, "derived")
    assert alpha.y == pytest.approx(0.05 + 0.01 * np.sin(alpha.t), abs=1e-3)


def test_a_still_aoa_message_gives_way_to_the_derived_angle():
    wire = Wire()
    heartbeat(wire, 1000.0)
    parameter(wire, 1000.0, "SERVO2_FUNCTION", 19.0)
    for k in range(700):
        boot = 50.0 + k / 50
        attitude(wire, 1000.01 + k / 50, boot, pitch=0.05 + 0.01 * np.sin(boot))
        aoa(wire, 1000.011 + k / 50, boot, 0.0)
        servo(wire, 1000.012 + k / 50, boot, {2: 1520 if 54.0 <= boot < 54.4 else 1500})
        hud(wire, 1000.013 + k / 50)
    (maneuver,) = maneuvers(flown(wire)[1])
    assert maneuver.channels["alpha"].source == DERIVED_ALPHA


@pytest.mark.parametrize("scale", [1.0, 180.0 / np.pi])
def test_a_vane_may_send_a_named_value_in_degrees_or_radians(scale):
    wire = Wire()
    fly(wire, 1000.0, 50.0, ONE, 14.0)
    for k in range(700):
        vane = scale * (0.03 + 0.02 * np.sin(0.1 * k))
        wire.send(
            "NAMED_VALUE_FLOAT", 1000.01 + k / 50, component=191, time_boot_ms=k, name=b"VANE", value=vane
        )
    aircraft = Aircraft(alpha=Alpha(source="named_value:VANE"))
    (maneuver,) = maneuvers(flown(wire, aircraft)[1])
    alpha = maneuver.channels["alpha"]
    assert (alpha.source, alpha.provenance) == ("NAMED_VALUE_FLOAT.VANE", "vane")
    assert np.max(alpha.y) == pytest.approx(0.05, abs=1e-3)


def test_the_bundled_aircraft_has_a_simulated_vane_and_says_so():
    wire = Wire()
    wire.send("STATUSTEXT", 999.0, text=b"Bundled aircraft uav", severity=6)
    fly(wire, 1000.0, 50.0, ONE, 14.0)
    stream, events = flown(wire)
    assert maneuvers(events)[0].channels["alpha"].provenance == "simulated"
    assert stream.channels["alpha"].provenance == "simulated"


def test_a_px4_aircraft_gives_its_own_messages():
    wire = Wire()
    heartbeat(wire, 1000.0, autopilot=12, mode=1 << 16)
    for k in range(700):
        boot, now = 50.0 + k / 50, 1000.01 + k / 50
        pwm = 1600 if 54.0 <= boot < 54.4 else 1500
        actuator = [900.0, 1400.0, pwm, 900.0] + [0.0] * 28
        attitude(wire, now, boot)
        wire.send("ACTUATOR_OUTPUT_STATUS", now, time_usec=round(boot * 1e6), active=4, actuator=actuator)
        wire.send("HIGHRES_IMU", now, time_usec=round(boot * 1e6), xacc=0.1, zacc=-9.8)
        hud(wire, now, climb=0.01 * k % 1.0)
    aircraft = Aircraft(elevator=Elevator(output=3, calibration=((1000, -20.0), (2000, 20.0))))
    stream, events = flown(wire, aircraft)
    (maneuver,) = maneuvers(events)
    assert str(stream.vehicle) == "px4 1/1"
    assert maneuver.span.kind == "pulse"
    assert maneuver.mode == "Manual"
    assert maneuver.channels["a_z"].y[0] == -9.8
    assert np.max(maneuver.channels["elevator"].y) == pytest.approx(np.radians(4.0))


def test_an_idle_px4_output_moves_nothing():
    wire = Wire()
    heartbeat(wire, 1000.0, autopilot=12)
    for k in range(100):
        attitude(wire, 1000.01 + k / 50, 50.0 + k / 50)
        servo(wire, 1000.01 + k / 50, 50.0 + k / 50, {2: 900})
    stream, _ = flown(wire, Aircraft(elevator=Elevator(output=2)))
    assert "elevator" not in stream.channels


def test_stirring_the_stick_on_the_ground_is_no_manoeuvre():
    wire = Wire()
    fly(wire, 1000.0, 50.0, ONE, 14.0)
    wire._sent = [(*m[:5], {**m[5], "airspeed": 0.5}) if m[2] == "VFR_HUD" else m for m in wire._sent]
    _, events = flown(wire)
    assert maneuvers(events) == []
    assert [e.reason for e in events if isinstance(e, Activity)] == ["ground"]


def fly_a_pulse(wire):
    """Twelve seconds of flight with a pulse of the elevator from the fourth on."""
    parameter(wire, 1000.0, "SERVO2_FUNCTION", 19.0)
    for k in range(600):
        boot = 50.0 + k / 50
        attitude(wire, 1000.01 + k / 50, boot)
        aoa(wire, 1000.011 + k / 50, boot, 2.0)
        servo(wire, 1000.012 + k / 50, boot, {2: 1520 if 54.0 <= boot < 54.4 else 1500})


@pytest.mark.parametrize(("mode", "listed"), [(0, 1), (7, 0), (99, 1)])
def test_a_pulse_in_a_mode_that_closes_the_pitch_loop_is_the_autopilots_own(mode, listed):
    wire = Wire()
    heartbeat(wire, 1000.0, mode=mode)
    fly_a_pulse(wire)
    assert len(maneuvers(flown(wire)[1])) == listed


@pytest.mark.parametrize(("taken_over_s", "listed"), [(1003.5, 1), (1004.5, 0)])
def test_an_input_flown_as_soon_as_the_pilot_took_over_is_the_pilots(taken_over_s, listed):
    wire = Wire()
    heartbeat(wire, 1000.0, mode=7)
    fly_a_pulse(wire)
    # The last heartbeat of the autopilot's own mode comes before the input or after it.
    heartbeat(wire, taken_over_s + 0.05, mode=7)
    heartbeat(wire, taken_over_s + 0.95, mode=0)
    assert len(maneuvers(flown(wire)[1])) == listed


@pytest.mark.parametrize(("changed_s", "counts"), [(1002.0, True), (1012.0, False)])
def test_a_limit_that_changes_after_an_input_no_longer_scales_the_elevator(changed_s, counts):
    """The input begins after 4 s and its movement ends before 9 s."""
    wire = Wire()
    fly(wire, 1000.0, 50.0, ONE, 14.0)
    parameter(wire, 1000.5, "SERVO2_MAX", 1900.0)
    parameter(wire, changed_s, "SERVO2_MAX", 2000.0)
    stream, events = flown(wire)
    (told,) = (e.text for e in events if isinstance(e, Notice) and e.text.startswith("SERVO2_MAX"))
    assert ("is still counted" in told) is not counts
    assert stream.elevator.parts[0].scale.high_us == (2000.0 if counts else 1900.0)


def test_an_assumed_scale_of_the_elevator_is_said_once():
    wire = Wire()
    fly(wire, 1000.0, 50.0, ONE, 14.0)
    notices = [e for e in flown(wire)[1] if isinstance(e, Notice)]
    calibrated = Aircraft(elevator=Elevator(calibration=((1000, 25.0), (2000, -25.0))))
    assert [e.code for e in notices] == ["elevator_scale"]
    assert "25 deg" in notices[0].text
    assert not any(isinstance(e, Notice) for e in flown(wire, calibrated)[1])


def test_outputs_reported_in_two_messages_are_read_from_the_first_to_speak():
    wire, single = Wire(), Wire()
    fly(wire, 1000.0, 50.0, ONE, 14.0)
    fly(single, 1000.0, 50.0, ONE, 14.0)
    for k in range(700):
        wire.send("ACTUATOR_OUTPUT_STATUS", 1000.0105 + k / 50, time_usec=round(1e6 * (50.005 + k / 50)),
                  active=15, actuator=[0.1] * 32)  # fmt: skip
    (maneuver,) = maneuvers(flown(wire)[1])
    (reference,) = maneuvers(flown(single)[1])
    assert maneuver.channels["elevator"].source == "SERVO_OUTPUT_RAW.servo2_raw"
    assert np.array_equal(maneuver.channels["elevator"].y, reference.channels["elevator"].y)


def test_the_manoeuvre_being_flown_can_be_watched():
    wire = Wire()
    fly(wire, 1000.0, 50.0, ONE, 14.0)
    stream = FlightStream(Aircraft())
    columns = wire.columns()
    early = [replace(c, order=c.order[:k], arrival_s=c.arrival_s[:k],
                     fields={name: v[:k] for name, v in c.fields.items()})
             for c in columns if (k := int(np.searchsorted(c.arrival_s, 1006.0)))]  # fmt: skip
    stream.feed(early)
    watched = stream.so_far()
    assert watched is not None
    assert watched.span.start_s == pytest.approx(54.0, abs=0.05)
    assert watched.channels["q"].t[-1] == pytest.approx(56.0, abs=0.05)
    recent = stream.tracks.recent("q", 1.0)
    assert recent is not None
    assert len(recent) == 51


def test_an_input_is_announced_before_its_free_response_is_over():
    wire = Wire()
    fly(wire, 1000.0, 50.0, ONE, 14.0)
    _, events = flown(wire)
    kinds = [type(event) for event in events]
    assert kinds.index(ManeuverStarted) < kinds.index(ManeuverFlown)
    assert next(e for e in events if isinstance(e, ManeuverStarted)).kind == "3-2-1-1"


def test_ten_minutes_of_stream_keep_two():
    stream = FlightStream(Aircraft())
    for minute in range(10):
        wire = Wire()
        fly(wire, 1000.0 + 60 * minute, 50.0 + 60 * minute, [], 60.0, rate_hz=10.0)
        shift = 10_000_000 * minute
        stream.feed([replace(c, order=c.order + shift) for c in wire.columns()])
    kept = stream.tracks.recent("q", 1e9)
    assert kept is not None
    assert kept.t[-1] - kept.t[0] < 300.0
