from pathlib import Path

from hypothesis import given, settings
from hypothesis import strategies as st
from pymavlink.dialects.v20 import ardupilotmega as dialect

from advisor.mavlink.link.announce import Announcer, status_text
from advisor.mavlink.link.link import Link
from advisor.mavlink.wire.frames import FrameScanner
from tests.mavlink.link.builders import UdpVehicle, free_port, heartbeat, read_all

VEHICLE = (1, 1)


def joined(announcer: Announcer) -> list[str]:
    texts = []
    while messages := announcer.speak(VEHICLE, 0.0):
        texts.append("".join(message.text for message in messages))
    return texts


@settings(derandomize=True)
@given(st.text(max_size=400), st.integers(0, 10**6))
def test_chunks_are_short_share_an_id_count_up_and_end_with_one_that_is_not_full(text, number):
    messages = status_text(text, number)
    chunks = [message.text for message in messages]
    assert all(len(chunk) == 50 for chunk in chunks[:-1])
    assert len(chunks[-1]) < 50 or len(chunks) == 1
    assert len(chunks) <= 4
    assert [message.chunk_seq for message in messages] == list(range(len(messages)))
    ids = {message.id for message in messages}
    assert len(ids) == 1
    assert (ids == {0}) == (len(messages) == 1)
    assert all(0 <= message.id <= 0xFFFF for message in messages)


def test_a_sentence_survives_its_chunks_and_becomes_ascii() -> None:
    text = "REPEAT: bank reached 43° (limit ≤ 30°), keep the wings level during the free response"
    whole = "".join(message.text for message in status_text(text, 1))
    assert whole == text.replace("°", " deg").replace("≤", "<=")


def test_each_manoeuvre_is_announced_once_and_stop_with_the_verdict_that_brought_it() -> None:
    announcer = Announcer()
    announcer.judged(1, "ACCEPTED")
    announcer.judged(1, "ACCEPTED after all")
    announcer.judged(2, "ACCEPTED", stop="TEST COMPLETE")
    announcer.judged(3, "ACCEPTED", stop="TEST COMPLETE")
    assert announcer.speak(None, 0.0) == []
    assert joined(announcer) == ["@1 ACCEPTED", "@TEST COMPLETE (2 ACCEPTED)", "@3 ACCEPTED"]


def test_roll_and_yaw_count_their_own_manoeuvres_and_stop_for_themselves() -> None:
    announcer = Announcer()
    announcer.judged(1, "ACCEPTED", stop="TEST COMPLETE")
    announcer.judged(1, "accepted", axis="roll and yaw")
    announcer.judged(
        2, "accepted", stop="TEST COMPLETE: roll and yaw", axis="roll and yaw", about="roll and yaw"
    )
    assert joined(announcer) == [
        "@TEST COMPLETE (1 ACCEPTED)",
        "@roll and yaw 1 accepted",
        "@TEST COMPLETE: roll and yaw (roll and yaw 2 accepted)",
    ]


def test_the_crew_hears_it_as_of_a_computer_on_board_and_the_recording_keeps_it(tmp_path: Path) -> None:
    port = free_port()
    vehicle = UdpVehicle(port)
    announcer = Announcer()
    with Link(f"udpin:127.0.0.1:{port}", talkers=[announcer], record_to=tmp_path / "a.tlog") as link:
        announcer.judged(1, "ACCEPTED: good manoeuvre")
        vehicle.send(heartbeat())
        heard = vehicle.hear()
        read_all(link)
    assert (heard.get_type(), heard.get_srcSystem(), heard.get_srcComponent(), heard.text) == (
        "STATUSTEXT",
        1,
        dialect.MAV_COMP_ID_ONBOARD_COMPUTER,
        "@1 ACCEPTED: good manoeuvre",
    )
    recorded = FrameScanner(["STATUSTEXT"]).feed((tmp_path / "a.tlog").read_bytes())
    assert [(part.system, part.fields["text"].tolist()) for part in recorded] == [
        (1, [b"@1 ACCEPTED: good manoeuvre"])
    ]
    vehicle.close()
