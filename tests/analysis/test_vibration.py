"""Vibration of a log: lines, spread and clipped samples, from samples of known spectrum."""

from pathlib import Path

import numpy as np
import pytest

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.analysis.vibration import Vibration, field_sums, spectrum, vibration_of
from advisor.mavlink.logs.raw_fields import read_raw
from advisor.words.problems import ConfigurationError
from tests.conftest import Advisor
from tests.flights import SHIPPED
from tests.mavlink.ardupilot.test_autopilot_logs import dataflash_flight
from tests.mavlink.dataflash_writer import rewritten

CASES = Path(__file__).parents[1] / "cases"

RATE_HZ = 50.0
T = np.arange(0.0, 240.0, 1.0 / RATE_HZ)


def measured(samples: np.ndarray):
    found = spectrum("IMU accelerometer", "m/s²", T, samples)
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


def test_the_rms_of_white_noise_and_the_highest_frequency_are_those_of_the_samples():
    found = measured(noise())
    assert found.highest_hz == pytest.approx(25.0, rel=1e-3)
    assert found.rms == pytest.approx(np.full(3, 0.2), rel=0.1)


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
        assert found.highest_hz == pytest.approx(25.0, abs=0.1)
        assert found.line_hz(4.0) is None


def test_a_growing_count_of_the_log_is_told_with_its_growth(tmp_path: Path):
    log = tmp_path / "clipped.bin"
    added = {"VIBE": ("QI", "TimeUS,Clip0", lambda t: {"Clip0": 3 + 4 * (t > 15.0)})}
    log.write_bytes(rewritten(dataflash_flight(30.0), add=added))
    assert vibration_of(log).clipped == {"VIBE.Clip0": 4}


LOG = Path(__file__).parents[1] / "cases" / "base.bin"


def test_a_field_has_the_values_and_stamps_of_the_log():
    (roll,) = field_sums(LOG, ["ATT.Roll"])
    table = read_raw(LOG, ["ATT"])["ATT"]
    assert np.array_equal(roll.t, table.t)
    assert np.array_equal(roll.y, table.fields["Roll"])


def test_a_plus_sums_fields_also_of_two_messages_at_the_first_ones_stamps():
    outputs, mixed = field_sums(LOG, ["RCOU.C1+RCOU.C3", "ATT.Pitch+RCOU.C2"])
    table = read_raw(LOG, ["RCOU"])["RCOU"]
    assert np.array_equal(outputs.y, table.fields["C1"] + table.fields["C3"])
    pitch = read_raw(LOG, ["ATT"])["ATT"]
    moved = np.interp(pitch.t, table.t, table.fields["C2"])
    inside = np.isfinite(mixed.y)
    assert inside.mean() > 0.9
    assert mixed.y[inside] == pytest.approx((pitch.fields["Pitch"] + moved)[inside])


def test_an_unknown_field_is_refused_by_name_with_the_nearest_names():
    with pytest.raises(ConfigurationError, match=r"--field ATT\.Rol: base\.bin .*nearest: ATT\.Roll"):
        field_sums(LOG, ["ATT.Rol"])


def test_the_command_refuses_an_unknown_field_with_exit_code_2(advisor: Advisor, tmp_path: Path):
    result = advisor("report", LOG, "--field", "ATT.Rol", "-o", tmp_path / "page.html")
    assert result.returncode == 2
    assert "ATT.Roll" in result.stderr
    assert not (tmp_path / "page.html").exists()
