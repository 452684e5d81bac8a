import numpy as np
import pytest

from advisor.aircraft.aircraft import Limits
from advisor.flight.maneuvers.axes.side_inputs import SideMovement, first_input, input_span, named
from advisor.flight.maneuvers.excitation import ROLL, YAW, flown_elsewhere
from advisor.flight.maneuvers.maneuver import Maneuver, Span
from advisor.flight.signals.record import Channel
from tests.flight.elevator.elevators import PATTERNS, slewed, steps
from tests.rows import row


def moved(loop, start_s, levels_deg, unit_s=0.5, kind="other", closed_by="quiet"):
    """Return a movement with steps of equal length and these levels."""
    steps = tuple((start_s + k * unit_s, np.radians(level)) for k, level in enumerate((*levels_deg, 0.0)))
    end_s = steps[-1][0]
    return SideMovement(loop, Span(start_s - 1.0, start_s, end_s, end_s + 3.0, kind, steps, closed_by))


def swinging(period_s, seconds=20.0, damping=0.08, from_s=0.0):
    t = np.arange(0.0, seconds, 0.04) + from_s
    omega = 2.0 * np.pi / period_s
    return Channel("r", t, 0.1 * np.exp(-damping * omega * (t - from_s)) * np.cos(omega * (t - from_s)))


def test_hands_that_hold_the_wings_level_are_no_part_of_a_rudder_doublet():
    pending = [moved(ROLL, 9.8, (0.3,), 3.0), moved(YAW, 10.0, (6.0, -6.0))]
    found, left = first_input(pending)
    assert [one.loop for one in found.movements] == [YAW]
    assert left == []


def test_rudder_and_then_aileron_without_a_rest_are_one_input():
    found, _ = first_input([moved(YAW, 10.0, (5.0, -5.0)), moved(ROLL, 12.0, (4.0, -4.0))])
    assert len(found.movements) == 2
    assert named(found) == "other"


def test_the_free_response_lasts_three_periods_of_the_dutch_roll():
    found, _ = first_input([moved(YAW, 10.0, (5.0, -5.0))])
    span = input_span(found, [], 100.0, swinging(2.0, from_s=11.0))
    assert span.end_s - span.last_step_s == pytest.approx(6.0, abs=0.3)


def test_without_an_oscillation_the_free_response_is_short():
    found, _ = first_input([moved(ROLL, 10.0, (5.0, -5.0))])
    assert input_span(found, [], 100.0, None).end_s == pytest.approx(found.last_step_s + 3.0)


def test_the_next_input_ends_the_free_response_but_a_small_correction_does_not():
    found, _ = first_input([moved(YAW, 10.0, (5.0, -5.0))])
    rate = swinging(3.0, from_s=11.0)
    big, small = moved(ROLL, 15.0, (4.0, -4.0)), moved(ROLL, 14.0, (0.3,))
    assert input_span(found, [small, big], 100.0, rate).closed_by == "next input"
    assert input_span(found, [small], 100.0, rate).closed_by == "quiet"


@pytest.mark.parametrize(
    ("movement", "name"),
    [
        (moved(ROLL, 10.0, (5.0, -5.0), kind="doublet"), "aileron doublet"),
        (moved(ROLL, 10.0, (5.0,), kind="reverse 3-2-1-1"), "aileron 3-2-1-1"),
        (moved(YAW, 10.0, (5.0, -5.0), kind="doublet"), "rudder doublet"),
        (moved(YAW, 10.0, (5.0,), kind="3-2-1-1"), "rudder 3-2-1-1"),
        (moved(YAW, 10.0, (5.0,), kind="pulse"), "dutch roll release"),
        (moved(ROLL, 10.0, (5.0,), kind="pulse"), "other"),
    ],
)
def test_an_input_has_the_name_that_pilots_give(movement, name):
    assert named(first_input([movement])[0]) == name


@pytest.mark.parametrize(("unit_s", "name"), [(0.55, "aileron 1-2-1"), (0.88, "bank to bank")])
def test_a_slow_1_2_1_goes_from_bank_to_bank(unit_s, name):
    steps = tuple(
        (10.0 + k * unit_s, level) for k, level in ((0.0, 0.08), (1.0, -0.08), (3.0, 0.08), (4.0, 0.0))
    )
    span = Span(9.0, 10.0, steps[-1][0], 18.0, "other", steps, "quiet")
    assert named(first_input([SideMovement(ROLL, span)])[0]) == name


DEG = np.radians(1.0)
T = np.arange(0.0, 20.0, 0.02)
PULL = -2.0 * DEG * np.clip((T - 3.0) / 3.0, 0.0, 1.0) * np.clip((15.0 - T) / 3.0, 0.0, 1.0)
TEST = slewed(T, 2.0 * DEG * steps(T, 3.0, 1.5, PATTERNS["3-2-1-1"]), 0.4)
RISING = np.clip((T - 3.0) / 2.0, 0.0, 1.0)
OUTSIDE = {
    "bank": (40.0 * DEG * np.clip((T - 2.5) / 1.5, 0.0, 1.0), "40 deg of bank (limit 30)"),
    "airspeed": (20.0 * (1.0 - 0.3 * RISING), "air speed 30 % from that before (limit 15)"),
    "throttle": (0.4 + 0.5 * RISING, "throttle moved by 50 % (limit 15)"),
    "aileron": (8.0 * DEG * np.sin(T), "aileron moved by 8 deg (limit 5)"),
}


def record(elevator, every=1, **others):
    values = {"elevator": elevator, **others}
    channels = {name: Channel(name, T[::every], y[::every]) for name, y in values.items()}
    shape = ((3.0, -2.0 * DEG), (14.0, 0.0))
    return Maneuver(1, 0, Span(2.0, 3.0, 14.0, 19.0, "pulse", shape, "quiet"), channels, "MANUAL")


@pytest.mark.parametrize("name", OUTSIDE)
def test_a_slow_movement_outside_of_a_limit_is_other_flying(name):
    values, said = OUTSIDE[name]
    how = flown_elsewhere(record(PULL, **{name: values}), Limits())
    assert how is not None
    assert said in how


@pytest.mark.parametrize("name", OUTSIDE)
def test_a_hand_flown_test_outside_of_a_limit_is_a_test(name):
    assert flown_elsewhere(record(TEST, **{name: OUTSIDE[name][0]}), Limits()) is None


INSIDE = {"bank": 10.0 * DEG * RISING, "airspeed": 20.0 - RISING, "throttle": 0.5 + 0.0 * T}
BANKED = {"bank": OUTSIDE["bank"][0]}


@row("within the limits it may be a test", INSIDE, Limits())
@row("the limits are those of the aircraft file", BANKED, Limits(bank_deg=60.0))
@row("an elevator at two hertz does not show whether it moved slowly", BANKED | {"every": 25}, Limits())
def test_a_slow_movement_is_no_other_flying(others, limits):
    assert flown_elsewhere(record(PULL, **others), limits) is None
