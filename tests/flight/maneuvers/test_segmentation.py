"""The segmenter: every movement of the elevator is found, whatever its shape, sample by sample."""

from itertools import pairwise

import numpy as np
import pytest

from advisor.decision.inputs import ORDERS, StepInput
from advisor.flight.maneuvers.segmentation import Segmenter
from tests.flight.elevator.elevators import PATTERNS, Stream, coloured, length, slewed, stamps, steps

DEG = np.radians(1.0)
SEEDS = range(4)


def found(stream):
    """All movements but those smaller than a third of the largest: what they are, other channels tell."""
    segmenter = Segmenter()
    spans = []
    for t, u in zip(stream.t.tolist(), stream.u.tolist(), strict=True):
        spans += segmenter.push(t, u)
    spans += segmenter.finish()
    largest = max((size(span) for span in spans), default=0.0)
    return [span for span in spans if size(span) >= largest / 3.0]


def size(span):
    return max(abs(level) for _, level in span.steps)


def drawn(
    seed, kind, slew=0.0, jitter=0.0, noise=0.0, wander=0.0, ramp=0.0, rate_hz=None, human=0.0, modified=False
):
    """One input of random size, time unit and rate, spoilt as asked (shares of its amplitude or unit)."""
    rng = np.random.default_rng((seed, len(kind)))
    amplitude = DEG * np.exp(rng.uniform(np.log(0.25), np.log(20.0)))
    unit_s = np.exp(rng.uniform(np.log(0.3 if rate_hz else 0.1), np.log(2.0)))
    rate = rate_hz or rng.uniform(max(10.0, 8.0 / unit_s), max(100.0, 8.1 / unit_s))
    levels = tuple(
        (units * rng.uniform(1 - human, 1 + human), level * rng.uniform(1 - human, 1 + human))
        for units, level in PATTERNS[kind]
    )
    if modified:
        levels = ((levels[0][0], 0.8 * levels[0][1]), *((units, 1.1 * level) for units, level in levels[1:]))
    duration = length(levels) * unit_s
    t = stamps(rng, 6.0 + duration + max(3.0, min(8.0, duration)) + 5.0, rate, jitter=0.2)
    u = slewed(t, amplitude * steps(t, 6.0, unit_s, levels), slew * unit_s)
    u = u * (1.0 + jitter * coloured(rng, t, 2.0)) + noise * amplitude * rng.standard_normal(len(t))
    u = u + wander * amplitude * coloured(rng, t, 0.3) + ramp * amplitude * t / 10.0
    return Stream(t, u + DEG * rng.uniform(-5.0, 5.0), [(kind, 6.0, 6.0 + duration)])


SPOILT = {
    "clean": {},
    "with noise on the command": {"noise": 0.05},
    "with much noise on the command": {"noise": 0.1},
    "with a stick that shakes": {"jitter": 0.1},
    "amid corrections": {"wander": 0.1},
    "on a trim ramp": {"ramp": 0.1},
    "at ten hertz": {"rate_hz": 10.0},
}
SLOPPY = {
    "with slewed edges": {"slew": 0.3},
    "with badly slewed edges": {"slew": 0.5},
    "by hand": {"slew": 0.3, "human": 0.15, "jitter": 0.05},
    "with balanced areas": {"modified": True},
}


@pytest.mark.parametrize("how", SPOILT)
@pytest.mark.parametrize("kind", ["3-2-1-1", "reverse 3-2-1-1", "doublet", "other"])
def test_every_input_is_found_once_by_its_name(kind, how):
    for seed in SEEDS:
        stream = drawn(seed, kind, **SPOILT[how])
        (span,) = found(stream)
        _, first, last = stream.flown[0]
        assert span.kind == kind
        # Corrections of a tenth of the amplitude may belong to the input or not.
        assert -0.6 < span.start_s - first < 0.15
        assert abs(span.last_step_s - last) < 0.15
        assert span.record_from_s < span.start_s < span.last_step_s < span.end_s


@pytest.mark.parametrize("how", SLOPPY)
@pytest.mark.parametrize("kind", PATTERNS)
def test_an_input_is_found_however_it_was_flown(kind, how):
    for seed in SEEDS:
        stream = drawn(seed, kind, **SLOPPY[how])
        (span,) = found(stream)
        assert span.kind == kind
        assert abs(span.start_s - 6.0) < 0.5


