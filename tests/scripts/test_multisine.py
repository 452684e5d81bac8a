from itertools import combinations

import numpy as np
import pytest

from advisor.scripts.inputs import disjoint_harmonics, multisine

BANDS = [(5, 43), (4, 30), (2, 22), (3, 60)]
RANDOM_PHASES = 1.45
"""Relative peak factor of seven sines of equal power with random phases, on average (Morelli 2012: 1.4 to
1.5); a single sine has 1."""


@pytest.mark.parametrize(("lowest", "highest"), BANDS)
def test_no_harmonic_is_on_two_controls(lowest: int, highest: int) -> None:
    lines = disjoint_harmonics(lowest, highest, 3)
    assert len({n for mine in lines for n in mine}) == sum(map(len, lines))


@pytest.mark.parametrize(("lowest", "highest"), BANDS)
def test_every_control_has_five_to_seven_harmonics_within_the_band(lowest: int, highest: int) -> None:
    for mine in disjoint_harmonics(lowest, highest, 3):
        assert 5 <= len(mine) <= 7
        assert lowest <= mine[0]
        assert mine[-1] <= 1.15 * highest


def test_a_band_of_five_harmonics_is_refused_for_three_controls() -> None:
    with pytest.raises(ValueError, match="too few"):
        disjoint_harmonics(2, 3, 3)


def test_the_inputs_of_two_controls_are_uncorrelated() -> None:
    share = np.arange(2000) / 2000
    inputs = [multisine(mine).values(share) for mine in disjoint_harmonics(5, 43, 3)]
    for a, b in combinations(inputs, 2):
        assert abs(a @ b) < 1e-9 * (a @ a)


@pytest.mark.parametrize("harmonics", [(5, 11, 17, 23, 29, 35), (4, 7, 10, 13, 16, 19, 22), (2, 3)])
def test_a_multisine_begins_and_ends_at_zero(harmonics: tuple[int, ...]) -> None:
    assert multisine(harmonics).values(np.array([0.0, 1.0])) == pytest.approx([0.0, 0.0], abs=1e-9)


def test_the_peak_of_a_multisine_is_one() -> None:
    y = multisine((4, 7, 10, 13, 16, 19, 22)).values(np.linspace(0.0, 1.0, 5001))
    assert np.max(np.abs(y)) == pytest.approx(1.0, abs=0.02)


@pytest.mark.parametrize(("lowest", "highest"), BANDS)
def test_the_peaks_are_lower_than_those_of_random_phases(lowest: int, highest: int) -> None:
    for mine in disjoint_harmonics(lowest, highest, 3):
        y = multisine(mine).values(np.linspace(0.0, 1.0, 16 * highest, endpoint=False))
        assert np.ptp(y) / (2.0 * np.sqrt(2.0 * np.mean(y**2))) < 0.9 * RANDOM_PHASES


def test_two_computations_give_one_multisine() -> None:
    assert multisine((5, 11, 17, 23)) == multisine((5, 11, 17, 23))


@pytest.mark.parametrize(("lowest", "highest"), BANDS)
def test_the_integral_of_a_multisine_swings_about_its_start(lowest: int, highest: int) -> None:
    share = np.arange(20_000) / 20_000
    for mine in disjoint_harmonics(lowest, highest, 3):
        integral = np.cumsum(multisine(mine).values(share))
        assert abs(np.mean(integral)) < 0.2 * np.ptp(integral)
