"""Between its stamps a command was held or moved on, and half an interval lies between the two readings."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis.gap_flights import maneuvers_of
from advisor.gap.records.prepare import prepare
from advisor.gap.records.usable import usable_of
from advisor.gap.search.baseline import fit_baseline
from advisor.gap.verdict.notes import left_out
from sim.effects.fitting import flight_of
from sim.record import record
from sim.scenario import read_scenario
from tests.flights import FOLDER
from tests.gap.generator import Setup, fly
from tests.maneuvers import changed

UAV = """
aircraft: uav
noise: {alpha_deg: 0.05, pitch_rate_deg_s: 0.15, pitch_deg: 0.05, accelerometer_m_s2: 0.05}
maneuvers: ["3211", "rev", doublet, "rev"]
"""


@cache
def two_flown(how):
    """Return two manoeuvres of the bundled aircraft whose command is held or linear between its stamps."""
    file, log = FOLDER / f"{how}.yaml", FOLDER / f"{how}.tlog"
    file.write_text(f"{UAV}input: {how}\n")
    scenario = read_scenario(file)
    record(flight_of(replace(scenario, maneuvers=scenario.maneuvers[:2])), log)
    return maneuvers_of([log], Aircraft()).maneuvers


@pytest.mark.parametrize("flown", ["held", "linear"])
def test_a_command_is_read_as_it_was_flown(flown):
    problem, _ = fit_baseline(prepare(two_flown(flown), Aircraft()), Aircraft())
    assert problem.held == (flown == "held")


@pytest.mark.parametrize("seed", [1, pytest.param(2, marks=pytest.mark.study)])
def test_a_delay_of_nearly_an_interval_is_not_taken_for_a_held_command_that_is_half_as_late(seed):
    late = Setup(maneuvers=6, switches={"delay": 0.018}, jitter=0.002, seed=seed)
    problem, _ = fit_baseline(prepare(fly(late), Aircraft()), Aircraft())
    assert not problem.held


def without(maneuver, lost):
    """Return the manoeuvre without some stamps of its command."""
    elevator = maneuver.channels["elevator"]
    return changed(maneuver, "elevator", t=elevator.t[~lost], y=elevator.y[~lost])


def test_a_held_command_of_which_steps_were_lost_is_still_held():
    received = []
    for maneuver in two_flown("held"):
        command = maneuver.channels["elevator"].y
        # The message with the new value is lost in every third step, the one after it has it.
        steps = np.flatnonzero(np.abs(np.diff(command)) > 0.01) + 1
        received.append(without(maneuver, np.isin(np.arange(len(command)), steps[::3])))
    problem, _ = fit_baseline(prepare(received, Aircraft()), Aircraft())
    assert problem.held


def test_a_manoeuvre_with_a_step_in_a_hole_of_the_log_is_left_out_and_said_so():
    flown = fly(Setup(maneuvers=6, seed=5))
    elevator = flown[2].channels["elevator"]
    step = elevator.t[int(np.argmax(np.abs(np.diff(elevator.y))))]
    flown[2] = without(flown[2], np.abs(elevator.t - step) < 0.15)
    assert [m.number for m in usable_of(flown)] == [1, 2, 4, 5, 6]
    (note,) = left_out(flown[2:3])
    assert note == "Left out: manoeuvre 3: a step of the command lies in a gap of the log."


@pytest.mark.parametrize(("hole_s", "is_hidden"), [((1.45, 2.15), True), ((1.55, 1.75), False)])
def test_in_a_hole_of_the_log_a_whole_pulse_may_be_hidden_but_not_in_a_short_one(hole_s, is_hidden):
    flown = fly(Setup(maneuvers=6, seed=5))
    span = flown[2].span
    t = np.arange(span.start_s - 1.0, span.end_s, 0.02)
    ago = t - span.start_s
    # To and fro for as long as the manoeuvre takes: before the hole the command is what it is after it.
    command = np.where((ago > 0.0) & (t < span.last_step_s), 0.03 * np.where(ago % 1.0 < 0.5, 1.0, -1.0), 0.0)
    heard = (ago < hole_s[0]) | (ago > hole_s[1])
    flown[2] = changed(flown[2], "elevator", t=t[heard], y=command[heard])
    assert (3 not in [m.number for m in usable_of(flown)]) is is_hidden
