"""A flight against a nonlinear simulator: what is named, and how far the gap shrinks in that simulator."""

from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis import gap as reading
from advisor.analysis.gap_flights import GapFlights
from advisor.gap.diagnose import examine
from advisor.gap.result import ComparedDerivative, Value
from advisor.oem.estimate import NoEstimate
from advisor.process.arrays import FloatArray
from advisor.simulators.compare import Compared, agreeing, compare
from advisor.simulators.linear import LinearSimulator
from advisor.simulators.unseen import unseen_of, with_unseen_shrink
from advisor.words.problems import UnusableInputError
from tests.exports.models.test_orders import found
from tests.gap.diagnosed import diagnose
from tests.simulators.nonlinear import TRIM_RAD, Nonlinear, flown

PLAIN = Nonlinear()


@cache
def of(aircraft: Nonlinear, simulator: Nonlinear) -> Compared:
    """Return the diagnosis of an aircraft against a simulator."""
    return compare(flown(aircraft), simulator, Aircraft())


def scaled(name: str, y: FloatArray) -> FloatArray:
    """Return a vane that reads a tenth too much."""
    return TRIM_RAD + 1.1 * (y - TRIM_RAD) if name == "alpha" else y


@pytest.mark.study
def test_a_simulators_own_curves_and_speed_are_not_called_missing():
    found = of(PLAIN, PLAIN).diagnosis
    assert found.verdict == "none"
    assert found.in_simulator.before < 0.05
    assert (found.in_simulator.after, found.in_simulator.percent) == (found.in_simulator.before, 0.0)


@pytest.mark.study
def test_the_same_flight_beside_eight_numbers_does_show_the_curves():
    numbers = of(PLAIN, PLAIN).aircraft.model
    assert diagnose(flown(PLAIN), Aircraft(model=dict(numbers))).gap.before > 1.0


@pytest.mark.study
def test_a_delay_that_the_simulator_lacks_is_named_and_shrinks_the_gap_in_the_simulator():
    found = of(replace(PLAIN, delay_s=0.05), PLAIN).diagnosis
    assert found.causes[0].effect == "transport_delay"
    assert found.causes[0].parameters["delay_s"].value == pytest.approx(0.05, abs=0.006)
    assert found.in_simulator.percent > 90.0
    assert found.in_simulator.on_paper == ()


@pytest.mark.study
def test_an_instrument_that_reads_too_much_is_named_and_carried_around_the_simulator():
    found = compare(flown(PLAIN, reads=scaled), PLAIN, Aircraft()).diagnosis
    assert found.causes[0].effect == "alpha_scale"
    assert found.causes[0].parameters["scale"].value == pytest.approx(0.1, abs=0.01)
    assert found.in_simulator.after < 0.1 * found.in_simulator.before + 0.05


@pytest.mark.study
def test_a_delay_that_only_the_simulator_has_is_said_to_be_too_long_and_stays_on_paper():
    found = of(PLAIN, replace(PLAIN, delay_s=0.06)).diagnosis
    assert found.causes[0].effect == "transport_delay"
    assert found.causes[0].parameters["delay_s"].value == pytest.approx(-0.06, abs=0.012)
    assert "its delay is too long" in found.sentence
    assert found.in_simulator.on_paper == ("its own servo",)


@pytest.mark.study
def test_a_servo_that_is_slower_in_the_simulator_alone_is_said_to_be_too_slow():
    found = of(PLAIN, replace(PLAIN, lag_s=0.1)).diagnosis
    assert found.causes[0].effect == "actuator_lag"
    assert found.causes[0].parameters["lag_s"].value == pytest.approx(-0.1, abs=0.02)
    assert "its servo lags by" in found.sentence


@pytest.mark.study
def test_wrong_numbers_are_corrected_in_a_simulator_that_takes_increments_and_on_paper_in_another():
    heavier = replace(PLAIN)
    maneuvers = flown(heavier)
    stiff = LinearSimulator(
        {"Z_alpha": -2.7, "Z_q": 0.0, "Z_delta_e": -0.15, "M_alpha": -35.0, "M_q": -3.4, "M_delta_e": -29.0}
    )
    inside = compare(maneuvers, stiff, Aircraft()).diagnosis.in_simulator
    outside = compare(maneuvers, replace(stiff, takes_increments=False), Aircraft()).diagnosis.in_simulator
    assert inside.percent > 90.0 > 10.0 > outside.percent
    assert "derivatives" in outside.on_paper


@pytest.mark.study
def test_the_linear_simulator_gives_the_diagnosis_that_the_aircraft_file_gives():
    model = {
        "Z_alpha": -2.7,
        "Z_q": 0.0,
        "Z_delta_e": -0.15,
        "M_alpha": -23.0,
        "M_q": -3.4,
        "M_delta_e": -29.0,
    }
    maneuvers = flown(replace(PLAIN, lag_s=0.08))
    file = Aircraft(model=model)
    whole, beside = examine(maneuvers, file), compare(maneuvers, LinearSimulator(model), file).diagnosis
    plain = with_unseen_shrink(whole, unseen_of(whole, None), file).diagnosis
    assert beside.causes == plain.causes
    assert beside.gap == plain.gap
    assert beside.shrink.holdout == plain.shrink.holdout
    assert beside.shrink.percent == pytest.approx(plain.shrink.percent, abs=0.5)


@pytest.mark.study
def test_a_servo_in_the_aircraft_file_acts_before_the_simulator():
    servo = Aircraft(elevator=replace(Aircraft().elevator, lag_s=0.08))
    found = compare(flown(replace(PLAIN, lag_s=0.08)), PLAIN, servo).diagnosis
    assert found.verdict == "none"


