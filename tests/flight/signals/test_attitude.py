"""A vehicle that sends its attitude as a quaternion is read like any other."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from advisor.doctor.survey import Survey
from advisor.flight.maneuvers.maneuver import ManeuverFlown
from advisor.flight.signals.clocks import Attitudes
from advisor.flight.vehicle.vehicle import Vehicle
from tests.flight.columns import Wire, attitude, fly
from tests.flight.stream.test_stream import as_plain, flown


def quaternion(wire: Wire, at_s: float, boot_s: float, q: float, turned: Rotation) -> None:
    """An ATTITUDE_QUATERNION."""
    x, y, z, w = turned.as_quat().tolist()
    wire.send(
        "ATTITUDE_QUATERNION", at_s, time_boot_ms=round(boot_s * 1000), q1=w, q2=x, q3=y, q4=z,
        rollspeed=0.0, pitchspeed=q, yawspeed=0.0, repr_offset_q=np.zeros(4),
    )  # fmt: skip


class Turned(Wire):
    """Puts every ATTITUDE on the wire as a quaternion, but for those that arrive from ``until_s`` on."""

    def __init__(self, until_s: float = np.inf) -> None:
        super().__init__()
        self._until_s = until_s

    def send(self, message, at_s, /, system=1, component=1, **fields):
        if message == "ATTITUDE" and at_s < self._until_s:
            turned = Rotation.from_euler("ZYX", [fields["yaw"], fields["pitch"], fields["roll"]])
            quaternion(self, at_s, fields["time_boot_ms"] / 1000.0, fields["pitchspeed"], turned)
        else:
            super().send(message, at_s, system, component, **fields)


def flight(wire: Wire) -> Wire:
    fly(wire, 1000.0, 50.0, [4.0], 12.0, rate_hz=12.5)
    return wire


@given(angles=st.tuples(st.floats(-3.1, 3.1), st.floats(-1.5, 1.5), st.floats(-3.1, 3.1)))
def test_the_angles_are_those_of_the_rotation(angles):
    wire = Wire()
    quaternion(wire, 1.0, 1.0, 0.3, Rotation.from_euler("ZYX", angles))
    (read,) = (c for c in Attitudes().of(wire.columns()) if c.name == "ATTITUDE")
    got = [float(read.fields[name][0]) for name in ("yaw", "pitch", "roll")]
    assert got == pytest.approx(angles, abs=1e-6)
    assert read.fields["pitchspeed"].tolist() == [0.3]


def test_a_flight_told_in_quaternions_gives_the_same_manoeuvres():
    _, told = flown(flight(Turned()))
    _, plain = flown(flight(Wire()))
    (turned,), (usual,) = (
        [event.maneuver for event in events if isinstance(event, ManeuverFlown)] for events in (told, plain)
    )
    assert turned.span == usual.span
    assert turned.channels.keys() == usual.channels.keys()
    for name, channel in usual.channels.items():
        np.testing.assert_allclose(turned.channels[name].t, channel.t)
        np.testing.assert_allclose(turned.channels[name].y, channel.y, atol=1e-12)


@settings(max_examples=8, deadline=None)
@given(data=st.data())
def test_batches_make_no_difference_where_the_message_changes_in_flight(data):
    wire = flight(Turned(until_s=1006.0))
    n = len(wire)
    edges = [0, *sorted(data.draw(st.sets(st.integers(1, n - 1), max_size=20))), n]
    _, whole = flown(wire)
    _, cut = flown(wire, batches=[range(a, b) for a, b in pairwise(edges)])
    assert as_plain(cut) == as_plain(whole)


def test_a_vehicle_that_sends_both_is_read_by_its_attitude_messages():
    wire = Wire()
    for k in range(50):
        attitude(wire, 1.0 + 0.02 * k, 0.02 * k, q=0.1)
        quaternion(wire, 1.001 + 0.02 * k, 0.02 * k + 0.01, 7.0, Rotation.identity())
    (read,) = (c for c in Attitudes().of(wire.columns()) if c.name == "ATTITUDE")
    assert set(read.fields["pitchspeed"].tolist()) == {0.1}


def test_the_doctor_counts_quaternions_under_their_own_name_and_on_their_own_clock():
    survey = Survey(Vehicle(1, 1, "ardupilot", 1))
    survey.feed(flight(Turned()).columns())
    arrivals = {arrival.name: arrival for arrival in survey.arrivals}
    assert "ATTITUDE" not in arrivals
    assert arrivals["ATTITUDE_QUATERNION"].rate_hz == pytest.approx(12.5)
    assert arrivals["VFR_HUD"].rate_hz == pytest.approx(12.5)


def test_where_there_is_nothing_to_translate_nothing_is_touched():
    columns = flight(Wire()).columns()
    assert Attitudes().of(columns) is columns
