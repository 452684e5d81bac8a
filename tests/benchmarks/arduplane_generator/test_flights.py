"""ArduPlane as a generator: true derivatives by its formulas, what is withheld, and one whole flight."""

from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from advisor.aircraft_file.read import parse_aircraft
from advisor.analysis.gap_flights import maneuvers_of
from benchmarks.ardupilot_plane import GRAVITY, MASS_KG, forces
from benchmarks.arduplane_generator.airframe import DENSITY, FULL_RAD, Airframe, draw_airframe
from benchmarks.arduplane_generator.cases import (
    AXES,
    KINDS,
    MAIN,
    Withheld,
    aircraft_file,
    cases,
    draw_withheld,
    truth_of,
)
from benchmarks.arduplane_generator.plan import ORDER, inputs_of, script
from benchmarks.arduplane_generator.simulator import is_here
from sim.sealed.cases import AIRCRAFT, LOG, write_case

SPEED = 21.0


def airframe(seed: int = 1) -> Airframe:
    return draw_airframe(np.random.default_rng(seed))


def accelerations(plane, alpha=0.0, beta=0.0, rates=(0, 0, 0), controls=(0.0, 0.0, 0.0)):
    """Return forces and moments of ArduPilot's plane about the trim, shape (6,)."""
    at = plane.alpha + alpha
    x = np.array([SPEED * np.cos(at), SPEED * np.sin(beta), SPEED * np.sin(at), *rates])
    return forces(plane.all, x, controls, DENSITY)


def slope(plane: Airframe, row: int, **change: float) -> float:
    """Return a moment's derivative by the difference of the plane's own formulas."""
    ((name, step),) = change.items()
    index = {"p": 0, "q": 1, "r": 2, "aileron": 0, "elevator": 1, "rudder": 2}.get(name, 0)
    key = {"alpha": "alpha", "beta": "beta"}.get(name, "rates" if name in "pqr" else "controls")

    def at(size: float) -> float:
        vector = tuple(size if k == index else 0.0 for k in range(3))
        return float(accelerations(plane, **{key: size if key in ("alpha", "beta") else vector})[row])

    return (at(step) - at(-step)) / (2.0 * step)


@pytest.mark.parametrize(
    ("name", "row", "by"),
    [
        ("M_alpha", 4, "alpha"), ("M_q", 4, "q"), ("L_beta", 3, "beta"), ("L_p", 3, "p"), ("L_r", 3, "r"),
        ("N_beta", 5, "beta"), ("N_p", 5, "p"), ("N_r", 5, "r"),
    ],
)  # fmt: skip
def test_a_moment_derivative_is_the_slope_of_the_planes_own_formula(name: str, row: int, by: str) -> None:
    plane = airframe()
    assert plane.derivatives(SPEED)[name] == pytest.approx(slope(plane, row, **{by: 1e-4}), rel=2e-3)


@pytest.mark.parametrize(
    ("name", "row", "control"),
    [
        ("M_delta_e", 4, "elevator"), ("L_delta_a", 3, "aileron"), ("L_delta_r", 3, "rudder"),
        ("N_delta_a", 5, "aileron"), ("N_delta_r", 5, "rudder"),
    ],
)  # fmt: skip
def test_a_pulse_above_the_middle_is_a_negative_deflection(name: str, row: int, control: str) -> None:
    plane = airframe()
    by_control = slope(plane, row, **{control: 1e-3})
    assert plane.derivatives(SPEED)[name] == pytest.approx(-by_control / FULL_RAD, rel=1e-6)


@pytest.mark.parametrize("seed", range(8))
def test_a_drawn_airframe_is_in_trim_with_free_controls(seed: int) -> None:
    plane = airframe(seed)
    x = plane.speed_m_s * np.array([np.cos(plane.alpha), 0.0, np.sin(plane.alpha)])
    f = forces(plane.all, np.array([*x, 0.0, 0.0, 0.0]), (0.0, 0.0, 0.0), DENSITY)
    lift = -f[2] * np.cos(plane.alpha) + f[0] * np.sin(plane.alpha)
    assert lift == pytest.approx(MASS_KG * GRAVITY, rel=1e-6)
    assert f[4] == pytest.approx(0.0, abs=1e-9)
    assert 0.0 < plane.throttle < 0.9
    d = plane.derivatives(plane.speed_m_s)
    assert d["M_alpha"] < 0.0 < d["N_beta"]


