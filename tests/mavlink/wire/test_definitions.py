"""The table of messages against pymavlink's."""

import pytest
from pymavlink.dialects.v20 import ardupilotmega as dialect

from advisor.mavlink.wire.checksum import crc16
from advisor.mavlink.wire.definitions import DEFINITIONS


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
