"""The frame scanner on sound streams: every message, both versions, any cut, any sender."""

import time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pymavlink.dialects.v20 import ardupilotmega as dialect

from advisor.flight.signals.messages import Columns
from advisor.mavlink.logs.precompile import warm_up
from advisor.mavlink.records.record_scan import scan_records
from advisor.mavlink.wire.checksum import crc16
from advisor.mavlink.wire.definitions import DEFINITIONS
from advisor.mavlink.wire.frames import FrameScanner
from advisor.mavlink.wire.scan import copy_payloads, scan
from tests.mavlink.builders import START_US, Sender, as_message, one_by_one, random_message, record

KEY = bytes(range(32))


def read(stream: bytes, **options: object) -> list[Columns]:
    scanner = FrameScanner(**options)  # type: ignore[arg-type]
    return scanner.feed(stream) + scanner.close()


def mixed_stream(seed: int, count: int) -> bytes:
    """Messages of all kinds, known and unknown, of both versions, from several senders."""
    rng = np.random.default_rng(seed)
    senders = [Sender(1, 1), Sender(255, 190), Sender(7, 1)]
    unknown = dialect.MAVLink_vibration_message(1, 2.0, 3.0, 4.0, 5, 6, 7)
    names = list(DEFINITIONS)
    stream = b""
    for i in range(count):
        sender = senders[rng.integers(len(senders))]
        message = unknown if rng.random() < 0.2 else random_message(names[rng.integers(len(names))], rng)
        version = 1 if rng.random() < 0.3 and message.get_msgId() < 256 else 2
        stream += record(sender.frame(message, version), START_US + 1000 * i)
    return stream


@pytest.mark.parametrize("version", [1, 2])
@pytest.mark.parametrize("name", DEFINITIONS)
def test_a_message_is_decoded_field_for_field_as_pymavlink_does(name: str, version: int) -> None:
    if version == 1 and DEFINITIONS[name].id > 255:
        version = 2  # MAVLink 1 has no room for the id
    rng = np.random.default_rng(DEFINITIONS[name].id)
    sender = Sender(system=3, component=17)
    frames = [sender.frame(random_message(name, rng), version) for _ in range(40)]
    decoder = dialect.MAVLink(None)
    expected = [as_message(decoder.decode(bytearray(frame))) for frame in frames]
    assert one_by_one(read(b"".join(map(record, frames)))) == expected


@settings(max_examples=40, deadline=None, derandomize=True)
@given(data=st.data())
def test_the_result_does_not_depend_on_where_the_stream_is_cut(data: st.DataObject) -> None:
    stream = mixed_stream(seed=1, count=60)
    cuts = sorted(data.draw(st.lists(st.integers(0, len(stream)), max_size=30)))
    scanner, whole = FrameScanner(), FrameScanner()
    pieces = []
    for first, last in zip([0, *cuts], [*cuts, len(stream)], strict=True):
        pieces += scanner.feed(stream[first:last])
    pieces += scanner.close()
    at_once = whole.feed(stream) + whole.close()
    assert one_by_one(pieces) == one_by_one(at_once)
    assert sorted(order for c in pieces for order in c.order) == sorted(
        order for c in at_once for order in c.order
    )
    assert repr(scanner.statistics) == repr(whole.statistics)  # NaN equals nothing


def test_a_stream_fed_byte_by_byte_gives_each_message_once() -> None:
    stream = mixed_stream(seed=2, count=30)
    scanner = FrameScanner()
    columns = [column for i in range(len(stream)) for column in scanner.feed(stream[i : i + 1])]
    assert one_by_one(columns + scanner.close()) == one_by_one(read(stream))


def test_order_rises_over_all_messages_and_stamps_become_seconds() -> None:
    stream = mixed_stream(seed=3, count=100)
    columns = read(stream)
    order = np.concatenate([column.order for column in columns])
    arrival_s = np.concatenate([column.arrival_s for column in columns])
    by_order = np.argsort(order)
    assert np.all(np.diff(order[by_order]) > 0)
    assert np.all(np.diff(arrival_s[by_order]) > 0)
    assert abs(arrival_s.min() - START_US * 1e-6) < 0.1


def test_only_the_wanted_messages_are_decoded() -> None:
    stream = mixed_stream(seed=4, count=200)
    wanted = {"ATTITUDE", "AOA_SSA"}
    expected = [message for message in one_by_one(read(stream)) if message.name in wanted]
    assert one_by_one(read(stream, wanted=wanted)) == expected
    assert expected


def test_a_message_without_a_definition_cannot_be_wanted() -> None:
    with pytest.raises(KeyError, match="ATTITUDES"):
        FrameScanner(wanted=["ATTITUDES"])


def test_senders_are_kept_apart() -> None:
    attitude = random_message("ATTITUDE", np.random.default_rng(0))
    senders = [Sender(1, 1), Sender(1, 2), Sender(2, 1)]
    columns = read(b"".join(record(sender.frame(attitude)) for sender in senders * 3))
    assert sorted((c.system, c.component, len(c)) for c in columns) == [(1, 1, 3), (1, 2, 3), (2, 1, 3)]