def test_a_first_step_with_the_trailing_edge_up_is_a_3211_and_the_other_its_reverse():
    t = np.arange(0.0, 20.0, 0.02)
    for sense, kind in ((-1.0, "3-2-1-1"), (1.0, "reverse 3-2-1-1")):
        u = sense * DEG * -steps(t, 6.0, 0.4, PATTERNS["3-2-1-1"])
        (span,) = found(Stream(t, u))
        assert span.kind == kind


@pytest.mark.parametrize("sense", [-1.0, 1.0])
def test_a_3211_whose_steps_come_in_reverse_order_is_its_reverse(sense):
    t = np.arange(0.0, 20.0, 0.02)
    u = sense * DEG * steps(t, 6.0, 0.4, PATTERNS["3-2-1-1"][::-1])
    (span,) = found(Stream(t, u))
    assert span.kind == "reverse 3-2-1-1"


def test_a_measured_surface_drawn_out_by_its_servo_is_recognised():
    t = np.arange(0.0, 20.0, 0.02)
    command = DEG * steps(t, 6.0, 0.4, PATTERNS["3-2-1-1"])
    surface = np.zeros(len(t))
    for i in range(1, len(t)):
        surface[i] = surface[i - 1] + (command[i - 1] - surface[i - 1]) * (1.0 - np.exp(-0.02 / 0.1))
    (span,) = found(Stream(t, surface))
    assert span.kind == "3-2-1-1"
    assert span.start_s == pytest.approx(6.0, abs=0.1)


def test_a_record_that_begins_just_before_the_input_will_do():
    whole = flown_at([5.0], 20.0)
    (span,) = found(Stream(whole.t[whole.t > 4.8], whole.u[whole.t > 4.8]))
    assert span.kind == "3-2-1-1"
    assert span.record_from_s == pytest.approx(4.82, abs=0.03)


@pytest.mark.parametrize("order", ORDERS)
def test_what_the_advisor_recommends_is_recognised_when_flown(order):
    for unit_s in (0.2, 0.5, 1.2):
        for nose_up_first in (True, False):
            option = StepInput(order, unit_s, 2.0 * DEG, nose_up_first)
            t = np.arange(0.0, 12.0 + 2.0 * option.duration_s, 0.02)
            (span,) = found(Stream(t, option.elevator(0.5 * DEG, 6.0, 12.0).at(t)))
            assert span.start_s == pytest.approx(6.0, abs=0.05)
            assert span.last_step_s == pytest.approx(6.0 + option.duration_s, abs=0.05)
            assert len(span.steps) == len(ORDERS[order]) + 1


def test_a_pulse_is_found_when_nothing_moves_around_it():
    for seed in SEEDS:
        (span,) = found(drawn(seed, "pulse"))
        assert span.kind == "pulse"


@pytest.mark.parametrize("quiet_s", [0.3, 0.1])
def test_so_little_quiet_before_the_input_will_do(quiet_s):
    whole = flown_at([5.0], 20.0)
    heard = whole.t >= 5.0 - quiet_s
    (span,) = found(Stream(whole.t[heard], whole.u[heard]))
    assert span.start_s == pytest.approx(5.0, abs=0.05)
    assert span.last_step_s == pytest.approx(7.8, abs=0.05)


def test_an_input_with_which_the_record_begins_is_found():
    whole = flown_at([5.0], 20.0)
    heard = whole.t >= 5.5
    (span,) = found(Stream(whole.t[heard], whole.u[heard]))
    assert span.start_s < 6.5
    assert span.last_step_s == pytest.approx(7.8, abs=0.1)


@pytest.mark.parametrize("trim_deg", [-0.35, 0.35])
def test_an_elevator_that_rests_at_another_trim_afterwards_has_flown_an_input(trim_deg):
    stream = flown_at([5.0], 20.0)
    u = stream.u + np.where(stream.t > 7.79, DEG * trim_deg, 0.0)
    (span,) = found(Stream(stream.t, u))
    assert span.kind == "3-2-1-1"
    assert span.closed_by == "quiet"


