"""A name that leaves most of the gap only resembles what is there; the right one leaves next to nothing."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft import Aircraft
from advisor.gap.candidates.catalogue import variants_for
from advisor.gap.diagnose import diagnose
from advisor.gap.fitting.fit import fit
from advisor.gap.fitting.holdout import hold_out
from advisor.gap.fitting.uncertainty import worth
from advisor.gap.noise.quiet import quiet_rms
from advisor.gap.records.floor import stated_floor
from advisor.gap.records.prepare import prepare
from advisor.gap.result import VISIBLE
from advisor.gap.search.baseline import fit_baseline
from advisor.gap.search.score import addition
from advisor.gap.search.stage import Stage
from advisor.gap.search.waterfall import build_up
from advisor.gap.simulator.layout import DERIVATIVES
from advisor.gap.unnamed.leftover import Leftover
from advisor.gap.unnamed.remainder import (
    is_all_named,
    is_of_no_use,
    of_the_input,
    only_numbers,
    only_resemble,
    remainder,
    removed_beyond_air,
)
from tests.gap.generator import Setup, fly

pytestmark = pytest.mark.study
"""Whole diagnoses, run by ``make study-gap``."""


@pytest.fixture(scope="module")
def gyro():
    """A flight with a gyro that reads too much, and the plain model of it."""
    flown = fly(Setup(maneuvers=6, q_scale=0.1, seed=41))
    return fit_baseline(prepare(flown, Aircraft()), Aircraft())


def named_beside(gyro, effect):
    """The stages without an effect and with it, and the floor of each channel."""
    problem, plain = gyro
    variant = next(v for v in variants_for(problem.flights) if v.effect == effect)
    named = fit(problem, plain.point.with_effect(variant, variant.starts[0]), plain.noise, 25)
    stages = [Stage(fitted, hold_out(problem, fitted), (), None) for fitted in (plain, named)]
    floor = np.minimum(quiet_rms(problem, named), np.sqrt(stages[-1].held_out.mean_square))
    return stages, floor


def left_beside(gyro, effect):
    """What is left beside an effect that was put into the model."""
    stages, floor = named_beside(gyro, effect)
    return remainder(gyro[0], stages, None, floor)


def test_an_effect_that_leaves_most_of_the_gap_is_not_the_cause_but_something_unknown(gyro):
    found = left_beside(gyro, "actuator_lag")
    assert found is not None
    assert found.block == "pitch_rate_sensor"


def test_the_right_effect_leaves_nothing_to_ask_about(gyro):
    assert left_beside(gyro, "pitch_rate_scale") is None


def test_names_have_explained_all_there_is_where_they_leave_nothing_above_the_noise(gyro):
    stages, floor = named_beside(gyro, "pitch_rate_scale")
    assert is_all_named(stages, floor)
    assert not is_all_named(stages[:1], np.sqrt(stages[0].held_out.mean_square))
    assert not is_all_named(*named_beside(gyro, "actuator_lag"))


def test_where_nothing_was_named_there_is_nothing_to_doubt(gyro):
    problem, plain = gyro
    stage = Stage(plain, hold_out(problem, plain), (), None)
    assert remainder(problem, [stage], None, np.sqrt(stage.held_out.mean_square) / 10.0) is None


@pytest.mark.parametrize("belief", [0.0, 20.0])
def test_what_was_named_for_the_files_numbers_is_held_against_those(gyro, belief):
    problem, plain = gyro
    (first, last), floor = named_beside(gyro, "actuator_lag")
    independent = worth(problem, last.fitted.innovations)
    added = addition(problem, plain, first.held_out, last.fitted, "actuator_lag", independent)
    stages = [replace(first, added=replace(added, belief=belief)), last]
    far_off = replace(first.held_out, mean_square=100.0 * first.held_out.mean_square)
    left = remainder(problem, stages, far_off, floor)
    assert (left is None) == (belief > 0.0)


@pytest.mark.parametrize(("effect", "right"), [("pitch_rate_scale", True), ("actuator_lag", False)])
def test_in_moving_air_names_must_take_away_most_of_what_the_air_does_not_explain(gyro, effect, right):
    problem, _ = gyro
    (first, last), _ = named_beside(gyro, effect)
    independent = worth(problem, last.fitted.innovations)
    added = addition(problem, first.fitted, first.held_out, last.fitted, effect, independent)
    stages = [replace(first, added=added), last]
    removed = removed_beyond_air(stages)
    assert removed is not None
    assert (removed > 0.9) == right
    assert only_resemble(stages) != right
    # What brings the file's derivatives back is named for that.
    assert not only_resemble([replace(first, added=replace(added, belief=20.0)), last])
    assert not only_resemble([first])


@pytest.mark.parametrize(("leaves", "enough"), [(5.0, True), (7.0, False)])
def test_what_a_right_model_leaves_of_manoeuvres_kept_out_is_not_held_against_small_names(
    gyro, leaves, enough
):
    """In multiples of the model's numbers per sample: of eight, five are less than half beside its own."""
    (first, last), _ = named_beside(gyro, "pitch_rate_scale")
    one = len(last.fitted.point.shared) / sum(map(len, last.fitted.innovations))

    def with_excess(stage, excess):
        square = (1.0 + excess) * last.fitted.noise**2
        return replace(stage, held_out=replace(stage.held_out, innovation_square=square))

    removed = removed_beyond_air([with_excess(first, 8.0 * one), with_excess(last, leaves * one)])
    assert (removed > 0.5) == enough