def test_a_replay_with_a_missing_number_is_refused_with_the_manoeuvre():
    class Broken(Nonlinear):
        def replay(self, condition, inputs, increments=None):
            motion = super().replay(condition, inputs, increments)
            return replace(motion, q=np.full_like(motion.q, np.nan))

    with pytest.raises(UnusableInputError, match="does not fly manoeuvre 1 to its end"):
        compare(flown(maneuvers=3), Broken(), Aircraft())


@pytest.mark.study
def test_the_qualification_says_which_channels_pass_before_and_after():
    table = {
        q.channel: q for q in of(replace(PLAIN, delay_s=0.05), PLAIN).diagnosis.in_simulator.qualification
    }
    assert table["q"].limit == pytest.approx(np.radians(2.0))
    assert table["a_z"].limit == pytest.approx(0.980665)
    assert table["alpha"].limit is None
    assert table["q"].after < table["q"].before
    assert table["q"].passes_after


def test_a_simulator_that_departs_is_refused_with_the_manoeuvre():
    class Departs(Nonlinear):
        def replay(self, condition, inputs, increments=None):
            motion = super().replay(condition, inputs, increments)
            return replace(motion, alpha=motion.alpha * np.exp(motion.t))

    with pytest.raises(UnusableInputError, match="departs in manoeuvre 1"):
        compare(flown(maneuvers=3), Departs(), Aircraft())


def test_a_simulator_that_does_not_answer_the_elevator_is_refused():
    class Deaf(Nonlinear):
        def replay(self, condition, inputs, increments=None):
            return super().replay(condition, replace(inputs, elevator=0.0 * inputs.elevator), increments)

    with pytest.raises(UnusableInputError, match="does not respond to the elevator"):
        compare(flown(maneuvers=3), Deaf(), Aircraft())


@pytest.mark.study
def test_where_the_simulator_does_not_fly_with_the_effects_the_diagnosis_stands_and_says_why():
    class Fragile(Nonlinear):
        def replay(self, condition, inputs, increments=None):
            if increments is not None:
                raise UnusableInputError("no_flight", "It does not fly.")
            return super().replay(condition, inputs)

    found = compare(flown(replace(PLAIN, delay_s=0.05)), Fragile(), Aircraft()).diagnosis
    assert found.causes[0].effect == "transport_delay"
    assert found.in_simulator.after is None
    assert found.notes[0] == "The simulator cannot take the effects: It does not fly."


@pytest.mark.study
def test_traces_are_the_flight_as_logged_and_the_simulator_itself():
    late = replace(PLAIN, delay_s=0.05)
    logged = {m.number: m.channels for m in flown(late)}
    trace = next(t for t in of(late, PLAIN).diagnosis.traces if t.channel == "q")
    begun = logged[trace.number]["q"].t[0]
    assert trace.measured == pytest.approx(
        np.interp(trace.t + begun, logged[trace.number]["q"].t, logged[trace.number]["q"].y), abs=2e-3
    )


OWN = Value(0.27, 0.045)
LOGGED = SimpleNamespace(
    names=("Z_delta_e", "M_q"), theta=np.array([0.71, -4.0]), std=np.array([0.10, 0.2]), not_identifiable={}
)
"""Z_δe and M_q of arduplane-calm by a simulator without its servo, and by the estimate of the log."""


def diagnosis():
    """Return a diagnosis with both derivatives, the first one far below that of simulator and log."""
    compared = (ComparedDerivative("Z_delta_e", 0.71, OWN), ComparedDerivative("M_q", -5.0, Value(-4.1, 0.1)))
    model = {one.name: one.found for one in compared}
    return replace(found(), model={**found().model, **model}, derivatives=compared)


def test_two_readings_of_one_log_agree_within_their_intervals():
    wider = OWN.agreeing(Value(0.71, 0.10))
    assert wider.value + 1.96 * wider.std == pytest.approx(0.71 + 1.96 * 0.10, abs=1e-3)
    assert Value(0.6, 0.045).agreeing(Value(0.71, 0.10)) == Value(0.6, 0.045)


def test_a_derivative_that_the_log_contradicts_is_not_stated_as_changed_and_the_notes_name_it():
    assert [one.name for one in diagnosis().derivatives if one.differs] == ["Z_delta_e", "M_q"]
    told = agreeing(diagnosis(), LOGGED)
    assert [one.name for one in told.derivatives if one.differs] == ["M_q"]
    assert told.model["Z_delta_e"].std > 4.0 * OWN.std
    assert told.model["M_q"] == Value(-4.1, 0.1)
    assert told.notes[-1] == "The intervals of Z_δe contain those of advisor analyze, which lie elsewhere."


def test_a_log_without_an_estimate_contradicts_nothing():
    untold = SimpleNamespace(**{**vars(LOGGED), "not_identifiable": {"Z_delta_e": "correlated"}})
    for logged in (NoEstimate("few", "too few"), untold):
        assert agreeing(diagnosis(), logged).derivatives == diagnosis().derivatives


@pytest.mark.parametrize("kind", ["user's", "file's"])
def test_derivatives_agree_with_the_log_next_to_a_users_simulator(kind, monkeypatch):
    """The aircraft file's own model is its surrogate, so that nothing is subtracted from the log."""
    simulator = Nonlinear() if kind == "user's" else None
    monkeypatch.setattr(reading, "compare", lambda *_: Compared(diagnosis(), Aircraft()))
    monkeypatch.setattr(reading, "compare_to_file", lambda *_: Compared(diagnosis(), Aircraft()))
    monkeypatch.setattr(reading, "estimate_jointly", lambda *_: LOGGED)
    told = reading.compare_flown(GapFlights(flown(maneuvers=2), 0, ()), Aircraft(), simulator).diagnosis
    assert (told.model["Z_delta_e"] == OWN) == (kind == "file's")
