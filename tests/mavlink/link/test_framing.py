import random

import pytest
from fastcrc.crc16 import mcrf4xx
from hypothesis import given, settings
from hypothesis import strategies as st
from pymavlink.dialects.v20 import ardupilotmega as dialect

from advisor.mavlink.wire.framing import FrameCutter
from tests.mavlink.link.builders import Sender, attitude, heartbeat

CRC_EXTRA = {number: message.crc_extra for number, message in dialect.mavlink_map.items()}
KEY = bytes(range(32))


def mixed_frames(count: int) -> list[bytes]:
    plain, signed = Sender(1), Sender(2, key=KEY)
    frames = []
    for i in range(count):
        message = heartbeat() if i % 5 == 0 else attitude(i)
        frames.append((signed if i % 3 == 0 else plain).pack(message, mavlink1=i % 3 == 1))
    return frames


FRAMES = mixed_frames(60)


@settings(derandomize=True)
@given(st.lists(st.integers(1, 400), max_size=40))
def test_frames_come_out_whole_wherever_the_stream_is_cut(cuts: list[int]) -> None:
    stream = b"".join(FRAMES)
    cutter = FrameCutter(CRC_EXTRA)
    out = []
    start = 0
    for length in cuts:
        out += cutter.feed(stream[start : start + length])
        start += length
    out += cutter.feed(stream[start:])
    assert [frame.raw for frame in out] == FRAMES
    assert cutter.bad_crc == 0


@pytest.mark.parametrize("seed", range(40))
def test_garbage_between_frames_costs_no_frame_and_invents_none(seed: int) -> None:
    dice = random.Random(seed)
    stream = b""
    for frame in FRAMES:
        stream += dice.randbytes(dice.choice([0, 0, 1, 7, 40])) + frame
    # A last stretch of frames lets every false start inside the garbage come to its end.
    closing = [Sender(9).pack(attitude(i)) for i in range(20)]
    taken = [frame.raw for frame in FrameCutter(CRC_EXTRA).feed(stream + b"".join(closing))]
    assert [raw for raw in taken if raw in FRAMES] == FRAMES
    assert len(taken) <= len(FRAMES) + len(closing)


def test_a_damaged_frame_is_counted_and_the_next_is_taken() -> None:
    broken = bytearray(FRAMES[2])
    broken[12] ^= 0x40
    cutter = FrameCutter(CRC_EXTRA)
    out = cutter.feed(FRAMES[1] + bytes(broken) + FRAMES[4] + FRAMES[5])
    assert [frame.raw for frame in out] == [FRAMES[1], FRAMES[4], FRAMES[5]]
    assert cutter.bad_crc == 1


def test_a_message_nobody_defined_passes_where_a_frame_is_due_but_never_out_of_garbage() -> None:
    body = b"\x04\x00\x00\x07\x01\x01\x50\xc3\x00abcd"  # message 50000
    unknown = b"\xfd" + body + mcrf4xx(body + b"\x2a").to_bytes(2, "little")
    cutter = FrameCutter(CRC_EXTRA)
    assert [f.message_id for f in cutter.feed(FRAMES[1] + unknown + FRAMES[2])] == [30, 50000, 30]
    assert cutter.feed(b"\x00garbage" + unknown) == []


def test_a_frame_tells_who_sent_what() -> None:
    sender = Sender(7, 3, key=KEY)
    sender.pack(heartbeat())
    (frame,) = FrameCutter(CRC_EXTRA).feed(sender.pack(attitude(5)))
    assert (frame.system, frame.component, frame.sequence, frame.message_id) == (7, 3, 1, 30)
    assert frame.signed
    assert frame.payload[:4] == (5).to_bytes(4, "little")