def test_a_name_must_take_some_of_the_gap_away_that_the_aircraft_file_leaves(gyro):
    problem, _ = gyro
    stages, floor = named_beside(gyro, "pitch_rate_scale")
    without, beside = (stage.held_out for stage in stages)
    assert not is_of_no_use(problem, stages, None, floor)
    assert not is_of_no_use(problem, stages, without, floor)
    assert is_of_no_use(problem, stages, beside, floor)
    assert is_of_no_use(problem, [stages[0], stages[0]], None, floor)
    assert not is_of_no_use(problem, stages[:1], beside, floor)


def test_names_that_only_polish_wrong_numbers_are_none(gyro):
    flown = fly(Setup(maneuvers=6, seed=41))
    right = fit_baseline(prepare(flown, Aircraft()), Aircraft())[1].point.derivatives
    off = dict(zip(DERIVATIVES, right * [1.0, 1.0, 1.0, 0.7, 1.5, 1.2], strict=True))
    fitted = fit_baseline(prepare(flown, Aircraft()), Aircraft(model=off))
    stages, floor = named_beside(fitted, "actuator_lag")
    file_model = replace(stages[0].held_out, mean_square=30.0 * floor**2)
    assert only_numbers(fitted[0], stages, file_model, floor)
    assert not only_numbers(fitted[0], stages, None, floor)
    assert not only_numbers(fitted[0], stages[:1], file_model, floor)
    # A gyro that reads too much leaves more than that, whatever the file's numbers are worth.
    stages, floor = named_beside(gyro, "pitch_rate_scale")
    problem = replace(gyro[0], believed=fitted[0].believed)
    assert not only_numbers(problem, stages, file_model, floor)


@pytest.fixture(scope="module")
def play():
    """The stages of a flight with play between command and surface."""
    flown = fly(Setup(maneuvers=4, switches={"play": 0.02}, seed=44))
    problem, plain = fit_baseline(prepare(flown, Aircraft()), Aircraft())
    return build_up(problem, plain, variants_for(problem.flights)), stated_floor(problem.flights)


def test_what_play_leaves_beside_most_of_a_gap_is_the_inputs_unless_its_law_is_known(play):
    stages, floor = play
    assert stages[0].added.effect == "actuator_backlash"
    elsewhere = Leftover("moment_equation", 0.3, (("moment_equation", 1.0), ("air", 0.6)))
    found = of_the_input(elsewhere, stages, None, floor)
    assert found.block == "input"
    assert found.ranking == (("input", 1.0), ("moment_equation", 1.0), ("air", 0.6))
    known = replace(elsewhere, note="The damping in pitch is not the same up and down.")
    assert of_the_input(known, stages, None, floor) == known
    # Of a gap that it hardly takes from, it is a likeness and tells nothing of the place.
    much = replace(stages[1].held_out, mean_square=3.0 * stages[1].held_out.mean_square)
    hardly = [replace(stages[0], held_out=stages[1].held_out), *stages[1:]]
    assert of_the_input(elsewhere, hardly, None, floor) == elsewhere
    assert of_the_input(elsewhere, hardly, much, floor).block == "input"


def test_a_bend_that_every_airframe_has_is_no_cause_where_it_stays_below_the_noise():
    bent = Setup(maneuvers=6, noise=0.002, seed=23)
    slightly = diagnose(fly(replace(bent, switches={"cm_a2": -0.3})), Aircraft())
    assert slightly.verdict == "none"
    assert slightly.gap.before > VISIBLE
    assert not any(c.present for c in slightly.causes)
    more = diagnose(fly(replace(bent, switches={"cm_a2": -1.2})), Aircraft())
    assert (more.verdict, more.causes[0].effect) == ("effect", "nonlinear_pitching_moment")
