import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.oem.estimator import estimate, estimate_jointly
from advisor.oem.problem import OutputErrorProblem, Record
from advisor.oem.rows import Signal
from advisor.oem.solution import Solution, solve
from benchmarks.robustness import mismatched, search_everywhere
from tests.oem.builders import JET, flown, maneuver


def test_every_random_aircraft_is_brought_to_its_best_fit():
    result = search_everywhere(60, seed=5)
    assert (result.worse, result.refused) == (0, 0)


@pytest.mark.study
@pytest.mark.timeout(1800)
def test_two_thousand_random_aircraft_are_brought_to_their_best_fit():
    result = search_everywhere(2000)
    assert result.worse == 0
    # Divergent aircraft whose record is one growing exponential: said so, not answered.
    assert result.refused <= 10


@pytest.mark.parametrize("kind", ["lag", "turbulence", "lift"])
def test_a_model_that_does_not_hold_widens_the_intervals(kind):
    right, wrong = solve(mismatched("nothing", 1)), solve(mismatched(kind, 1))
    assert isinstance(right, Solution)
    assert isinstance(wrong, Solution)

    def width(s):
        return np.sqrt(np.diag(s.covariance))

    assert np.all(width(wrong)[[1, 5, 6, 7]] > 1.2 * width(right)[[1, 5, 6, 7]])
    assert np.median(width(wrong) / np.sqrt(np.diag(wrong.covariance_cr))) > 1.2


def test_gaps_of_a_tenth_of_the_samples_do_not_move_the_estimate_beyond_its_error():
    whole = flown(JET, noise=0.02)
    rng = np.random.default_rng(2)
    thin = {}
    for name in ("alpha", "q"):
        channel = whole.channels[name]
        keep = rng.random(len(channel)) > 0.1
        keep[200:215] = False
        thin[name] = (channel.t[keep], channel.y[keep])
    elevator = whole.channels["elevator"]
    found = estimate(maneuver(1, (elevator.t, elevator.y), thin), Aircraft())
    assert isinstance(found, Estimate)
    assert np.all(np.abs(found.theta - JET) < 4 * found.std)


@pytest.mark.parametrize("bad", [np.nan, 1e6])
def test_absurd_samples_give_a_value_not_a_crash(bad):
    flight = flown(JET, noise=0.02)
    channels = {n: (flight.channels[n].t, flight.channels[n].y.copy()) for n in ("alpha", "q")}
    channels["alpha"][1][100:110] = bad
    elevator = flight.channels["elevator"]
    result = estimate(maneuver(1, (elevator.t, elevator.y), channels), Aircraft())
    assert isinstance(result, Estimate | NoEstimate)


def test_noise_alone_is_not_identifiable_or_no_estimate():
    rng = np.random.default_rng(0)
    t = np.arange(0.0, 8.0, 0.02)
    u = np.where((t > 1) & (t < 2), 1e-5, 0.0)
    channels = {n: (t, 0.01 * rng.standard_normal(len(t))) for n in ("alpha", "q")}
    result = estimate(maneuver(1, (t, u), channels), Aircraft())
    assert isinstance(result, NoEstimate) or len(result.not_identifiable) >= 4


def test_no_manoeuvre_is_no_estimate():
    result = estimate_jointly([], Aircraft())
    assert isinstance(result, NoEstimate)
    assert result.code == "no_maneuver"


def test_a_record_without_pitch_rate_is_the_callers_mistake():
    t = np.arange(0.0, 1.0, 0.1)
    with pytest.raises(ValueError, match="samples of q"):
        solve(OutputErrorProblem((Record(Signal(t, t), {"alpha": Signal(t, t)}),)))