@pytest.mark.parametrize("slew_s", [0.2, 0.4])
@pytest.mark.parametrize("stick", [0.0, 0.05])
def test_the_next_input_may_come_a_second_of_quiet_later(slew_s, stick):
    for seed in SEEDS:
        rng = np.random.default_rng(seed)
        t = np.arange(0.0, 25.0, 0.02)
        second_s = 5.0 + 2.8 + slew_s + 1.0
        u = steps(t, 5.0, 0.4, PATTERNS["3-2-1-1"]) + steps(t, second_s, 0.4, PATTERNS["doublet"])
        u = slewed(t, u, slew_s) + stick * coloured(rng, t, 0.3)
        first, second = found(Stream(t, 2.0 * DEG * u))
        assert first.start_s == pytest.approx(5.0, abs=0.4)
        assert second.start_s == pytest.approx(second_s, abs=0.4)
        assert first.closed_by == "next input"


@pytest.mark.parametrize("rate_hz", [10.0, 50.0])
@pytest.mark.parametrize("held_s", [0.5, 4.0, 16.0])
def test_a_pulse_is_one_input_however_long_it_is_held(held_s, rate_hz):
    t = np.arange(0.0, 45.0, 1.0 / rate_hz)
    rng = np.random.default_rng(3)
    u = np.where((t >= 8.0) & (t < 8.0 + held_s), DEG, 0.0) + 0.04 * DEG * rng.standard_normal(len(t))
    (span,) = found(Stream(t, u))
    assert span.kind == "pulse"
    assert span.start_s == pytest.approx(8.0, abs=0.15)
    assert span.last_step_s == pytest.approx(8.0 + held_s, abs=0.15)


def test_a_single_step_is_an_input_with_the_answer_to_it():
    t = np.arange(0.0, 60.0, 0.1)
    (span,) = found(Stream(t, np.where(t >= 20.0, -DEG, 0.0)))
    assert span.start_s == pytest.approx(20.0, abs=0.15)
    assert span.end_s - span.last_step_s > 8.0
    assert span.steps == ((pytest.approx(20.0, abs=0.1), pytest.approx(-DEG)),)


def test_an_input_that_was_given_up_is_found():
    whole = flown_at([5.0], 20.0)
    heard = whole.t < 6.9
    (span,) = found(Stream(whole.t[heard], whole.u[heard]))
    assert span.start_s == pytest.approx(5.0, abs=0.05)
    assert span.closed_by == "end of log"


@pytest.mark.parametrize("unit_s", [0.15, 0.4, 1.0, 3.0])
def test_the_time_scale_is_that_of_the_input(unit_s):
    (span,) = found(flown_at([5.0], 15.0 + 7.0 * unit_s, unit_s=unit_s))
    assert span.kind == "3-2-1-1"
    assert span.last_step_s == pytest.approx(5.0 + 7.0 * unit_s, abs=0.05)


def test_smooth_steps_of_a_hand_are_one_input():
    for seed in SEEDS:
        rng = np.random.default_rng(seed)
        t = np.arange(0.0, 14.0, 0.04)
        levels = tuple((rng.uniform(0.6, 1.6), (-1.0) ** k * rng.uniform(0.5, 1.0)) for k in range(8))
        u = slewed(t, steps(t, 0.8, 1.0, levels), 0.6)
        (span,) = found(Stream(t, 2.0 * DEG * u))
        assert span.start_s == pytest.approx(0.8, abs=0.5)
        assert span.last_step_s == pytest.approx(0.8 + length(levels), abs=0.5)


def test_a_multisine_is_found():
    t = np.arange(0.0, 25.0, 0.02)
    inside = (t >= 6.0) & (t < 14.0)
    phase = 2.0 * np.pi * (t - 6.0) / 8.0
    u = np.where(inside, sum(np.sin(n * phase - np.pi * n * n / 7.0) for n in range(2, 9)), 0.0)
    (span,) = found(Stream(t, 0.5 * DEG * u))
    assert span.kind == "multisine"
    assert abs(span.start_s - 6.0) < 0.5