def test_frames_inside_the_payload_of_another_message_are_not_messages() -> None:
    inner = record(Sender(9, 9).frame(random_message("VFR_HUD", np.random.default_rng(0))))
    tunnel = dialect.MAVLink_tunnel_message(0, 0, 1, len(inner), list(inner.ljust(128, b"\0")))
    sender = Sender()
    attitude = sender.frame(random_message("ATTITUDE", np.random.default_rng(0)))
    columns = read(record(sender.frame(tunnel)) + record(attitude))
    assert [column.name for column in columns] == ["ATTITUDE"]


def test_a_message_that_no_dialect_knows_is_stepped_over_whole() -> None:
    rng = np.random.default_rng(0)
    attitude = random_message("ATTITUDE", rng)
    sender = Sender()
    private = bytearray(sender.frame(attitude))
    private[7:10] = (54_321).to_bytes(3, "little")
    checksum = dialect.x25crc(bytes(private[1:-2]) + b"\x42").crc
    private[-2:] = checksum.to_bytes(2, "little")
    scanner = FrameScanner()
    columns = scanner.feed(record(bytes(private)) + record(sender.frame(attitude)))
    assert len(one_by_one(columns)) == 1
    assert scanner.statistics.frames == 2
    assert scanner.statistics.damaged == 0


def test_sequence_numbers_tell_how_many_frames_were_lost() -> None:
    rng = np.random.default_rng(0)
    sender = Sender(5, 6)
    records = [record(sender.frame(random_message("HEARTBEAT", rng))) for _ in range(600)]
    scanner = FrameScanner()
    scanner.feed(b"".join(records[:100] + records[103:300] + records[310:]))
    assert scanner.statistics.senders[5, 6].lost == 13


def test_a_repeated_or_late_frame_is_not_a_loss() -> None:
    rng = np.random.default_rng(0)
    sender = Sender(5, 6)
    records = [record(sender.frame(random_message("HEARTBEAT", rng))) for _ in range(10)]
    scanner = FrameScanner()
    scanner.feed(b"".join([*records[:5], records[4], records[2], *records[5:]]))
    received = scanner.statistics.senders[5, 6]
    assert (received.frames, received.lost, received.late, received.repeated) == (10, 0, 0, 2)


class TestSigned:
    def test_frames_are_read_without_a_key(self) -> None:
        frame = Sender(key=KEY).frame(random_message("ATTITUDE", np.random.default_rng(0)))
        assert len(one_by_one(read(record(frame)))) == 1

    def test_with_the_key_only_good_fresh_signatures_pass(self) -> None:
        rng = np.random.default_rng(0)
        message = random_message("ATTITUDE", rng)
        friend, stranger, unsigned = Sender(1, key=KEY), Sender(1, key=bytes(32)), Sender(1)
        friend.set_signing_time(10_000)
        first, second = friend.frame(message), friend.frame(message)
        radio = Sender(51, 68).frame(random_message("RADIO_STATUS", rng))
        frames = [first, stranger.frame(message), unsigned.frame(message), first, second, radio]
        scanner = FrameScanner(key=KEY)
        columns = scanner.feed(b"".join(map(record, frames)))
        assert sorted((c.name, len(c)) for c in columns) == [("ATTITUDE", 2), ("RADIO_STATUS", 1)]
        assert scanner.statistics.refused == {"forged": 1, "unsigned": 1, "replayed": 1}


def test_a_small_feed_costs_little() -> None:
    stream = mixed_stream(seed=5, count=20)
    scanner = FrameScanner()
    scanner.feed(stream)
    start = time.process_time()
    for _ in range(200):
        scanner.feed(stream)
    assert (time.process_time() - start) / 200 < 0.002


def test_text_ends_at_its_first_zero() -> None:
    text = dialect.MAVLink_statustext_message(6, b"seven\0garbage")
    (column,) = read(record(Sender().frame(text)))
    assert column.fields["text"].tolist() == [b"seven"]


def test_warming_up_compiles_what_reading_needs() -> None:
    warm_up()
    compiled = len(scan.signatures), len(copy_payloads.signatures), len(scan_records.signatures)
    read(mixed_stream(seed=6, count=20))
    assert (len(scan.signatures), len(copy_payloads.signatures), len(scan_records.signatures)) == compiled


@pytest.mark.parametrize("name", DEFINITIONS)
def test_a_message_is_laid_out_as_pymavlink_has_it(name: str) -> None:
    ours = DEFINITIONS[name]
    theirs = dialect.mavlink_map[ours.id]
    assert theirs.msgname == name
    assert ours.crc_extra == theirs.crc_extra
    assert ours.layout.itemsize == theirs.unpacker.size
    assert list(ours.layout.names or ()) == theirs.ordered_fieldnames


def test_the_checksum_gives_the_published_check_value() -> None:
    # CRC-16/MCRF4XX in the catalogue of parametrised CRC algorithms: check 0x6f91.
    assert crc16(b"123456789") == 0x6F91
