"""What the answer must not depend on: coding, order, half, kind of speed, units and signs of a mapping."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from advisor.aircraft.aircraft import Aircraft, TableColumns
from advisor.analysis.gap import _simulator_at_true_speed
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.gap.result import Diagnosis
from advisor.mavlink.logs.formats.table import quantities_of
from advisor.simulators.compare import compare
from advisor.simulators.linear import LinearSimulator
from advisor.simulators.protocol import Condition, Inputs
from advisor.simulators.stepped import Stepped
from tests.simulators.nonlinear import TRIM_RAD, G, Nonlinear, flown

PLAIN, LATE = Nonlinear(), Nonlinear(delay_s=0.05)
MODEL = {"Z_alpha": -2.7, "Z_q": 0.0, "Z_delta_e": -0.15, "M_alpha": -23.0, "M_q": -3.4, "M_delta_e": -29.0}

# A mapping states units and signs; the quantities that come out are the same.
SIGNS = st.sampled_from((1.0, -1.0))
UNITS = st.sampled_from(("rad", "deg"))
FACTORS = st.sampled_from((1.0, 1e-3, 0.514444, 0.3048, -9.80665))


@given(
    units=UNITS, elevator=SIGNS, q=SIGNS, time=FACTORS.filter(lambda x: x > 0.0), a_z=FACTORS, speed=FACTORS
)
@settings(max_examples=30, deadline=None)
def test_units_and_signs_that_a_mapping_states_change_no_quantity(units, elevator, q, time, a_z, speed):
    names = {"time": "t", "elevator": "de", "q": "q", "alpha": "a", "a_z": "nz", "airspeed": "v"}
    scale = {"elevator": elevator, "q": q, "time": time, "a_z": a_z, "airspeed": speed}
    angle = np.radians(1.0) if units == "deg" else 1.0
    true = {name: np.linspace(0.1, 0.2, 5) * (k + 1.0) for k, name in enumerate(names)}
    stated = {
        name: scale.get(name, 1.0) * (angle if name in ("elevator", "q", "alpha") else 1.0) for name in names
    }
    table = {column: true[name] / stated[name] for name, column in names.items()}
    found = quantities_of(table, TableColumns(**names, units=units, scale=scale), "x.csv")
    for name, y in true.items():
        np.testing.assert_allclose(found[name], y, rtol=1e-12)


@given(read=st.floats(10.0, 80.0), gain=st.floats(1.0, 1.3))
def test_a_reference_speed_told_as_read_or_as_true_gives_one_simulator(read, gain):
    as_read = _simulator_at_true_speed(LinearSimulator(MODEL, read), gain)
    as_true = LinearSimulator(MODEL, read * gain)
    here = Condition(30.0)
    assert as_read.linearise(here) == pytest.approx(as_true.linearise(here))


class SteppedCoding:
    """The aircraft of ``Nonlinear``, coded anew as an environment that steps by Euler's method."""

    def reset(self, speed, height, alpha, theta):
        self.x = np.array([alpha, 0.0, theta, speed, height])
        self.trim_speed, self.steep, self.a_z = speed, theta - alpha, -G

    def step(self, dt, elevator=0.0):
        for _ in range(20):
            alpha, q, theta, speed, _ = self.x
            v, bent = speed / 25.0, alpha - TRIM_RAD
            lift = -G * np.cos(self.steep) * 25.0 / self.trim_speed**2 - 3.0 * bent + 8.0 * bent * abs(bent)
            normal = v * (lift - 0.1 * elevator)
            alpha_dot = q + G / speed * np.cos(theta - alpha) + normal
            turn = v * v * (-25.0 * bent + 40.0 * bent**2 - 30.0 * elevator) + v * (
                -3.0 * q - 0.5 * alpha_dot
            )
            along = G * (np.sin(self.steep) - np.sin(theta - alpha)) - 0.05 * (speed - self.trim_speed)
            drive = along + G * np.sin(theta - alpha)
            self.a_z = speed * normal * np.cos(alpha) + drive * np.sin(alpha)
            rates = np.array([alpha_dot, turn, q, along, speed * np.sin(theta - alpha)])
            self.x = self.x + dt / 20.0 * rates

    def observe(self):
        alpha, q, theta, speed, height = map(float, self.x)
        return {
            "alpha": alpha,
            "q": q,
            "theta": theta,
            "a_z": float(self.a_z),
            "airspeed": speed,
            "height": height,
        }


def test_two_codings_of_one_aircraft_fly_alike():
    t = 0.005 * (np.arange(800) + 0.5)
    inputs = Inputs(t, 0.03 * (((t > 0.5) & (t < 1.2)) * 1.0 - ((t > 1.2) & (t < 1.9)) * 1.0))
    one, other = (s.replay(Condition(26.0, 300.0), inputs) for s in (PLAIN, Stepped(SteppedCoding())))
    q = np.interp(one.t, other.t, other.q)
    assert np.std(q - one.q) < 0.02 * np.std(one.q)
    assert np.std(np.interp(one.t, other.t, other.alpha) - one.alpha) < 0.02 * np.std(one.alpha)


@cache
def late() -> tuple[Maneuver, ...]:
    return tuple(flown(LATE, maneuvers=6))


def told(maneuvers, simulator=PLAIN) -> Diagnosis:
    return compare(list(maneuvers), simulator, Aircraft()).diagnosis


def delay(found: Diagnosis) -> float:
    assert found.causes[0].effect == "transport_delay"
    return found.causes[0].parameters["delay_s"].value


@pytest.mark.study
@pytest.mark.timeout(900)
def test_the_answer_depends_neither_on_the_coding_nor_on_the_order_nor_on_the_half():
    whole = delay(told(late()))
    assert whole == pytest.approx(0.05, abs=0.006)
    assert delay(told(late(), Stepped(SteppedCoding()))) == pytest.approx(whole, abs=0.004)
    times = [m.span.record_from_s for m in late()]
    turned = [
        replace(m.later(at - m.span.record_from_s), number=k + 1)
        for k, (m, at) in enumerate(zip(reversed(late()), times, strict=True))
    ]
    assert delay(told(turned)) == pytest.approx(whole, abs=0.004)
    first, second = (delay(told(half)) for half in (late()[:3], late()[3:]))
    assert first == pytest.approx(second, abs=0.008)