def multisine(rng, duration_s):
    """Harmonics of the duration with Schroeder's phases (Klein & Morelli 9.3), up to 2 Hz, of unit peak."""
    harmonics = rng.integers(1, 3) + np.arange(rng.integers(5, 12))
    harmonics = harmonics[harmonics / duration_s < 2.0]
    phases = -np.pi * np.arange(1, len(harmonics) + 1) ** 2 / len(harmonics)

    def wave(since):
        x = 2.0 * np.pi * np.outer(harmonics, since) / duration_s
        return np.sum(np.sin(x + phases[:, None]), axis=0)

    return wave


def sweep(rng, duration_s):
    """From a low frequency to a high one or back, linear in time."""
    low, high = rng.uniform(0.1, 0.3), rng.uniform(1.0, 2.5)
    first, last = (low, high) if rng.random() < 0.7 else (high, low)
    return lambda since: np.sin(2.0 * np.pi * (first * since + 0.5 * (last - first) / duration_s * since**2))


@pytest.mark.parametrize("spoilt", ["clean", "noise", "amid corrections", "drift", "whole microseconds"])
@pytest.mark.parametrize(("wave", "shortest_s", "longest_s"), [(multisine, 4.0, 20.0), (sweep, 8.0, 27.0)])
def test_multisines_and_sweeps_are_found_whole_and_once_in_one_flight_mode(
    wave, shortest_s, longest_s, spoilt
):
    for seed in SEEDS:
        rng = np.random.default_rng((seed, len(spoilt)))
        duration_s = rng.uniform(shortest_s, longest_s)
        t = stamps(rng, 8.0 + duration_s + 12.0, rng.uniform(20.0, 60.0), jitter=0.2)
        since = np.clip(t - 8.0, 0.0, duration_s)
        swell = np.clip(np.minimum(since, duration_s - since) / rng.choice([0.1, 0.5, 1.0]), 0.0, 1.0)
        amplitude = DEG * np.exp(rng.uniform(np.log(0.7), np.log(5.0)))
        shape = swell * wave(rng, duration_s)(since)
        u = amplitude * shape / np.max(np.abs(shape))
        u += {
            "noise": 0.03 * amplitude * rng.standard_normal(len(t)),
            "amid corrections": 0.03 * amplitude * coloured(rng, t, 0.3),
            "drift": 0.005 * amplitude * t,
        }.get(spoilt, np.zeros(len(t)))
        if spoilt == "whole microseconds":
            u = np.round(u / (0.0625 * DEG)) * 0.0625 * DEG
        (span,) = found(Stream(t, u + DEG * rng.uniform(-4.0, 4.0)))
        assert span.kind == "multisine"
        assert span.start_s == pytest.approx(8.0, abs=2.5)
        assert span.last_step_s == pytest.approx(8.0 + duration_s, abs=2.5)


def test_a_slow_multisine_that_swells_is_found_from_where_it_has_a_third_of_its_size():
    t = np.arange(0.0, 30.0, 0.02)
    since = np.clip(t - 8.0, 0.0, 9.0)
    swell = np.minimum(1.0, np.minimum(since, 9.0 - since) / 1.5)
    u = swell * (np.sin(2 * np.pi * 0.4 * since) + np.sin(2 * np.pi * 0.6 * since + 2.0))
    (span,) = found(Stream(t, DEG * u))
    assert span.kind == "multisine"
    assert span.start_s == pytest.approx(8.0, abs=2.0)


def quiet_flight(name, rng, t):
    """Elevator histories without a test input."""
    if name == "trim changes":
        times, levels = np.cumsum(rng.exponential(5.0, 30)), np.cumsum(rng.normal(0.0, 1.0, 31))
        return slewed(t, levels[np.searchsorted(times, t)], 0.2)
    if name == "trim ramps":
        return np.interp(t, np.cumsum(rng.exponential(4.0, 30)), np.cumsum(rng.normal(0.0, 1.0, 30)))
    if name == "turbulence corrections":
        return coloured(rng, t, rng.uniform(0.3, 3.0))
    if name == "an attitude loop":
        u = np.zeros(len(t))
        for start in np.cumsum(rng.uniform(8.0, 15.0, 5)):
            since, rate = np.maximum(t - start, 0.0), 2.0 * np.pi * rng.uniform(0.15, 0.5)
            u += rng.normal() * np.exp(-rng.uniform(0.1, 0.5) * rate * since) * np.sin(rate * since)
        return u
    if name == "climbs":
        u = np.zeros(len(t))
        for start in np.cumsum(rng.uniform(6.0, 12.0, 6)):
            u += rng.normal() * (
                np.tanh((t - start) / 0.5) - np.tanh((t - start - rng.uniform(2.0, 6.0)) / 0.5)
            )
        return u
    return slewed(t, slewed(t, coloured(rng, t, 1.0), 0.5), 0.3)


