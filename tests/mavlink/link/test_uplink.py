from math import radians

import pytest
from pymavlink.dialects.v20 import ardupilotmega as dialect

from advisor.decision.inputs import StepInput
from advisor.mavlink.link.uplink import Uplink
from advisor.mavlink.wire.framing import Frame
from advisor.scripts.table import end_order, next_order
from tests.rows import row

VEHICLE = (1, 1)


def _text(text: str) -> Frame:
    """Return a STATUSTEXT frame of the vehicle."""
    message = dialect.MAVLink_statustext_message(5, text.encode())
    raw = bytes(message.pack(dialect.MAVLink(None, srcSystem=1, srcComponent=1)))
    return Frame(raw, dialect.MAVLINK_MSG_ID_STATUSTEXT, 0, 1, 1, False)


def _sent(uplink: Uplink, now_s: float) -> dict[str, float]:
    messages = uplink.speak(VEHICLE, now_s)
    assert all(type(one) is dialect.MAVLink_param_set_message for one in messages)
    return {one.param_id: one.param_value for one in messages}


def _ordered() -> Uplink:
    uplink = Uplink()
    uplink.order(2, 3.0, 0.3)
    return uplink


def test_without_an_order_nothing_is_sent() -> None:
    assert Uplink().speak(VEHICLE, 10.0) == []


def test_an_order_is_four_parameters_with_the_counter_last() -> None:
    sent = _sent(_ordered(), 10.0)
    assert list(sent) == ["SCR_USER1", "SCR_USER2", "SCR_USER3", "SCR_USER4"]
    assert list(sent.values())[:3] == [2.0, 3.0, 0.3]


NEXT, END = (2, 3.0, 0.3), end_order(3)


@row(
    "the echo confirms an input", NEXT, "NEXT {} reverse 3-2-1-1 0.30 s 3.0 deg",
    "confirms: switch up: reverse 3-2-1-1, 0.3 s, 3 deg",
)  # fmt: skip
@row("a refused input is said", NEXT, "REFUSES {}: size 3.0 deg", "refuses the next input: size 3.0 deg")
@row("the end of a multisine is confirmed", END, "ENOUGH {}", "ends input 3: its data are enough")
@row(
    "a refused end is said", END, "REFUSES {}: no multisine 3 to end",
    "refuses the end of the input: no multisine 3 to end",
)  # fmt: skip
def test_an_answer_of_the_script_is_said_and_ends_the_sending(order, answer: str, said: str) -> None:
    uplink = Uplink()
    uplink.order(*order)
    counter = _sent(uplink, 10.0)["SCR_USER4"]
    uplink.hear(_text(f"ADVISOR {answer.format(round(counter))}"), 10.5)
    assert uplink.report() == [f"the script {said}"]
    assert _sent(uplink, 20.0) == {}


def test_the_end_of_a_multisine_is_an_order_of_input_0() -> None:
    uplink = Uplink()
    uplink.order(*END)
    assert list(_sent(uplink, 10.0).values())[:3] == [0.0, -3.0, 0.0]


def test_an_order_without_an_echo_is_sent_again_with_another_counter_and_then_given_up() -> None:
    uplink = _ordered()
    counters = [_sent(uplink, 10.0 + 2.2 * k).get("SCR_USER4") for k in range(5)]
    assert len(set(counters)) == 5
    assert _sent(uplink, 100.0) == {}
    assert "not confirmed the next input after 5 tries" in uplink.report()[0]


def test_an_echo_of_other_numbers_sends_the_order_again_at_once() -> None:
    uplink = _ordered()
    counter = _sent(uplink, 10.0)["SCR_USER4"]
    uplink.hear(_text(f"ADVISOR NEXT {counter:.0f} reverse 3-2-1-1 0.30 s 1.5 deg"), 10.5)
    assert _sent(uplink, 10.5)["SCR_USER4"] == counter + 1
    assert uplink.report() == []


def test_an_echo_of_an_earlier_order_confirms_nothing() -> None:
    uplink = _ordered()
    _sent(uplink, 10.0)
    uplink.hear(_text("ADVISOR NEXT 0 reverse 3-2-1-1 0.30 s 3.0 deg"), 10.5)
    assert _sent(uplink, 13.0) != {}


def test_a_next_input_without_an_echo_is_sent_again_after_the_end_of_the_present_one() -> None:
    uplink = _ordered()
    _sent(uplink, 10.0)
    uplink.order(*end_order(3))
    counter = _sent(uplink, 11.0)["SCR_USER4"]
    uplink.hear(_text(f"ADVISOR ENOUGH {counter:.0f}"), 11.5)
    assert list(_sent(uplink, 11.6).values())[:3] == [2.0, 3.0, 0.3]


def test_a_silent_vehicle_is_sent_nothing() -> None:
    assert _ordered().speak(None, 10.0) == []


@pytest.mark.parametrize(
    ("control", "up", "which"),
    [("elevator", True, 1), ("elevator", False, 2), ("aileron", True, 3), ("rudder", True, 4)],
)
def test_the_advised_input_has_its_number_in_the_scripts_table(control: str, up: bool, which: int) -> None:
    advised = StepInput("doublet", 0.4, radians(2.0), up, control)
    assert next_order(advised) == (which, 2.0, 0.4)
