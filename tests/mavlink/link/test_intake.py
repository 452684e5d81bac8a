"""Which frames of which peers are taken, and who is the vehicle."""

import pytest
from pymavlink.dialects.v20 import ardupilotmega as dialect

from advisor.mavlink.link.intake import Intake
from advisor.mavlink.wire.framing import CRC_EXTRA, SignatureCheck
from tests.mavlink.link.builders import Sender, attitude, heartbeat

KEY = bytes(range(32))
PEER = ("10.0.0.1", 14550)


def peer(port: int) -> tuple[str, int]:
    return ("10.0.0.1", port)


@pytest.mark.parametrize(("others", "completed"), [(62, 1), (63, 1), (64, 0)])
def test_the_begun_frames_of_sixty_four_peers_are_kept(others: int, completed: int) -> None:
    """A sender that changes its port with every packet would otherwise fill the memory."""
    whole = Sender().pack(attitude(1000))
    intake = Intake(CRC_EXTRA, None, None)
    intake.take([(peer(1), whole[:10])], 0.0)
    for port in range(2, 2 + others):
        intake.take([(peer(port), whole[:1])], 0.0)
    assert len(intake.take([(peer(1), whole[10:])], 0.0)) == completed


def test_the_first_autopilot_is_the_vehicle_by_its_heartbeat_alone() -> None:
    intake = Intake(CRC_EXTRA, None, None)
    intake.take([(PEER, Sender(system=3).pack(attitude(1000)))], 0.0)
    assert intake.vehicle is None
    intake.take([(PEER, Sender(system=3).pack(heartbeat()))], 0.0)
    intake.take([(PEER, Sender(system=4).pack(heartbeat()))], 0.0)
    assert intake.vehicle == (3, 1)
    assert intake.other_vehicles == {4}
    assert intake.vehicle_peer == PEER


@pytest.mark.parametrize(("asked", "vehicle"), [(None, (3, 1)), (4, (4, 1)), (5, None)])
def test_only_the_system_that_was_asked_for_is_the_vehicle(asked, vehicle):
    intake = Intake(CRC_EXTRA, asked, None)
    for system in (3, 4):
        intake.take([(PEER, Sender(system=system).pack(heartbeat()))], 0.0)
    assert intake.vehicle == vehicle


def test_with_a_key_only_signed_frames_count_and_the_radios_own_status() -> None:
    radio = dialect.MAVLink_radio_status_message(1, 1, 1, 1, 1, 1, 1)
    signed = Intake(CRC_EXTRA, None, SignatureCheck(KEY))
    assert [f.message_id for f in signed.take([(PEER, Sender().pack(attitude(1000)))], 0.0)] == []
    assert signed.counters.refused == {"unsigned": 1}
    assert len(signed.take([(PEER, Sender().pack(radio))], 0.0)) == 1
    assert len(signed.take([(PEER, Sender(key=KEY).pack(attitude(1000)))], 0.0)) == 1
    assert len(Intake(CRC_EXTRA, None, None).take([(PEER, Sender().pack(attitude(1000)))], 0.0)) == 1