@pytest.mark.parametrize(
    "name",
    ["trim changes", "trim ramps", "turbulence corrections", "an attitude loop", "climbs", "wandering"],
)
def test_a_movement_without_a_test_input_is_told_too_and_seldom_called_a_3211(name):
    called = 0
    for seed in range(5):
        rng = np.random.default_rng(seed)
        t = stamps(rng, 45.0, rng.uniform(10.0, 60.0), jitter=0.2)
        spans = found(Stream(t, DEG * rng.uniform(0.5, 4.0) * quiet_flight(name, rng, t)))
        assert spans
        called += sum("3-2-1-1" in span.kind for span in spans)
    assert called <= 1


def test_an_elevator_that_never_rests_is_told_piece_by_piece():
    rng = np.random.default_rng(2)
    t = np.arange(0.0, 150.0, 0.02)
    spans = found(Stream(t, DEG * np.sin(2.0 * np.pi * 0.4 * t) + 0.3 * DEG * coloured(rng, t, 0.3)))
    assert spans[0].closed_by == "no rest"
    assert sum(span.end_s - span.start_s for span in spans) > 0.8 * t[-1]
    assert all(a.last_step_s <= b.start_s + 0.1 for a, b in pairwise(spans))


def test_an_elevator_that_keeps_still_has_not_moved():
    t = np.arange(0.0, 60.0, 0.02)
    assert found(Stream(t, 0.02 * DEG * np.random.default_rng(1).standard_normal(len(t)))) == []


def flown_at(onsets_s, duration_s, unit_s=0.4):
    t = np.arange(0.0, duration_s, 0.02)
    return Stream(t, DEG * sum(steps(t, onset, unit_s, PATTERNS["3-2-1-1"]) for onset in onsets_s))


def test_the_free_response_is_as_long_as_the_input_but_at_least_three_seconds():
    (short,) = found(flown_at([5.0], 20.0, unit_s=0.2))
    (long,) = found(flown_at([5.0], 30.0, unit_s=0.8))
    assert short.end_s - short.last_step_s == pytest.approx(3.0, abs=0.1)
    assert long.end_s - long.last_step_s == pytest.approx(5.6, abs=0.1)
    assert short.closed_by == long.closed_by == "quiet"


def test_the_next_input_ends_a_free_response():
    first, second = found(flown_at([5.0, 9.5], 20.0))
    assert first.closed_by == "next input"
    assert first.end_s == pytest.approx(9.48, abs=0.03)
    assert second.start_s == pytest.approx(9.48, abs=0.03)


def test_a_mode_change_ends_a_free_response():
    stream, segmenter = flown_at([5.0], 20.0), Segmenter()
    spans = []
    for t, u in zip(stream.t.tolist(), stream.u.tolist(), strict=True):
        if abs(t - 9.0) < 0.005:
            spans += segmenter.mode_changed(t)
        spans += segmenter.push(t, u)
    (span,) = spans
    assert span.closed_by == "mode change"
    assert span.end_s == pytest.approx(9.0, abs=0.03)


def test_the_end_of_the_log_and_a_gap_close_what_is_complete():
    whole = flown_at([5.0], 20.0)
    cut = whole.t < 9.0
    (ended,) = found(Stream(whole.t[cut], whole.u[cut]))
    gap = (whole.t < 9.0) | (whole.t > 14.0)
    (gapped,) = found(Stream(whole.t[gap], whole.u[gap]))
    assert ended.closed_by == "end of log"
    assert gapped.closed_by == "gap"
    assert ended.end_s == gapped.end_s == pytest.approx(8.98, abs=0.03)


