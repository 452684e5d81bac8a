"""Each fault of a scenario, as the written log shows it."""

from collections import defaultdict
from functools import cache
from importlib.resources import files
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sim.faulty import standard_air
from sim.flight import Flight
from sim.loading import ScenarioError
from sim.record import write_tlog
from sim.scenario import Clock, read_scenario, scenario_from
from sim.tlog import read_tlog

ONE = {
    "maneuvers": ["3211"], "noise": {"percent": 0.0}, "lead_in_s": 2.0, "settling_s": 1.0, "free_s": 2.0,
    "closing_s": 1.0,
}  # fmt: skip
EXAMPLE = Path(str(files("sim") / "scenarios" / "faulty-instruments.yaml"))


def written(**faults):
    out = BytesIO()
    write_tlog(Flight(scenario_from(ONE | ({"faults": faults} if faults else {}))), out)
    return out.getvalue()


@cache
def sound():
    return written()


@pytest.fixture(scope="module")
def shown(tmp_path_factory):
    """Messages by name as pymavlink decodes them from the log of a flight; one log is decoded once."""
    path = tmp_path_factory.mktemp("shown") / "flight.tlog"

    @cache
    def decoded(data):
        path.write_bytes(data)
        found = defaultdict(list)
        names = {kind.msgname for kind in mavlink.mavlink_map.values()}
        for host_s, message in read_tlog(path, names):
            found[message.get_type()].append((host_s, message))
        return found

    return lambda data: defaultdict(list, decoded(data))


def column(log, name, field):
    return np.array([getattr(message, field) for _, message in log[name]], dtype=float)


def test_faults_that_change_nothing_change_no_byte():
    neutral = {"units": {}, "scale": {}, "filters": {"parameters": "withheld"}, "clock_lag_s": {}}
    zeros = {"command_late_s": 0, "thin_air_m": 0, "repeated_after_s": 0, "parameters_at_s": 0}
    assert written(**neutral, **zeros) == sound()


@pytest.mark.parametrize(
    ("fault", "name", "field", "factor"),
    [
        ({"scale": {"alpha": -1.0}}, "AOA_SSA", "AOA", -1.0),
        ({"scale": {"q": -1.0}}, "ATTITUDE", "pitchspeed", -1.0),
        ({"scale": {"a_z": -1.0}}, "RAW_IMU", "zacc", -1.0),
        ({"scale": {"airspeed": 1.05}}, "VFR_HUD", "airspeed", 1.05),
        ({"units": {"alpha": "rad"}}, "AOA_SSA", "AOA", np.pi / 180.0),
        ({"units": {"theta": "deg"}}, "ATTITUDE", "pitch", 180.0 / np.pi),
        ({"units": {"accelerometer": "counts"}}, "RAW_IMU", "zacc", 2.048),
        ({"units": {"airspeed": "knots"}}, "VFR_HUD", "airspeed", 1.943844),
        ({"units": {"alpha": "rad"}, "scale": {"alpha": -1.0}}, "AOA_SSA", "AOA", -np.pi / 180.0),
    ],
)
def test_a_sign_or_unit_changes_its_own_field_and_no_other(shown, fault, name, field, factor):
    right, wrong = shown(sound()), shown(written(**fault))
    # RAW_IMU has whole numbers: the true value is rounded before the factor, the product after it.
    whole = 0.5 if name == "RAW_IMU" else 0.0
    np.testing.assert_allclose(
        column(wrong, name, field), factor * column(right, name, field), rtol=1e-5, atol=whole
    )
    others = [f for f in right[name][0][1].fieldnames if f != field and not f.endswith("acc")]
    assert all((column(right, name, f) == column(wrong, name, f)).all() for f in others)


def test_an_accelerometer_in_g_reads_one_g_in_steady_flight(shown):
    log = shown(written(units={"accelerometer": "g"}))
    assert not log["RAW_IMU"]
    assert column(log, "HIGHRES_IMU", "zacc")[:100] == pytest.approx(-1.0, abs=0.01)
    np.testing.assert_allclose(
        column(log, "HIGHRES_IMU", "zacc"), 1e-3 * column(shown(sound()), "RAW_IMU", "zacc"), rtol=1e-6
    )


def late_by(t, signal, reference):
    """Return the delay of a signal relative to its reference, s, of the best correlation."""
    delays = np.arange(-0.05, 0.05, 0.0005)
    inner = (t > t[0] + 1.0) & (t < t[-1] - 1.0)
    misfit = [np.sum((np.interp(t[inner] - d, t, reference) - signal[inner]) ** 2) for d in delays]
    return delays[int(np.argmin(misfit))]


@pytest.mark.parametrize(
    ("filtered", "name", "field"),
    [("gyro_hz", "ATTITUDE", "pitchspeed"), ("accelerometer_hz", "RAW_IMU", "zacc")],
)
@pytest.mark.parametrize("cutoff_hz", [10.0, 20.0])
def test_a_filter_delays_its_instrument_by_the_root_of_two_over_its_angular_frequency(
    shown, filtered, name, field, cutoff_hz
):
    right, late = shown(sound()), shown(written(filters={filtered: cutoff_hz}))
    t = 0.02 * np.arange(len(right[name]))
    found = late_by(t, column(late, name, field), column(right, name, field))
    assert found == pytest.approx(np.sqrt(2.0) / (2.0 * np.pi * cutoff_hz), abs=0.0015)
    other = ("RAW_IMU", "zacc") if name == "ATTITUDE" else ("ATTITUDE", "pitchspeed")
    assert (column(right, *other) == column(late, *other)).all()