def test_the_script_holds_every_input_of_the_flight() -> None:
    plane = airframe()
    inputs = inputs_of(plane, np.random.default_rng(3))
    assert [one.control for one in inputs] == [control for control, _ in ORDER]
    lua = script(inputs, 1200, 90.0, 20.0)
    for one in inputs:
        assert f"{{{one.steps[0][0]:.3f}, {one.steps[0][1]:.0f}}}" in lua


def test_inputs_stay_below_eight_degrees() -> None:
    most = [
        abs(us)
        for seed in range(20)
        for one in inputs_of(airframe(seed), np.random.default_rng(seed))
        for _, us in one.steps
    ]
    assert max(most) * 25.0 / 500.0 < 8.0


def test_a_third_of_the_flights_has_nothing_withheld() -> None:
    assert Counter(KINDS)["none"] / len(KINDS) == pytest.approx(1.0 / 3.0)


@pytest.mark.parametrize("kind", sorted(set(KINDS)))
def test_a_file_states_what_is_true_but_for_what_is_withheld(kind: str) -> None:
    plane, withheld = airframe(), draw_withheld(kind, np.random.default_rng(5))
    file = aircraft_file(plane, withheld, 20.0)
    true = truth_of("pitch", withheld, plane, 20.0)["derivatives"]
    wrong = {n for n, v in file["model"].items() if abs(v - true[n]) > 1e-4 * max(abs(true[n]), 1e-3)}
    assert wrong - {"Z_0", "M_0"} == set(withheld.factors)
    assert bool(withheld.factors) == (kind == "parameters")
    assert (file["elevator"]["lag_s"] != withheld.parameters["SIM_SERVO_SPEED"]) == (kind == "lag")
    assert parse_aircraft(file).model["M_alpha"] == pytest.approx(file["model"]["M_alpha"])


def test_a_lag_of_all_servos_is_true_of_each_control_of_roll_and_yaw() -> None:
    withheld = Withheld("lag", lag_s=0.2, stated_lag_s=0.1)
    told = truth_of("lateral", withheld, airframe(), 20.0)["effects"]
    assert set(told) == {"aileron_actuator_lag", "rudder_actuator_lag"}
    assert told["aileron_actuator_lag"]["lag_s"] == pytest.approx(0.1)
    assert set(truth_of("pitch", withheld, airframe(), 20.0)["effects"]) == {"actuator_lag"}


def test_a_delay_of_all_commands_of_roll_and_yaw_is_also_one_cause() -> None:
    told = truth_of("lateral", Withheld("delay", delay_s=0.09), airframe(), 20.0)["effects"]
    assert set(told) == {"aileron_transport_delay", "rudder_transport_delay", "common_transport_delay"}
    assert told["common_transport_delay"] == {"delay_s": 0.09}
    assert set(truth_of("pitch", Withheld("delay", delay_s=0.09), airframe(), 20.0)["effects"]) == {
        "transport_delay"
    }


def test_wrong_numbers_of_one_axis_are_no_fault_of_the_other() -> None:
    withheld = Withheld("parameters", {"M_alpha": 1.3, "L_p": 0.8})
    for axis, name in zip(AXES, ("M_alpha", "L_p"), strict=True):
        told = truth_of(axis, withheld, airframe(), 20.0)
        assert set(told["factors"]) == {name} <= set(MAIN[axis])


def test_a_kind_that_nobody_draws_is_refused_by_name() -> None:
    with pytest.raises(ValueError, match="none, parameters"):
        next(cases(1, 1, "jelly"))


@pytest.mark.study
@pytest.mark.skipif(not is_here(), reason="ArduPlane's simulator does not lie next to this checkout")
def test_a_flight_of_the_autopilot_has_its_inputs_on_both_axes(tmp_path: Path) -> None:
    pitch, lateral = cases(2, 4, "none")
    assert pitch.log == lateral.log
    write_case(pitch, tmp_path / "case")
    aircraft = parse_aircraft(dict(pitch.aircraft))
    assert (tmp_path / "case" / AIRCRAFT).is_file()
    assert len(maneuvers_of([tmp_path / "case" / LOG], aircraft).maneuvers) >= 5
