import hashlib
from pathlib import Path

import pytest

from advisor.mavlink.wire.framing import SignatureCheck, read_key
from advisor.words.problems import ConfigurationError
from tests.mavlink.link.builders import Sender, attitude

DAY, MINUTE = 86_400 * 100_000, 60 * 100_000
KEY = hashlib.sha256(b"secret").digest()


def test_a_file_of_32_bytes_is_the_key_itself(tmp_path: Path) -> None:
    file = tmp_path / "key"
    file.write_bytes(KEY)
    assert read_key(file) == KEY


def test_any_other_file_is_a_passphrase_whatever_its_line_end(tmp_path: Path) -> None:
    for content in (b"secret", b"secret\n", b"secret\r\n"):
        file = tmp_path / "key"
        file.write_bytes(content)
        assert read_key(file) == KEY


@pytest.mark.parametrize("content", [None, b"", b"\n"])
def test_a_missing_or_empty_key_file_is_refused_by_name(tmp_path: Path, content: bytes | None) -> None:
    file = tmp_path / "key"
    if content is not None:
        file.write_bytes(content)
    with pytest.raises(ConfigurationError, match=str(file)):
        read_key(file)


def test_what_pymavlink_signs_is_believed_once_and_a_replay_is_not() -> None:
    sender = Sender(key=KEY)
    first, second = sender.pack(attitude(1)), sender.pack(attitude(2))
    check = SignatureCheck(KEY)
    assert check.verdict(first) == "ok"
    assert check.verdict(second) == "ok"
    assert check.verdict(first) == "replayed"
    assert check.verdict(second) == "replayed"


def test_unsigned_frames_of_both_protocols_and_foreign_keys_are_told_apart() -> None:
    check = SignatureCheck(KEY)
    assert check.verdict(Sender().pack(attitude(1))) == "unsigned"
    assert check.verdict(Sender().pack(attitude(1), mavlink1=True)) == "unsigned"
    assert check.verdict(Sender(key=bytes(32)).pack(attitude(1))) == "forged"


def test_one_changed_bit_anywhere_is_a_forgery() -> None:
    frame = Sender(key=KEY).pack(attitude(1))
    for i in range(3, len(frame)):
        changed = bytearray(frame)
        changed[i] ^= 1
        assert SignatureCheck(KEY).verdict(bytes(changed)) == "forged"


def test_a_forged_frame_from_the_future_does_not_silence_the_real_sender() -> None:
    check = SignatureCheck(KEY)
    genuine = Sender(key=KEY)
    future = Sender(key=bytes(32))
    future.mavlink.signing.timestamp = genuine.mavlink.signing.timestamp + 10**9
    assert check.verdict(future.pack(attitude(1))) == "forged"
    assert check.verdict(genuine.pack(attitude(1))) == "ok"


def signed_at(sender: Sender, time: int, link_id: int = 0) -> bytes:
    sender.mavlink.signing.timestamp = time
    sender.mavlink.signing.link_id = link_id
    return sender.pack(attitude(1))


def test_the_first_stamp_of_a_sender_is_believed_however_far_behind_the_hosts_clock() -> None:
    sender = Sender(key=KEY)
    months_ago = sender.mavlink.signing.timestamp - 100 * DAY
    assert SignatureCheck(KEY).verdict(signed_at(sender, months_ago)) == "ok"


def test_a_sender_whose_clock_is_right_does_not_silence_one_whose_clock_is_months_behind() -> None:
    ground, vehicle = Sender(255, 190, key=KEY), Sender(key=KEY)
    now = ground.mavlink.signing.timestamp
    check = SignatureCheck(KEY)
    assert check.verdict(signed_at(ground, now)) == "ok"
    assert check.verdict(signed_at(vehicle, now - 100 * DAY)) == "ok"


def test_yesterdays_recording_is_refused_once_its_sender_was_heard_even_under_another_link_id() -> None:
    sender = Sender(key=KEY)
    now = sender.mavlink.signing.timestamp
    check = SignatureCheck(KEY)
    assert check.verdict(signed_at(sender, now)) == "ok"
    assert check.verdict(signed_at(sender, now - DAY)) == "replayed"
    assert check.verdict(signed_at(sender, now - DAY, link_id=5)) == "replayed"


def test_a_second_link_of_one_sender_may_lie_up_to_a_minute_behind() -> None:
    sender = Sender(key=KEY)
    now = sender.mavlink.signing.timestamp
    check = SignatureCheck(KEY)
    assert check.verdict(signed_at(sender, now)) == "ok"
    assert check.verdict(signed_at(sender, now - MINUTE, link_id=1)) == "ok"
    assert check.verdict(signed_at(sender, now - MINUTE - 2, link_id=2)) == "replayed"
