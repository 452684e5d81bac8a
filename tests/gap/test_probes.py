"""An unknown disturbance is let into one block after the other: it must act there as a real one does."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.gap.candidates.known import variants_for
from advisor.gap.fitting.linear import unit_pulse
from advisor.gap.noise.quiet import DYNAMIC, in_one_maneuver, instrument_noise, probe_blocks, unfiltered
from advisor.gap.records.prepare import prepare
from advisor.gap.search.baseline import fit_baseline
from advisor.gap.simulator.layout import INDEX, OUTPUTS
from advisor.gap.simulator.reading import lane
from tests.gap.generator import Setup, fly

LATER = 40
SMALL = 1e-4


@pytest.fixture(scope="module")
def still():
    return fit_baseline(prepare(fly(Setup(maneuvers=2, seed=3)), Aircraft()), Aircraft())


@pytest.mark.parametrize("vane_lag_s", [0.0, 0.05])
@pytest.mark.parametrize("block", DYNAMIC)
def test_a_disturbance_with_which_a_record_begins_does_what_a_later_one_does(still, block, vane_lag_s):
    problem, fitted = still
    flight = problem.flights.flights[0]
    p = problem.driving(fitted.point)[0]
    p[INDEX["alpha_lag_s"]] = vane_lag_s
    first = unit_pulse(flight, DYNAMIC[block])
    answers = []
    for begin in (0, LATER):
        packs = problem.fly_all(
            flight, np.stack([p, p]), np.roll(first, begin, axis=1), np.array([0.0, SMALL])
        )
        answers.append(((lane(packs, 1) - lane(packs, 0)) / SMALL)[:, begin : begin + 3 * LATER])
    at_once, later = answers
    # What is left between them is the air speed, which varies within a manoeuvre.
    for c in range(len(OUTPUTS)):
        assert at_once[c] == pytest.approx(later[c], abs=0.05 * np.max(np.abs(later[c])))


def test_a_gust_is_the_airs_and_not_the_vanes_though_it_is_largest_there():
    problem, fitted = fit_baseline(
        prepare(fly(Setup(maneuvers=6, gust_pulse=0.6, seed=7)), Aircraft()), Aircraft()
    )
    problem, fitted = unfiltered(problem, fitted)
    noise = instrument_noise(problem)
    for i in (1, 4):
        best, *others = probe_blocks(*in_one_maneuver(problem, fitted, i), noise)
        assert best.block == "air"
        assert best.gain > 1.1 * others[0].gain


def test_one_manoeuvre_seen_alone_keeps_what_changes_between_manoeuvres():
    problem, fitted = fit_baseline(prepare(fly(Setup(maneuvers=4, seed=62)), Aircraft()), Aircraft())
    drift = next(v for v in variants_for(problem.flights) if v.effect == "cg_shift")
    point = fitted.point.with_effect(drift, (0.004,))
    whole = problem.fly(problem.flights.flights[3], problem.driving(point)[3])
    alone, seen = in_one_maneuver(problem, replace(fitted, point=point), 3)
    assert alone.fly(alone.flights.flights[0], alone.driving(seen.point)[0]) == pytest.approx(whole)
