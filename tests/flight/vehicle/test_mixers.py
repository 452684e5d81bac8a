"""Every mixer of ArduPlane and PX4 is undone: random sticks come back from its outputs."""

import numpy as np
import pytest

from advisor.flight.elevator.elevator_outputs import parts_of
from advisor.flight.vehicle.ardupilot_wiring import ardupilot_wiring
from advisor.flight.vehicle.px4_wiring import px4_wiring

FULL_DEG = 25.0


def _sticks():
    """Return elevator, aileron, rudder and flap at 200 instants, each in -0.3 to 0.3 of full travel."""
    return np.random.default_rng(11).uniform(-0.3, 0.3, (4, 200))


def _spoilers(elevator, aileron, rudder, full_span):
    left, right = elevator - aileron, elevator + aileron
    opened_left, opened_right = np.maximum(-rudder, 0.0), np.maximum(rudder, 0.0)
    inner = (left, right) if full_span else (0.0, 0.0)
    return [left + opened_left, inner[0] - opened_left, right + opened_right, inner[1] - opened_right]


def _read(control, wiring, outputs, trim_us=1500.0, stroke_us=400.0):
    """Return a control in shares of full travel, up or right positive, from outputs in -1 to 1."""
    parts = parts_of(control, wiring)
    assert parts, f"nothing makes the {control}"
    angles = [
        part.share * part.scale.deflection(trim_us + stroke_us * outputs[part.output]) for part in parts
    ]
    return -np.degrees(np.sum(angles, axis=0)) / FULL_DEG


def _ardupilot(functions, **others):
    return ardupilot_wiring({f"SERVO{n}_FUNCTION": float(f) for n, f in functions.items()} | others)


def _arduplane_mixers():
    e, a, r, flap = _sticks()
    yield "plain", {1: 4, 2: 19, 4: 21, 5: 2}, {}, {1: a, 2: e, 4: r, 5: flap}, (e, a, r, flap)
    yield "two plain ailerons", {1: 4, 2: 19, 4: 21, 5: 4}, {}, {1: a, 2: e, 4: r, 5: a}, (e, a, r, None)
    yield "elevons", {1: 77, 2: 78}, {}, {1: e - a, 2: e + a}, (e, a, None, None)
    yield "V-tail", {1: 4, 2: 79, 4: 80}, {}, {1: a, 2: e + r, 4: e - r}, (e, a, r, None)
    yield "flaperons", {1: 24, 2: 19, 6: 25}, {}, {1: a + flap, 2: e, 6: a - flap}, (e, a, None, flap)
    for full_span in (True, False):
        spoilers = dict(zip((1, 2, 5, 6), _spoilers(e, a, r, full_span), strict=True))
        functions = {1: 16, 2: 86, 5: 17, 6: 87}
        options = {"DSPOILER_OPTS": 3.0 if full_span else 1.0}
        yield f"spoilers, full span {full_span}", functions, options, spoilers, (e, a, r, None)
        with_tail = dict(zip((1, 2, 5, 6), _spoilers(0.0, a, r, full_span), strict=True)) | {7: e}
        options = {"DSPOILER_OPTS": 2.0 if full_span else 0.0}
        yield f"spoilers with a tail {full_span}", {**functions, 7: 19}, options, with_tail, (e, a, r, None)
    yield "sticks passed through", {1: 1, 2: 52, 6: 54}, {}, {1: a, 2: e, 6: r}, (e, a, r, None)
    yield (
        "a stick passed through from a reversed channel",
        {3: 51},
        {"RCMAP_ROLL": 4.0, "RCMAP_PITCH": 1.0, "RC1_REVERSED": 1.0, "SERVO3_REVERSED": 0.0},
        {3: -e},
        (e, None, None, None),
    )  # fmt: skip


@pytest.mark.parametrize(
    ("functions", "others", "outputs", "sticks"),
    [pytest.param(*case[1:], id=case[0]) for case in _arduplane_mixers()],
)
def test_the_sticks_come_back_from_the_outputs_of_an_arduplane_mixer(functions, others, outputs, sticks):
    wiring = _ardupilot(functions, **others)
    for control, stick in zip(("elevator", "aileron", "rudder", "flap"), sticks, strict=True):
        if stick is None:
            assert not parts_of(control, wiring)
        else:
            assert _read(control, wiring, outputs) == pytest.approx(stick, abs=1e-12)


def _px4(kinds, torques=None):
    stated = {f"CA_SV_CS{n}_TYPE": float(kind) for n, kind in enumerate(kinds)}
    for n, torque in enumerate(torques or ()):
        stated |= {f"CA_SV_CS{n}_TRQ_{axis}": value for axis, value in zip("RPY", torque, strict=True)}
    return px4_wiring({"CA_SV_CS_COUNT": float(len(kinds)), **stated})


def _px4_mixers():
    e, a, r, _ = _sticks()
    yield "plain", [1, 2, 3, 4], None, [-a, a, e, r], (e, a, r)
    yield "single aileron", [15, 3, 4], None, [a, e, r], (e, a, r)
    yield "elevons", [5, 6], None, [e - a, e + a], (e, a, None)
    yield "V-tail", [1, 2, 7, 8], None, [-a, a, e + r, e - r], (e, a, r)
    yield "A-tail", [15, 13, 14], None, [a, e - r, e + r], (e, a, r)
    yield (
        "elevons, one with the torques of the opposite direction",
        [5, 6],
        [(-0.5, 0.5, 0.0), (-0.5, -0.5, 0.0)],
        [e - a, -e - a],
        (e, a, None),
    )
    yield (
        "V-tail named the wrong way round, with its true torques",
        [8, 7],
        [(0.0, 0.5, 0.5), (0.0, 0.5, -0.5)],
        [e + r, e - r],
        (e, None, r),
    )


@pytest.mark.parametrize(
    ("kinds", "torques", "outputs", "sticks"), [pytest.param(*case[1:], id=case[0]) for case in _px4_mixers()]
)
def test_the_sticks_come_back_from_the_outputs_of_a_px4_mixer(kinds, torques, outputs, sticks):
    wiring = _px4(kinds, torques)
    numbered = dict(enumerate(outputs, start=1))
    for control, stick in zip(("elevator", "aileron", "rudder"), sticks, strict=True):
        if stick is None:
            assert not parts_of(control, wiring)
        else:
            assert _read(control, wiring, numbered, stroke_us=500.0) == pytest.approx(stick, abs=1e-12)


def test_outer_spoilers_alone_are_no_rudder():
    wiring = _ardupilot({1: 16, 2: 17})
    assert not parts_of("rudder", wiring)
    assert [part.output for part in parts_of("elevator", wiring)] == [1, 2]


def test_a_stick_that_is_passed_through_counts_only_where_no_output_has_the_control():
    wiring = _ardupilot({2: 19, 6: 52})
    assert [part.output for part in parts_of("elevator", wiring)] == [2]
    assert wiring.passed == {6: 2}
