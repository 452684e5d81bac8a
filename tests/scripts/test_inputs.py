from dataclasses import replace
from itertools import combinations
from math import pi

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, Elevator, Limits
from advisor.flight.vehicle.mixers import A_TAIL, ELEVONS, FLAPERONS, SPOILERS, V_TAIL, Role
from advisor.scripts.inputs import CONTROLS, NAMES, STEPPED, disjoint_harmonics, input_of, multisine
from advisor.scripts.pace import pace_of
from advisor.scripts.table import Source, factors_by_function, forward, script_table, size_of, unit_command

MODEL = {
    "Z_alpha": -5.0, "M_alpha": -40.0, "M_q": -4.0, "M_delta_e": -60.0, "Y_beta": -0.4, "L_beta": -20.0,
    "L_p": -8.0, "L_delta_a": -60.0, "N_beta": 12.0, "N_r": -1.0, "N_delta_r": -10.0,
}  # fmt: skip


def test_the_period_is_that_of_the_model() -> None:
    assert pace_of(MODEL, "the file").period_s == pytest.approx(2.0 * pi / np.sqrt(5.0 * 4.0 + 40.0))


def test_a_stated_period_precedes_the_model() -> None:
    pace = pace_of(MODEL, "the file", 0.7)
    assert (pace.period_s, pace.why["period_s"]) == (0.7, "--period")


def test_an_unstable_model_has_no_period() -> None:
    assert pace_of(MODEL | {"M_alpha": 30.0}, "the file").why["period_s"].startswith("usual")


def test_a_model_of_pitch_alone_leaves_roll_and_yaw_to_usual_values() -> None:
    pitch = {name: MODEL[name] for name in ("Z_alpha", "M_alpha", "M_q")}
    pace = pace_of(pitch, "the file")
    assert pace.why["period_s"] == "the file"
    assert "no L_p" in pace.why["roll_s"]
    assert "no N_beta" in pace.why["dutch_roll_s"]


@pytest.mark.parametrize("name", STEPPED)
def test_the_steps_of_an_input_have_no_net_area(name: str) -> None:
    assert sum(units * share for units, share in STEPPED[name][1]) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("name", NAMES)
def test_an_input_reaches_its_size_and_rests_after_it(name: str) -> None:
    test = input_of(name, pace_of({}, ""))
    for control in test.moved:
        command = unit_command(test, control)
        assert np.max(np.abs(command)) == pytest.approx(1.0, abs=0.03)
        assert not command[round(test.length_s / 0.02) + 1 :].any()
        assert test.rest_s >= 2.0


def test_the_reverse_input_is_the_negative_one() -> None:
    pace = pace_of({}, "")
    straight, reverse = (input_of(name, pace) for name in ("3-2-1-1", "reverse 3-2-1-1"))
    assert np.array_equal(unit_command(straight, "elevator"), -unit_command(reverse, "elevator"))


def test_a_multisine_of_an_aircraft_without_a_rudder_moves_two_controls() -> None:
    assert input_of("multisine", pace_of({}, ""), ("elevator", "aileron")).moved == ("elevator", "aileron")


def test_a_size_by_the_model_keeps_half_of_the_bank_limit() -> None:
    test = input_of("aileron doublet", pace_of(MODEL, ""))
    wide, narrow = (
        size_of(test, "aileron", Aircraft(limits=Limits(bank_deg=bank)), MODEL).rad for bank in (20.0, 10.0)
    )
    assert wide == pytest.approx(2.0 * narrow)


def test_a_size_by_the_model_keeps_half_of_the_limit_of_alpha() -> None:
    test = input_of("3-2-1-1", pace_of(MODEL, ""))
    size = size_of(test, "elevator", Aircraft(limits=Limits(alpha_deg=2.0)), MODEL)
    assert "angle of attack of 1 deg" in size.why


def test_without_a_model_the_size_of_an_accepted_manoeuvre_counts() -> None:
    test = input_of("3-2-1-1", pace_of({}, ""))
    size = size_of(test, "elevator", Aircraft(), {}, flown_rad=0.05)
    assert (size.rad, size.why) == (0.05, "size of the accepted manoeuvres in the log")


def test_no_size_exceeds_nine_tenths_of_the_travel() -> None:
    test = input_of("3-2-1-1", pace_of({}, ""))
    small = Aircraft(elevator=Elevator(calibration=((1000.0, -4.0), (1500.0, 0.0), (2000.0, 4.0))))
    assert size_of(test, "elevator", small, {}, flown_rad=0.2).rad == pytest.approx(np.radians(3.6))


PAIRS = [ELEVONS, V_TAIL, A_TAIL, FLAPERONS, SPOILERS]


