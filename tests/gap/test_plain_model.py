"""What every flight has is part of the plain model, with the estimate's priors, and is no cause."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import Reference
from advisor.flight.instruments.delayed_fit import lateness_std
from advisor.flight.signals.derived_alpha import DERIVED_ALPHA
from advisor.flight.signals.trust import InstrumentFinding
from advisor.gap.candidates.known import base_entries, latency, variants_for
from advisor.gap.fitting.holdout import hold_out
from advisor.gap.fitting.prior import ERROR_IF_RIGHT, ERROR_IF_WRONG
from advisor.gap.fitting.problem import EffectProblem, SearchPoint
from advisor.gap.inference import pitch
from advisor.gap.inference.evidence import FlightProblem
from advisor.gap.inference.pitch import PitchFlight
from advisor.gap.noise.quiet import largest_gust
from advisor.gap.records.prepare import as_stamped, prepare
from advisor.gap.records.unmeasured_alpha import alpha_by_motion
from advisor.gap.records.usable import outputs_of
from advisor.gap.search.baseline import fit_baseline, fit_unfiltered
from advisor.gap.simulator.layout import DERIVATIVES as DERIVATIVES_BY_NAME
from advisor.gap.simulator.layout import SPEED
from advisor.oem.instruments import COMMAND_DELAY
from advisor.oem.prepare import prepare as prepare_estimate
from tests.gap.generator import Setup, fly
from tests.maneuvers import changed, without

FLOWN = fly(Setup(maneuvers=3, seed=71))
IMU = ("q", "a_z")
DERIVATIVES = np.array([-4.0, 0.0, -0.3, -30.0, -4.0, -45.0])


def variant(flights, effect):
    return next(v for v in variants_for(flights) if v.effect == effect)


def test_the_delay_of_the_command_has_one_prior_in_estimate_and_diagnosis():
    flights = prepare(FLOWN, Aircraft())
    stamps = [flight.t_u for flight in flights.flights]
    assert latency(flights).prior_std == (lateness_std(stamps),)
    estimated = prepare_estimate(FLOWN, Aircraft()).problem
    assert COMMAND_DELAY.usual(estimated).std == lateness_std([r.elevator.t for r in estimated.records])


def test_a_filter_that_a_parameter_states_is_taken_out_of_the_stamps():
    there, due = (outputs_of(changed(FLOWN[0], "q", delay_s=late))["q"] for late in (0.011, 0.0))
    assert due.t - there.t == pytest.approx(0.011)


def test_a_filter_of_the_imu_that_no_parameter_states_is_part_of_the_plain_model():
    late = []
    for m in FLOWN:
        own = {c: replace(m.channels[c], t=m.channels[c].t + 0.011) for c in IMU}
        late.append(replace(m, channels={**m.channels, **own}))
    there, due = (fit_unfiltered(prepare(flown, Aircraft()), Aircraft())[1] for flown in (late, FLOWN))
    found = there.point.values[there.point.index_of("imu_late")]
    assert found == pytest.approx(0.011, abs=1e-3)
    assert there.noise == pytest.approx(due.noise, rel=0.01)


def test_a_plain_model_from_where_an_effect_ended_is_searched_no_further(monkeypatch):
    """A fit that begins at this model ends above it, because edges of the command are found anew."""
    problem, fitted = fit_baseline(prepare(FLOWN, Aircraft()), Aircraft())
    lower, begun = replace(fitted, cost=fitted.cost - 100.0), []

    def searched(loose, plain, fits):
        begun.append(plain.cost)
        return lower

    monkeypatch.setattr(pitch, "_without_the_effect", searched)
    PitchFlight(FlightProblem.of(problem, fitted), fitted, [], []).explained(None, 0)
    assert begun[1:] == [lower.cost]


@pytest.fixture(scope="module")
def predicted():
    """Return a flight with a stated model, its plain fit, and that fit's errors on manoeuvres kept out."""
    stated = Aircraft(model=dict(zip(DERIVATIVES_BY_NAME, DERIVATIVES, strict=True)))
    problem, fitted = fit_baseline(prepare(FLOWN, stated), stated)
    flight = FlightProblem.of(problem, fitted)
    return flight, fitted, hold_out(flight.within(ERROR_IF_WRONG), fitted)


def test_errors_below_the_least_noise_are_no_loss_on_manoeuvres_kept_out(predicted):
    flight, fitted, held = predicted
    louder = replace(held, innovation_square=4.0 * held.innovation_square)
    quiet = replace(flight, smallest_noise=3.0 * np.sqrt(held.innovation_square))
    assert pitch._lost_unseen(flight, fitted, fitted, louder) < -100.0
    assert pitch._lost_unseen(quiet, fitted, fitted, louder) == 0.0


