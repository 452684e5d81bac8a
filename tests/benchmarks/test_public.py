"""The open benchmark's data format and metric, on a generated file."""

import numpy as np
import pytest

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from benchmarks.public.__main__ import errors
from benchmarks.public.segments import (
    CONTROLS,
    STATES,
    STROKE_RAD,
    angles,
    is_rolled,
    maneuver_of,
    read_segments,
    rolled,
)

T = np.arange(0.0, 1.0, 0.01)


def level(speed=5.0):
    """Return states (n, 13) of level flight to the north."""
    x = np.zeros((len(T), 13))
    x[:, 0], x[:, 3], x[:, 6] = speed * T, speed, 1.0
    return x


def written(tmp_path, states=None, names=STATES):
    """Write a file with one segment whose last ten samples are padding, its commands in another order."""
    x = level() if states is None else states
    valid = np.ones(len(T), bool)
    valid[-10:] = False
    inputs = ("rudder", *CONTROLS[:3])
    u = np.tile([0.4, 0.1, 0.2, 0.3], (len(T), 1))
    path = tmp_path / "flight.npz"
    order = [STATES.index(name) for name in names]
    np.savez(
        path, time_s=T[None] + 7.0, valid_mask=valid[None], x_meas=x[None][:, :, order], u_cmd=u[None],
        segment_names=np.array(["one"]), state_names=np.array(names), input_names=np.array(inputs),
    )  # fmt: skip
    return path


def test_a_segment_has_its_valid_samples_from_time_zero(tmp_path):
    (segment,) = read_segments(written(tmp_path))
    assert segment.name == "one"
    assert segment.t[0] == 0.0
    assert len(segment.t) == len(T) - 10


def test_states_and_commands_are_found_by_their_names(tmp_path):
    (segment,) = read_segments(written(tmp_path, names=STATES[::-1]))
    np.testing.assert_array_equal(segment.states, level()[:-10])
    assert {name: y[0] for name, y in segment.commands.items()} == {
        "throttle": 0.1, "elevator": 0.2, "aileron": 0.3, "rudder": 0.4,
    }  # fmt: skip


def test_a_file_without_a_state_is_refused_by_the_states_name(tmp_path):
    with pytest.raises(ValueError, match="lacks r:"):
        read_segments(written(tmp_path, names=STATES[:-1]))


def test_level_flight_has_one_g_and_no_angles(tmp_path):
    (segment,) = read_segments(written(tmp_path))
    channels = maneuver_of(segment, 1).channels
    assert channels["a_z"].y == pytest.approx(-GRAVITY_M_S2)
    assert channels["alpha"].y == pytest.approx(0.0)
    assert channels["airspeed"].y == pytest.approx(5.0)
    assert channels["elevator"].y == pytest.approx(0.2 * STROKE_RAD)


def test_a_roll_axis_turned_twice_is_the_one_of_the_file(tmp_path):
    x = level()
    x[:, 6:10] = np.array([0.9, 0.3, -0.2, 0.1]) / np.linalg.norm([0.9, 0.3, -0.2, 0.1])
    x[:, 10] = 0.5
    (segment,) = read_segments(written(tmp_path, x))
    once = rolled(segment)
    assert angles(once.states[:, 6:10])[0] == pytest.approx(-angles(segment.states[:, 6:10])[0])
    np.testing.assert_allclose(rolled(once).states, segment.states, atol=1e-12)


def test_a_record_without_motion_reverses_no_axis(tmp_path):
    assert not is_rolled([maneuver_of(segment, 1) for segment in read_segments(written(tmp_path))])


def test_the_error_of_a_state_is_over_the_range_of_its_measurement(tmp_path):
    (segment,) = read_segments(written(tmp_path))
    off = segment.states.copy()
    off[:, 0] += 0.1 * np.ptp(segment.states[:, 0])
    found = errors(segment, off)
    assert found[0] == pytest.approx(0.1)
    assert found[1:] == pytest.approx(0.0)
