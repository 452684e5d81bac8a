import hashlib
from pathlib import Path

import pytest

from advisor.mavlink.signing import SignatureCheck, read_key
from advisor.problems import ConfigurationError
from tests.link.builders import Sender, attitude

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


def test_a_live_link_refuses_a_recording_of_yesterday() -> None:
    sender = Sender(key=KEY)
    now = sender.mavlink.signing.timestamp
    sender.mavlink.signing.timestamp -= 86_400 * 100_000
    yesterday = sender.pack(attitude(1))
    assert SignatureCheck(KEY, not_before=now).verdict(yesterday) == "replayed"
    assert SignatureCheck(KEY).verdict(yesterday) == "ok"  # a log: it may be old