@pytest.mark.parametrize("pair", PAIRS, ids=lambda pair: pair[0].surface)
def test_a_control_written_through_a_mixer_is_read_back_alone(pair: tuple[Role, ...]) -> None:
    roles = dict(enumerate(pair, 1))
    moves = forward(roles)
    for control in CONTROLS:
        read = {c: sum(roles[n].weight(c) * moves[n].get(control, 0.0) for n in roles) for c in CONTROLS}
        written = {c: float(c == control and any(r.weight(c) for r in pair)) for c in CONTROLS}
        assert read == pytest.approx(written)


def test_both_elevons_go_down_for_the_elevator_and_apart_for_the_aileron() -> None:
    factors = factors_by_function()
    assert (factors[77]["elevator"], factors[78]["elevator"]) == (1.0, 1.0)
    assert factors[77]["aileron"] == -factors[78]["aileron"]


def test_inputs_of_an_absent_control_are_left_out() -> None:
    table = script_table(Aircraft(), Source(controls=("elevator", "aileron")))
    assert "rudder doublet" not in [entry.test.name for entry in table.entries]


def test_the_hash_follows_the_calibration() -> None:
    plain = script_table(Aircraft(), Source()).identity.calibration
    turned = Elevator(calibration=((1100.0, 20.0), (1900.0, -20.0)))
    assert script_table(replace(Aircraft(), elevator=turned), Source()).identity.calibration != plain
    assert script_table(replace(Aircraft(), name="another"), Source()).identity.calibration == plain


BANDS = [(5, 43), (4, 30), (2, 22), (3, 60)]
RANDOM_PHASES = 1.45
"""Relative peak factor of seven sines of equal power with random phases, on average (Morelli 2012: 1.4 to
1.5); a single sine has 1."""


@pytest.mark.parametrize(("lowest", "highest"), BANDS)
def test_no_harmonic_is_on_two_controls(lowest: int, highest: int) -> None:
    lines = disjoint_harmonics(lowest, highest, 3)
    assert len({n for mine in lines for n in mine}) == sum(map(len, lines))


@pytest.mark.parametrize(("lowest", "highest"), BANDS)
def test_every_control_has_five_to_seven_harmonics_within_the_band(lowest: int, highest: int) -> None:
    for mine in disjoint_harmonics(lowest, highest, 3):
        assert 5 <= len(mine) <= 7
        assert lowest <= mine[0]
        assert mine[-1] <= 1.15 * highest


def test_a_band_of_five_harmonics_is_refused_for_three_controls() -> None:
    with pytest.raises(ValueError, match="too few"):
        disjoint_harmonics(2, 3, 3)


def test_the_inputs_of_two_controls_are_uncorrelated() -> None:
    share = np.arange(2000) / 2000
    inputs = [multisine(mine).values(share) for mine in disjoint_harmonics(5, 43, 3)]
    for a, b in combinations(inputs, 2):
        assert abs(a @ b) < 1e-9 * (a @ a)


@pytest.mark.parametrize("harmonics", [(5, 11, 17, 23, 29, 35), (4, 7, 10, 13, 16, 19, 22), (2, 3)])
def test_a_multisine_begins_and_ends_at_zero(harmonics: tuple[int, ...]) -> None:
    assert multisine(harmonics).values(np.array([0.0, 1.0])) == pytest.approx([0.0, 0.0], abs=1e-9)


def test_the_peak_of_a_multisine_is_one() -> None:
    y = multisine((4, 7, 10, 13, 16, 19, 22)).values(np.linspace(0.0, 1.0, 5001))
    assert np.max(np.abs(y)) == pytest.approx(1.0, abs=0.02)


@pytest.mark.parametrize(("lowest", "highest"), BANDS)
def test_the_peaks_are_lower_than_those_of_random_phases(lowest: int, highest: int) -> None:
    for mine in disjoint_harmonics(lowest, highest, 3):
        y = multisine(mine).values(np.linspace(0.0, 1.0, 16 * highest, endpoint=False))
        assert np.ptp(y) / (2.0 * np.sqrt(2.0 * np.mean(y**2))) < 0.9 * RANDOM_PHASES


def test_two_computations_give_one_multisine() -> None:
    assert multisine((5, 11, 17, 23)) == multisine((5, 11, 17, 23))


@pytest.mark.parametrize(("lowest", "highest"), BANDS)
def test_the_integral_of_a_multisine_swings_about_its_start(lowest: int, highest: int) -> None:
    share = np.arange(20_000) / 20_000
    for mine in disjoint_harmonics(lowest, highest, 3):
        integral = np.cumsum(multisine(mine).values(share))
        assert abs(np.mean(integral)) < 0.2 * np.ptp(integral)
