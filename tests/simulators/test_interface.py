"""Signs and units of a simulator are told before anything is diagnosed."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.simulators.compare import compare
from advisor.simulators.interface import control_fault, interface_fault
from advisor.simulators.protocol import Condition, Inputs, Replay
from advisor.words.problems import UnusableInputError
from tests.simulators.nonlinear import Nonlinear, flown

T = 0.005 * (np.arange(800) + 0.5)
PLAIN = Nonlinear().replay(
    Condition(25.0, 300.0), Inputs(T, 0.03 * (((T > 0.5) & (T < 1.0)) * 1.0 - ((T > 1.0) & (T < 1.5)) * 1.0))
)
DEG = np.degrees(1.0)


def turned(**factors: float) -> Replay:
    return replace(PLAIN, **{name: factor * getattr(PLAIN, name) for name, factor in factors.items()})


def test_a_right_replay_has_no_fault_also_without_the_force_along_the_path():
    assert interface_fault(PLAIN) is None
    assert interface_fault(replace(PLAIN, a_x=None)) is None


@pytest.mark.parametrize(
    ("factors", "quantity", "words"),
    [
        ({"a_z": -1.0}, "a_z", r"as \+9\.79 m/s² in steady flight"),
        ({"a_z": 1.0 / 9.80665}, "a_z", "number of g"),
        ({"a_z": -1.0 / 9.80665}, "a_z", "number of g"),
        ({"q": DEG}, "q", "deg/s"),
        ({"theta": DEG}, "θ", "degrees"),
        ({"alpha": DEG}, "α", "degrees"),
        ({"alpha": DEG, "q": DEG, "theta": DEG}, "α and θ", "degrees"),
        ({"q": -1.0}, "q", "sign reversed"),
        ({"theta": -1.0}, "θ", "sign reversed"),
        ({"alpha": -1.0}, "α", "sign reversed"),
    ],
)
def test_a_wrong_sign_or_unit_is_told_by_its_quantity(factors, quantity, words):
    found = interface_fault(turned(**factors))
    assert found is not None
    assert found.quantity == quantity
    with pytest.raises(UnusableInputError, match=words):
        raise found.refuse("The simulator")


def test_small_angles_in_degrees_are_told_by_the_motion_alone():
    small = replace(PLAIN, alpha=0.1 * DEG * PLAIN.alpha, a_z=PLAIN.a_z[0] + 0.1 * (PLAIN.a_z - PLAIN.a_z[0]),
                    q=0.1 * PLAIN.q, theta=0.1 * PLAIN.theta, a_x=None)  # fmt: skip
    assert np.max(np.abs(small.alpha)) < 0.9
    assert interface_fault(small).quantity == "α"


@pytest.mark.parametrize(
    ("control", "turns", "answer", "words"),
    [
        ("elevator", 30.0, 1.2, "the wrong direction"),
        ("elevator", -30.0 / DEG, 1.2 / DEG, "less effect"),
        ("elevator", -31.0, 1.2, None),
        ("aileron", 30.0, 4.0, "it rolls to the other side"),
        ("aileron", -30.0 / DEG, 4.0 / DEG, "less effect"),
        ("aileron", -30.0 * DEG, 4.0 * DEG, "times the effect"),
        ("aileron", -300.0, 34.0, None),
        ("aileron", -300.0, 35.0, "times the effect"),
        ("rudder", 4.0, 0.6, "it yaws to the other side"),
        ("rudder", -4.0, 0.6, None),
        ("elevator", -31.0, 35.0, None),
        ("rudder", -4.0, 35.0, None),
    ],
)
def test_a_control_of_another_sense_or_in_degrees_is_told_without_a_flight(control, turns, answer, words):
    found = control_fault(control, turns, answer)
    assert (found is None) if words is None else (found is not None and words in found.observed)


def test_angles_that_move_together_are_no_wrong_sign():
    """θ and α of one slow rise: ∫q dt and the path's turning are parallel, and no slope is known."""
    rise = 0.05 * (1.0 - np.cos(0.3 * T))
    q = np.gradient(rise, T)
    a_z = -9.80665 + 25.0 * (np.gradient(rise, T) - q)
    noise = 1e-6 * np.sin(40.0 * T)
    slow = replace(PLAIN, t=T, theta=rise, alpha=rise + noise, q=q, a_z=a_z, a_x=None,
                   airspeed_m_s=np.full(T.size, 25.0), height_m=np.zeros(T.size))  # fmt: skip
    assert interface_fault(slow) is None


def changed(by: Callable[[Nonlinear, Condition, Inputs], Replay]) -> Nonlinear:
    class Wrong(Nonlinear):
        def replay(self, condition, inputs, increments=None):
            return by(Nonlinear(), condition, inputs)

    return Wrong()


@pytest.mark.parametrize(
    ("by", "words"),
    [
        (lambda s, c, i: s.replay(c, replace(i, elevator=-i.elevator)), "elevator the wrong direction"),
        (lambda s, c, i: s.replay(c, replace(i, elevator=i.elevator / DEG)), "It expects degrees"),
        (lambda s, c, i: (lambda r: replace(r, a_z=-r.a_z))(s.replay(c, i)), "a_z as .9.79"),
        (lambda s, c, i: (lambda r: replace(r, alpha=DEG * r.alpha))(s.replay(c, i)), "α in degrees"),
    ],
)
def test_gap_refuses_a_wrong_interface_in_one_sentence_instead_of_diagnosing_it(by, words):
    with pytest.raises(UnusableInputError, match=words) as told:
        compare(flown(maneuvers=3), changed(by), Aircraft())
    assert told.value.problem.code == "simulator_interface"
    assert "\n" not in told.value.problem.text
