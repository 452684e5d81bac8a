"""A manoeuvre that is held out is predicted by those before it, within the band that they leave."""

from dataclasses import replace

import numpy as np

from advisor.bundled.study.campaigns import estimate_copies
from advisor.bundled.study.flying import Scene, as_maneuver, fly_named, noise_scale
from advisor.decision.history import CandidateManeuver
from advisor.decision.hold_out import predict_last

SCENE = Scene()


def flown(count: int, noise_percent: float = 5.0, seed: int = 1) -> list[CandidateManeuver]:
    """The paper's input and its reverse in turn, each with noise of its own."""
    rng, campaign = np.random.default_rng(seed), []
    for number in range(count):
        flight = fly_named(SCENE, "rev" if number % 2 else "3211")
        (estimate,) = estimate_copies(flight, 0.01 * noise_percent * noise_scale(flight, "std"), 1, rng)
        campaign.append(CandidateManeuver(estimate, maneuver=as_maneuver(flight)))
    return campaign


def test_the_true_response_lies_in_the_band_of_the_prediction_and_the_samples_in_theirs() -> None:
    inside, samples = [], []
    for seed in range(8):
        campaign = flown(4, seed=seed)
        flight = fly_named(SCENE, "rev")
        for k, name in enumerate(("alpha", "q")):
            output = predict_last(campaign)[name]
            # The trim is the fit's, which has an error of its own, so the band of samples must hold both.
            true = np.interp(output.t, flight.t, flight.response[:, k])
            inside.append(np.max(np.abs(output.predicted - true)) < np.max(output.half_of_samples))
            samples.append(np.mean(np.abs(output.measured - output.predicted) < output.half_of_samples))
    assert all(inside)
    assert 0.93 < np.mean(samples) < 0.97


def test_the_band_shrinks_with_the_manoeuvres_that_predict() -> None:
    few, many = (np.max(predict_last(flown(count))["q"].half) for count in (3, 9))
    assert many < 0.7 * few


def test_an_aircraft_that_has_changed_leaves_the_band() -> None:
    campaign = flown(3)
    weaker = replace(SCENE, aircraft=replace(SCENE.aircraft, M_delta_e=0.8 * SCENE.aircraft.M_delta_e))
    flight = fly_named(weaker, "rev")
    noise = 0.05 * noise_scale(flight, "std")
    (estimate,) = estimate_copies(flight, noise, 1, np.random.default_rng(4))
    output = predict_last([*campaign, CandidateManeuver(estimate, maneuver=as_maneuver(flight))])["q"]
    assert np.mean(np.abs(output.measured - output.predicted) < output.half_of_samples) < 0.8


def test_two_manoeuvres_are_too_few_to_hold_one_out() -> None:
    assert predict_last(flown(2)) == {}
    assert predict_last([]) == {}
