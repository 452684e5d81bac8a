"""Parameters fetched as a file by MAVLink FTP; MAVProxy's own decoder is the oracle."""

import struct
from pathlib import Path

import numpy as np
import pytest
from MAVProxy.modules.lib.param_ftp import ftp_param_decode
from pymavlink.dialects.v20 import ardupilotmega as dialect

from advisor.mavlink.logs.logs import read_whole_log
from advisor.mavlink.logs.parameter_file import unpacked
from tests.mavlink.builders import Sender, record

PARAMETERS = [
    ("SERVO1_FUNCTION", 2, 4),
    ("SERVO2_FUNCTION", 2, 19),
    ("SERVO2_MAX", 2, 1900),
    ("SERVO2_MIN", 2, 1100),
    ("SERVO2_REVERSED", 1, 1),
    ("SERVO2_TRIM", 2, 1512),
    ("SERVO_RATE", 3, -70000),
    ("SERVO_SBUS_GAIN", 4, 0.1),
]
FORMS = {1: "<b", 2: "<h", 3: "<i", 4: "<f"}
PIECE = 60


def packed(parameters, defaults):
    """Return a packed file. Every second parameter has a default, and zeros fill each piece."""
    data = struct.pack("<HHH", 0x671C if defaults else 0x671B, len(parameters), len(parameters))
    before = ""
    for k, (name, kind, value) in enumerate(parameters):
        shared = next((i for i, (a, b) in enumerate(zip(name, before, strict=False)) if a != b), len(before))
        shared = min(shared, 15, len(name) - 1)
        given = bool(defaults and k % 2)
        one = bytes([kind | given << 4, (len(name) - shared - 1) << 4 | shared])
        one += name[shared:].encode() + struct.pack(FORMS[kind], value) * (1 + given)
        if len(data) // PIECE != (len(data) + len(one) - 1) // PIECE:
            data += bytes(PIECE - len(data) % PIECE)
        data, before = data + one, name
    return data


def answer(number, operation, answered, offset, data, session=3):
    head = struct.pack("<HBBBBBxI", number, session, operation, len(data), answered, 0, offset)
    payload = (head + data).ljust(251, b"\0")
    return dialect.MAVLink_file_transfer_protocol_message(0, 255, 190, payload)


def log(path, messages):
    sender = Sender()
    beat = dialect.MAVLink_heartbeat_message(1, 3, 81, 0, 4, 3)
    frames = [sender.frame(m) for m in [beat, *messages, beat]]
    path.write_bytes(b"".join(record(f, 1_700_000_000_000_000 + 10_000 * k) for k, f in enumerate(frames)))
    return path


def stated(path):
    found = [c for batch in read_whole_log(path) for c in batch if c.name == "PARAM_VALUE"]
    return {
        raw.decode(): float(value)
        for c in found
        for raw, value in zip(c.fields["param_id"], c.fields["param_value"], strict=True)
    }


def pieces(data, answered=15):
    return [
        answer(n, 128, answered, at, data[at : at + PIECE]) for n, at in enumerate(range(0, len(data), PIECE))
    ]


@pytest.mark.parametrize("defaults", [False, True])
def test_a_packed_file_is_decoded_as_mavproxy_does(defaults):
    data = packed(PARAMETERS, defaults)
    oracle = ftp_param_decode(data)
    assert len(oracle.params) == len(PARAMETERS)
    assert list(unpacked(data)) == [(name.decode(), float(value)) for name, value, _ in oracle.params]


@pytest.mark.parametrize("defaults", [False, True])
@pytest.mark.parametrize("answered", [5, 15])
def test_pieces_twice_and_out_of_order_are_the_vehicles_parameters(tmp_path: Path, defaults, answered):
    sent = pieces(packed(PARAMETERS, defaults), answered)
    mixed = np.random.default_rng(5).permutation([*range(len(sent)), *range(len(sent))])
    opened = answer(0, 128, 4, 0, struct.pack("<I", 300))
    found = stated(log(tmp_path / "a.tlog", [opened, *(sent[k] for k in mixed)]))
    assert found == {name: pytest.approx(value) for name, _, value in PARAMETERS}


def test_a_missing_piece_leaves_the_parameters_before_it(tmp_path: Path):
    sent = pieces(packed(PARAMETERS, False))
    found = stated(log(tmp_path / "a.tlog", [sent[0], *sent[2:]]))
    assert 0 < len(found) < len(PARAMETERS)
    assert found["SERVO1_FUNCTION"] == 4.0


def test_another_file_in_the_same_session_states_no_parameters(tmp_path: Path):
    other = b"a mission, not parameters at all"
    assert stated(log(tmp_path / "a.tlog", pieces(other))) == {}
    both = [*pieces(other), answer(9, 128, 4, 0, b""), *pieces(packed(PARAMETERS, False))]
    assert stated(log(tmp_path / "b.tlog", both))["SERVO2_TRIM"] == 1512.0


def test_a_value_stated_by_its_own_message_counts_before_that_of_the_file(tmp_path: Path):
    own = dialect.MAVLink_param_value_message(b"SERVO2_TRIM", 1490.0, 4, 1, 0)
    found = [
        c.fields["param_value"][0]
        for batch in read_whole_log(log(tmp_path / "a.tlog", [*pieces(packed(PARAMETERS, False)), own]))
        for c in batch
        if c.name == "PARAM_VALUE" and c.fields["param_id"][0] == b"SERVO2_TRIM"
    ]
    assert found[0] == 1490.0
