"""A whole flight of the bundled aircraft through what links do to it."""

import pytest
from pymavlink.dialects.v20 import ardupilotmega as dialect

from tests.flights import TWO, recorded
from tests.mavlink.link.air import Record, flown, judged, records_of, through_a_poor_radio
from tests.mavlink.link.builders import Sender, attitude, heartbeat

# One flight, read and judged once as it was.
pytestmark = pytest.mark.xdist_group("flight through a link")

HEARTBEAT, PARAM_VALUE = 0, 22


@pytest.fixture(scope="module")
def flight() -> list[Record]:
    """The first two manoeuvres of the demonstration."""
    return records_of(recorded("linear", 1.0, maneuvers=TWO))


@pytest.fixture(scope="module")
def samples(flight: list[Record]) -> list[tuple[float, ...]]:
    return flown(flight)


@pytest.fixture(scope="module")
def undisturbed(flight: list[Record]) -> list[tuple[bool, ...]]:
    return verdicts(flight)


def verdicts(records: list[Record]) -> list[tuple[bool, ...]]:
    """Accepted or not, per rule, and stop or not, for every manoeuvre."""
    return [
        (
            event.judged.verdict.accepted,
            *(rule.accepted for rule in event.judged.verdict.rules.values()),
            event.flight_test.decision == "stop",
        )
        for event in judged(records)
    ]


def message_id(record: Record) -> int:
    """Of a MAVLink 2 frame."""
    return int.from_bytes(record.frame[7:10], "little")


def amid(records: list[Record], strangers: list[bytes]) -> list[Record]:
    """The flight with a stranger's frames, one by one, between its own."""
    mixed = []
    for i, record in enumerate(records):
        mixed.append(record)
        if i % 9 == 0:
            mixed.append(Record(record.stamp_us, strangers[(i // 9) % len(strangers)]))
    return mixed


def test_how_the_stream_is_cut_into_batches_changes_no_digit(flight, samples):
    assert flown(flight, batch=50) == samples


def test_a_fifth_of_the_packets_lost_and_200_ms_of_jitter_change_no_verdict(flight, undisturbed):
    assert len(undisturbed) == 2
    # Parameters come by a protocol that repeats what is lost; everything else is sent once.
    asked = [record for record in flight if message_id(record) == PARAM_VALUE]
    sent = [record for record in flight if message_id(record) != PARAM_VALUE]
    delivered = asked + through_a_poor_radio(sent, seed=2, loss=0.2, jitter_s=0.2)
    disturbed = verdicts(sorted(delivered, key=lambda record: record.stamp_us))
    assert [(accepted, stop) for accepted, *_, stop in disturbed] == [
        (accepted, stop) for accepted, *_, stop in undisturbed
    ]


def test_strangers_on_the_link_change_no_sample_of_any_manoeuvre(flight, samples):
    intruder = Sender(system=9)
    strangers = [
        intruder.pack(message)
        for message in (
            heartbeat(),
            attitude(5, pitch=1.5),
            dialect.MAVLink_aoa_ssa_message(90_000_000, 25.0, 0.0),
            dialect.MAVLink_servo_output_raw_message(90_000_000, 0, *[1100] * 8),
            dialect.MAVLink_param_value_message(b"SERVO2_FUNCTION", 0.0, 2, 1, 1),
            dialect.MAVLink_param_value_message(b"SERVO2_REVERSED", 1.0, 2, 1, 1),
            dialect.MAVLink_vfr_hud_message(90.0, 90.0, 0, 100, 0.0, 0.0),
            dialect.MAVLink_statustext_message(6, b"ArduPlane V9.9.9", 0, 0),
        )
    ]
    known = next(i for i, record in enumerate(flight) if message_id(record) == HEARTBEAT)
    disturbed = flight[: known + 1] + amid(flight[known + 1 :], strangers)
    assert flown(disturbed) == samples


def test_with_a_key_even_who_claims_to_be_the_vehicle_changes_no_sample(flight, samples):
    key = bytes(range(32))
    genuine, impostor = Sender(system=1, key=key), Sender(system=1)
    strangers = [impostor.pack(attitude(5, pitch=1.5)), impostor.pack(heartbeat())]
    signed = [
        Record(record.stamp_us, genuine.pack(dialect.MAVLink(None).decode(bytearray(record.frame))))
        for record in flight
    ]
    assert flown(amid(signed, strangers), key=key) == samples