def test_the_parameters_state_the_filters_unless_they_are_withheld(shown):
    def named(**filters):
        log = shown(written(filters=filters))
        values = {message.param_id: message.param_value for _, message in log["PARAM_VALUE"]}
        return {name: value for name, value in values.items() if name.startswith("INS_")}

    both = {"gyro_hz": 20.0, "accelerometer_hz": 15.0}
    assert named(**both) == {"INS_GYRO_FILTER": 20.0, "INS_ACCEL_FILTER": 15.0}
    assert named(gyro_hz=20.0) == {"INS_GYRO_FILTER": 20.0}
    assert named(**both, parameters="withheld") == {}


@pytest.mark.parametrize("late_s", [-0.01, 0.01])
def test_a_late_command_is_stamped_before_it_acts(shown, late_s):
    right, wrong = shown(sound()), shown(written(command_late_s=late_s))
    apart = column(wrong, "SERVO_OUTPUT_RAW", "time_usec") - column(right, "SERVO_OUTPUT_RAW", "time_usec")
    assert set(apart) == {-1e6 * late_s}
    pulses = (column(log, "SERVO_OUTPUT_RAW", "servo2_raw") for log in (right, wrong))
    assert np.array_equal(*pulses)


def test_in_thin_air_the_hud_shows_indicated_air_speed_and_the_pressure_gives_the_true_one(shown):
    right, thin = shown(sound()), shown(written(thin_air_m=3000.0))
    ratio = column(thin, "VFR_HUD", "airspeed") / column(right, "VFR_HUD", "airspeed")
    # Density at 3,150 m is 0.7312 of that at sea level (ICAO standard atmosphere).
    assert ratio == pytest.approx(np.sqrt(0.7312), abs=0.002)
    pressure = column(thin, "SCALED_PRESSURE", "press_abs") / 1013.25
    kelvin = column(thin, "SCALED_PRESSURE", "temperature") / 100.0 + 273.15
    assert np.sqrt(pressure / kelvin * 288.15) == pytest.approx(ratio[0], abs=0.002)
    indicated = np.sqrt(200.0 * column(thin, "SCALED_PRESSURE", "press_diff") / 1.225)
    assert indicated[5:] == pytest.approx(column(thin, "VFR_HUD", "airspeed")[0], rel=0.1)
    assert column(thin, "GLOBAL_POSITION_INT", "alt")[0] == pytest.approx(3_150_000.0, abs=100.0)
    assert not right["SCALED_PRESSURE"]


def test_the_standard_atmosphere_has_its_published_values():
    pressure, kelvin, density = standard_air(3000.0)
    assert (pressure, kelvin, density) == pytest.approx((701.1, 268.65, 0.7423), rel=1e-3)


def test_a_repeated_stream_brings_every_message_again_with_a_later_stamp(shown):
    once, twice = shown(sound()), shown(written(repeated_after_s=0.01))
    assert {n: len(m) for n, m in twice.items()} == {n: 2 * len(m) for n, m in once.items()}
    q = column(twice, "ATTITUDE", "pitchspeed")
    assert (q[0::2] == q[1::2]).all()
    for name, field, tick in (("ATTITUDE", "time_boot_ms", 10), ("AOA_SSA", "time_usec", 10_000)):
        stamps = column(twice, name, field)
        assert set(stamps[1::2] - stamps[0::2]) == {tick}
    assert (np.diff([host_s for host_s, _ in twice["ATTITUDE"]]) > 0.0).all()


@pytest.mark.parametrize(("at_s", "seen"), [(4.0, True), (float("inf"), False)])
def test_parameters_come_at_their_time_or_never(shown, at_s, seen):
    log = shown(written(parameters_at_s=at_s))
    begins = Clock().unix_s
    assert bool(log["PARAM_VALUE"]) is seen
    assert all(at_s <= host_s - begins < at_s + 1.0 for host_s, _ in log["PARAM_VALUE"])


def test_a_lagging_clock_stamps_its_message_early_and_no_other(shown):
    right, wrong = shown(sound()), shown(written(clock_lag_s={"AOA_SSA": 0.05}))
    assert set(column(right, "AOA_SSA", "time_usec") - column(wrong, "AOA_SSA", "time_usec")) == {50_000.0}
    assert (column(right, "ATTITUDE", "time_boot_ms") == column(wrong, "ATTITUDE", "time_boot_ms")).all()


def test_every_mistake_in_the_faults_is_listed_with_its_path():
    with pytest.raises(ScenarioError) as caught:
        scenario_from(
            {
                "faults": {
                    "units": {"alpha": "grad", "beta": "rad"},
                    "scale": {"rpm": 2.0},
                    "clock_lag_s": {"VFR_HUD": 0.1},
                    "repeated_after_s": 0.02,
                    "thin_air_m": 12_000,
                    "filters": {"gyro_hz": -1},
                }
            }
        )
    assert caught.value.problems == [
        "faults.units.alpha: 'grad' is not among the wrong units of this channel: rad",
        "faults.units.beta: 'rad' is not among the wrong units of this channel: none",
        "faults.scale.rpm: unknown channel, choose from alpha, q, theta, a_z, accelerometer, airspeed",
        "faults.clock_lag_s.VFR_HUD: carries no stamp, choose from ATTITUDE, AOA_SSA, SERVO_OUTPUT_RAW, "
        "RAW_IMU, GLOBAL_POSITION_INT, SYSTEM_TIME, RC_CHANNELS",
        "faults.repeated_after_s: must be at least 0 and below one period of loop_hz",
        "faults.thin_air_m: must be at least 0 and below 11000",
        "faults.filters: a cut-off must be at least 0 Hz",
    ]


def test_the_example_has_every_fault():
    faults = read_scenario(EXAMPLE).faults
    assert all(bool(getattr(faults, name)) for name in faults.__dataclass_fields__)
