"""A floor far above the instruments' noise is no floor."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft import Aircraft
from advisor.flight.record import Channel
from advisor.gap.noise.probes import DYNAMIC
from advisor.gap.records.prepare import prepare
from advisor.gap.search.baseline import fit_baseline
from advisor.gap.unnamed.unsteady import unsteady
from tests.gap.generator import Setup, fly

pytestmark = pytest.mark.study
"""Whole diagnoses, run by ``make study-gap``."""


@pytest.fixture(scope="module")
def flown():
    return fit_baseline(prepare(fly(Setup(maneuvers=3, seed=41)), Aircraft()), Aircraft())


def test_noise_of_instruments_is_a_floor_and_so_is_one_instrument_that_wanders(flown):
    problem, fitted = flown
    white, peaks = problem.flights.white, problem.flights.peaks
    assert unsteady(problem, fitted, 2.0 * white) is None
    one = np.array([0.2, 0.0, 0.0, 0.0])
    assert unsteady(problem, fitted, np.maximum(white, one * peaks)) is None


def test_a_floor_of_a_tenth_of_the_motion_in_several_channels_is_what_moves_the_aircraft(flown):
    problem, fitted = flown
    found = unsteady(problem, fitted, np.maximum(problem.flights.white, 0.2 * problem.flights.peaks))
    assert found.block in DYNAMIC
    assert "Where nothing was flown" in found.note


def test_a_stick_that_moves_unlogged_is_found_in_the_input():
    hidden = []
    for m in fly(Setup(maneuvers=5, seed=41)):
        command = m.channels["elevator"]
        # The second half of every input, and what it moves, counts as free response.
        kept = command.t < m.span.start_s + 1.2
        y = np.where(kept, command.y, 0.0)
        elevator = Channel("elevator", command.t, y, command.source, command.provenance)
        span = replace(m.span, last_step_s=m.span.start_s + 1.2)
        hidden.append(replace(m, span=span, channels={**m.channels, "elevator": elevator}))
    problem, fitted = fit_baseline(prepare(hidden, Aircraft()), Aircraft())
    found = unsteady(problem, fitted, np.maximum(problem.flights.white, 0.2 * problem.flights.peaks))
    assert found.block == "input"
