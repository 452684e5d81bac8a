"""A DataFlash log written as text is called one, whatever a ground station writes in front of it."""

import pytest

from advisor.mavlink.logs.kinds import recognised, refusal

DEFINITIONS = b"FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\nFMT, 129, 35, PARM, QNff, TimeUS\n"


@pytest.mark.parametrize("front", [b"", b"1\n\nArduPlane V4.5.6 (abcdef01)\nFree RAM: 0\nPX4\n"])
def test_a_text_log_is_named_with_the_remedy(front: bytes) -> None:
    log = front + DEFINITIONS
    assert recognised(log) is None
    problem = refusal("flight.log", log)
    assert problem.code == "text_log"
    assert problem.fix == "Give the .bin that it was made from."


def test_a_letter_that_mentions_a_definition_is_no_text_log() -> None:
    assert refusal("letter.log", b"We found FMT, 128, 89, FMT, BBnNZ, Type in it.").code == "not_a_tlog"
