import numpy as np
import pytest
from scipy.signal import cont2discrete

from advisor.model.short_period import ShortPeriod
from advisor.oem.lost_input import restored
from advisor.oem.problem import OutputErrorProblem, Record
from advisor.oem.rows import Signal
from advisor.oem.solution import Solution, solve

TRUE = ShortPeriod.from_mapping(
    {"Z_alpha": -4.0, "Z_delta_e": -0.3, "M_alpha": -40.0, "M_q": -4.0, "M_delta_e": -45.0}
)
NOISE = 5e-4
STEP_S = 0.02


def flown(seed: int = 0) -> Record:
    """Return a 3-2-1-1 at 50 Hz, linear between its samples, integrated by scipy."""
    t = np.arange(0.0, 6.0, STEP_S)
    command = np.zeros_like(t)
    for begin, end, level in ((1.0, 1.9, -1.0), (1.9, 2.5, 1.0), (2.5, 2.8, -1.0), (2.8, 3.1, 1.0)):
        command[(t > begin - 1e-9) & (t < end - 1e-9)] = np.radians(4.0) * level
    system = (TRUE.a, TRUE.b[:, None], np.eye(2), np.zeros((2, 1)))
    a, b, c, d, _ = cont2discrete(system, STEP_S, "foh")
    state, outputs = np.zeros(2), np.empty((len(t), 2))
    for i, u in enumerate(command):
        outputs[i] = c @ state + d[:, 0] * u
        state = a @ state + b[:, 0] * u
    outputs += np.random.default_rng(seed).normal(0.0, NOISE, outputs.shape)
    measured = {name: Signal(t, outputs[:, k]) for k, name in enumerate(("alpha", "q"))}
    return Record(elevator=Signal(t, command), outputs=measured)


def without(record: Record, lost: list[int]) -> Record:
    keep = np.setdiff1d(np.arange(len(record.elevator.t)), lost)
    elevator = Signal(record.elevator.t[keep], record.elevator.y[keep])
    return Record(elevator=elevator, outputs=record.outputs)


def solved(problem: OutputErrorProblem) -> Solution:
    solution = solve(problem)
    assert isinstance(solution, Solution)
    return solution


def test_samples_lost_at_steps_are_found_again_and_the_fit_is_as_good_as_with_them() -> None:
    whole = flown()
    corner = round(1.9 / STEP_S)
    other = round(2.5 / STEP_S)
    lossy = OutputErrorProblem((without(whole, [corner, other - 1, other]),))
    complete = solved(OutputErrorProblem((whole,)))
    spoiled = solved(lossy)
    mended = solved(restored(lossy))
    assert spoiled.cost > 5.0 * complete.cost
    assert mended.cost == pytest.approx(complete.cost, rel=0.1)
    elevator = restored(lossy).records[0].elevator
    assert np.allclose(elevator.t, whole.elevator.t)
    assert np.max(np.abs(elevator.y - whole.elevator.y)) < np.radians(0.3)
    assert np.all(np.abs(mended.theta - complete.theta) < 2.0 * np.sqrt(np.diag(complete.covariance_cr)[:8]))


def test_a_record_that_lost_nothing_or_lost_it_where_the_stick_was_still_is_untouched() -> None:
    whole = flown()
    for record in (whole, without(whole, [20, 120, 250])):
        (same,) = restored(OutputErrorProblem((record,))).records
        assert same is record


def test_an_outage_is_no_lost_sample() -> None:
    whole = flown()
    record = without(whole, list(range(90, 105)))
    assert restored(OutputErrorProblem((record,))).records[0] is record


@pytest.mark.parametrize("seed", range(3))
def test_every_fifth_packet_lost_at_random_hardly_widens_the_scatter(seed: int) -> None:
    whole = flown(seed)
    dice = np.random.default_rng(seed)
    lost = np.flatnonzero(dice.random(len(whole.elevator.t)) < 0.2).tolist()
    mended = solved(restored(OutputErrorProblem((without(whole, lost),))))
    errors = (mended.theta - TRUE.theta) / np.sqrt(np.diag(mended.covariance_cr)[:8])
    assert np.max(np.abs(errors)) < 4.5
    assert mended.cost < 1.6 * solved(OutputErrorProblem((whole,))).cost