def test_the_plain_model_predicts_under_its_own_prior_beside_an_effect_at_the_files_derivatives(predicted):
    flight, fitted, held = predicted
    at_the_file = flight.within(ERROR_IF_RIGHT)
    assert pitch._lost_unseen(at_the_file, fitted, fitted, held) == 0.0


def test_an_air_speed_that_is_read_low_is_part_of_the_plain_model_without_an_angle_of_attack():
    low = [changed(without(m, "alpha"), "airspeed", y=0.95 * m.channels["airspeed"].y) for m in FLOWN]
    flights = prepare(low, Aircraft())
    assert "alpha" not in flights.channels
    point = fit_unfiltered(flights, Aircraft())[1].point
    assert point.values[point.index_of("true_air_speed")] == pytest.approx(1.0 / 0.95 - 1.0, abs=0.01)


def test_a_delay_that_the_examination_removed_is_put_back_once():
    late = InstrumentFinding("a_z", "delay_s", None, 0.1, 0.01, True, used=True, removed_s=0.1)
    once = as_stamped(replace(FLOWN[0], findings=(late,)))
    for name in ("a_z", "a_x"):
        assert once.channels[name].t == pytest.approx(FLOWN[0].channels[name].t + 0.1)
    assert as_stamped(once).channels["a_z"].t == pytest.approx(once.channels["a_z"].t)


def test_an_angle_of_attack_from_the_climb_rate_is_a_state_and_no_output():
    derived = [changed(m, "alpha", source=DERIVED_ALPHA, provenance="derived") for m in FLOWN]
    flights = prepare(alpha_by_motion(derived, Aircraft()), Aircraft())
    measured = prepare(FLOWN, Aircraft())
    assert flights.channels == ("q", "a_z")
    for there, due in zip(flights.flights, measured.flights, strict=True):
        assert there.alpha_trim == pytest.approx(due.alpha_trim, abs=0.02)


def test_a_measured_angle_of_attack_stays_an_output():
    assert alpha_by_motion(FLOWN, Aircraft()) == FLOWN


def test_without_an_angle_of_attack_z_q_and_z_delta_e_have_the_estimates_prior():
    derived = [changed(m, "alpha", source=DERIVED_ALPHA, provenance="derived") for m in FLOWN]
    flights = prepare(alpha_by_motion(derived, Aircraft()), Aircraft())
    problem = EffectProblem(flights, base_entries(Aircraft()))
    inverse, _ = problem.prior_of(SearchPoint(DERIVATIVES, np.zeros((3, 4))))
    assert inverse[1] == pytest.approx(0.1**-2)
    assert inverse[2] == pytest.approx((0.02 * 45.0) ** -2)
    assert np.all(inverse[[0, 3, 4, 5]] == 0.0)


def test_a_gust_is_no_larger_than_what_the_vane_reads_beyond_the_motion():
    still = largest_gust(prepare(FLOWN, Aircraft()), -4.0)
    alpha = FLOWN[1].channels["alpha"]
    bump = 0.04 * np.exp(-(((alpha.t - alpha.t[0] - 4.0) / 0.3) ** 2))
    blown = [FLOWN[0], changed(FLOWN[1], "alpha", y=alpha.y + bump), FLOWN[2]]
    # The vane itself turns by 0.1 rad and more with the manoeuvre.
    assert still < 0.02
    assert largest_gust(prepare(blown, Aircraft()), -4.0) == pytest.approx(0.04, abs=0.012)


def test_without_a_vane_a_gust_is_no_larger_than_what_the_lift_shows():
    derived = [changed(m, "alpha", source=DERIVED_ALPHA, provenance="derived") for m in FLOWN]
    flights = prepare(alpha_by_motion(derived, Aircraft()), Aircraft())
    forces = [np.ptp(f.outputs["a_z"].y) / np.mean(f.slow[SPEED]) for f in flights.flights]
    assert largest_gust(flights, -40.0) == pytest.approx(max(forces) / 40.0)


@pytest.mark.parametrize(
    ("reference", "chord_m"),
    [(Reference(chord_m=0.4), 0.4), (Reference(mass_kg=8.0), 0.3), (Reference(), None)],
)
def test_arms_have_priors_of_the_aircrafts_own_size(reference, chord_m):
    flights = prepare(FLOWN, Aircraft(reference=reference))
    vane, imu = (variant(flights, e).prior_std for e in ("alpha_vane_offset", "accelerometer_offset"))
    assert vane == (() if chord_m is None else (pytest.approx(4.0 * chord_m),))
    assert imu == (() if chord_m is None else (pytest.approx(chord_m),))