@pytest.mark.parametrize("silent_s", [0.6, 1.1, 1.6])
def test_an_input_in_which_the_link_was_silent_is_still_recognised(silent_s):
    whole = flown_at([5.0], 20.0)
    heard = (whole.t < 4.99) | (whole.t > 4.99 + silent_s)
    (span,) = found(Stream(whole.t[heard], whole.u[heard]))
    assert span.record_from_s < 5.0 < span.start_s + silent_s
    assert span.last_step_s == pytest.approx(7.8, abs=0.05)


def test_what_the_autopilot_does_after_the_last_step_is_no_free_response():
    stream, segmenter = flown_at([5.0], 20.0), Segmenter()
    corrections = DEG * 0.1 * coloured(np.random.default_rng(4), stream.t, 0.3)
    spans = []
    for t, u, more in zip(stream.t.tolist(), stream.u.tolist(), corrections.tolist(), strict=True):
        if abs(t - 8.2) < 0.005:
            spans += segmenter.mode_changed(8.0)
        spans += segmenter.push(t, u + (more if t > 8.0 else 0.0))
    span = spans[0]
    assert span.closed_by == "mode change"
    assert span.end_s == pytest.approx(8.0, abs=0.03)


def test_an_input_under_way_is_seen_while_it_is_flown():
    stream, segmenter = flown_at([5.0], 20.0), Segmenter()
    seen = {}
    for t, u in zip(stream.t.tolist(), stream.u.tolist(), strict=True):
        segmenter.push(t, u)
        seen[round(t, 2)] = segmenter.onset_s
    assert seen[4.9] is None
    assert seen[6.0] == pytest.approx(5.0, abs=0.05)
    assert seen[9.0] == pytest.approx(5.0, abs=0.05)
    assert seen[15.0] is None


def test_an_hour_of_stream_needs_no_more_memory_than_a_minute():
    segmenter = Segmenter()
    for i in range(15_000):
        segmenter.push(i * 0.24, 0.0)
    assert segmenter._samples.capacity <= 8192


def test_an_input_that_follows_a_slow_climb_without_a_rest_is_separate_from_the_climb():
    rng = np.random.default_rng(2)
    t = np.arange(0.0, 30.0, 0.02)
    hands = 0.1 * DEG * coloured(rng, t, 0.5) - 1.2 * DEG * np.clip((t - 5.0) / 4.0, 0.0, 1.0)
    flown = Stream(t, hands + 1.5 * DEG * steps(t, 15.0, 0.4, PATTERNS["3-2-1-1"]))
    climb, test = found(flown)
    assert climb.closed_by == "no rest"
    assert test.kind == "3-2-1-1"
    assert test.start_s == pytest.approx(15.0, abs=0.1)


def test_the_onset_of_an_input_in_a_slow_movement_is_known_within_its_first_step():
    t = np.arange(0.0, 16.0, 0.02)
    slow = -1.2 * DEG * np.clip((t - 5.0) / 12.0, 0.0, 1.0)
    u = slow + 1.5 * DEG * steps(t, 15.0, 0.4, PATTERNS["3-2-1-1"])
    segmenter = Segmenter()
    for at_s, moved in zip(t[t < 15.3].tolist(), u.tolist(), strict=False):
        segmenter.push(at_s, moved)
    assert segmenter.onset_s == pytest.approx(15.0, abs=0.1)


@pytest.mark.parametrize("seed", [66, 196, 279, 306, 349])
def test_a_3211_that_restless_hands_precede_is_not_parted_after_its_first_level(seed):
    rng = np.random.default_rng(seed)
    t = stamps(rng, 22.0, 50.0, jitter=0.3)
    hands = (0.35 * coloured(rng, t, 1.5) - 0.8 * (t < rng.uniform(13.7, 14.3))) * ((t > 4.0) & (t < 15.0))
    test = found(Stream(t, DEG * (hands + 4.5 * steps(t, 15.0, 0.37, PATTERNS["3-2-1-1"]))))[-1]
    assert test.kind == "3-2-1-1"
    assert test.start_s == pytest.approx(15.0, abs=0.5)
