"""Vibration of a log: lines and clipped samples, from samples of known spectrum."""

from pathlib import Path

import numpy as np
import pytest

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.analysis.vibration import Vibration, spectrum, vibration_of
from advisor.mavlink.logs.raw_fields import read_raw
from tests.flights import SHIPPED
from tests.mavlink.ardupilot.test_autopilot_logs import dataflash_flight
from tests.mavlink.dataflash_writer import rewritten

CASES = Path(__file__).parents[1] / "cases"

RATE_HZ = 50.0
T = np.arange(0.0, 240.0, 1.0 / RATE_HZ)


def measured(samples: np.ndarray):
    found = spectrum("IMU accelerometer", T, samples)
    assert found is not None
    return found


def noise(seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).normal(0.0, 0.2, (3, len(T)))


def test_a_line_in_the_band_is_found_at_its_frequency():
    samples = noise()
    samples[2] += 0.3 * np.sin(2.0 * np.pi * 1.7 * T)
    assert measured(samples).line_hz(4.0) == pytest.approx(1.7, abs=0.05)


def test_a_line_above_the_band_is_not_in_it():
    samples = noise()
    samples[2] += 0.3 * np.sin(2.0 * np.pi * 12.0 * T)
    assert measured(samples).line_hz(4.0) is None


@pytest.mark.parametrize("seed", range(5))
def test_noise_and_a_response_to_gusts_have_no_line(seed: int):
    # A short period of 0.8 Hz with a damping ratio of 0.4, driven by white noise.
    white = noise(seed)
    f = np.fft.rfftfreq(len(T), 1.0 / RATE_HZ) / 0.8
    samples = np.fft.irfft(np.fft.rfft(white) / (1.0 - f**2 + 0.8j * f), len(T))
    assert measured(white).line_hz(4.0) is None
    assert measured(samples).line_hz(4.0) is None


def test_counts_that_grow_are_told_and_counts_at_rest_are_not():
    assert list(Vibration((), {"VIBE.Clip0": 0}).notes(0.3)) == []
    (said,) = Vibration((), {"VIBE.Clip0": 7}).notes(None)
    assert "VIBE.Clip0 by 7 samples" in said


def test_three_logs_of_one_flight_give_equal_accelerations_and_clocks():
    kinds = {"base.bin": ("IMU", "AccZ", 1.0), "t_base.tlog": ("RAW_IMU", "zacc", 1e-3 * GRAVITY_M_S2)}
    kinds["u_base.ulg"] = ("HIGHRES_IMU", "zacc", 1.0)
    means = []
    for log, (message, field, factor) in kinds.items():
        table = read_raw(CASES / log, [message])[message]
        assert (table.t[0], table.t[-1]) == (pytest.approx(79.0, abs=0.05), pytest.approx(89.0, abs=0.05))
        means.append(factor * float(np.mean(table.fields[field])))
    assert means == pytest.approx([means[0]] * 3, abs=0.02)


def test_a_flight_shows_half_of_its_logs_rate_and_its_manoeuvres_are_no_line():
    for found in vibration_of(SHIPPED / "arduplane-calm.tlog").spectra:
        assert found.frequency_hz[-1] == pytest.approx(25.0, abs=0.1)
        assert found.line_hz(4.0) is None


def test_a_growing_count_of_the_log_is_told_with_its_growth(tmp_path: Path):
    log = tmp_path / "clipped.bin"
    added = {"VIBE": ("QI", "TimeUS,Clip0", lambda t: {"Clip0": 3 + 4 * (t > 15.0)})}
    log.write_bytes(rewritten(dataflash_flight(30.0), add=added))
    assert vibration_of(log).clipped == {"VIBE.Clip0": 4}
