"""Which sensor and estimator of a PX4 log flew: instances swapped are read as their twin."""

import numpy as np
import pytest

from advisor.mavlink.px4.ulog import as_flown

T_US = 40_000 * np.arange(100)


STATED = {
    "sensor_selection": ("accel_device_id", "baro_device_id"),
    "sensors_status_imu": ("accel_device_id_primary",),
    "sensors_status_baro": ("device_id_primary",),
}
"""Fields of each topic with the device of a sensor in use."""


def instance(scale, late_us, **fields):
    """Return an instance of a topic with one value a sample."""
    values = np.sin(1e-6 * T_US) + 2.0
    stated = {name: np.full(len(T_US), value) for name, value in fields.items()}
    return {"timestamp": T_US + late_us, "value": scale * values, **stated}


def topics(name, sound, selector="sensor_selection"):
    """Return a log in which instance ``sound`` is right, and the other reads a third."""
    field = "baro_device_id" if name == "vehicle_air_data" else "device_id"
    right, wrong = (
        instance(scale, late_us, **{field: number})
        for scale, late_us, number in ((1.0, 10_000, 77), (0.3, 20_000, 88))
    )
    numbers = np.full(len(T_US), float(sound))
    return {
        name: [right, wrong] if sound == 0 else [wrong, right],
        "estimator_selector_status": [{"timestamp": T_US, "primary_instance": numbers}],
        selector: [{"timestamp": T_US[:1], **{stated: np.array([77]) for stated in STATED[selector]}}],
    }


@pytest.mark.parametrize(
    ("name", "read_as"),
    [
        ("vehicle_attitude", "vehicle_attitude"), ("vehicle_local_position", "vehicle_local_position"),
        ("wind", "wind"), ("estimator_attitude", "vehicle_attitude"),
        ("estimator_local_position", "vehicle_local_position"),
        ("estimator_global_position", "vehicle_global_position"), ("estimator_wind", "wind"),
        ("sensor_accel", "sensor_accel"),
    ],
)  # fmt: skip
def test_a_log_with_two_instances_swapped_is_read_as_its_twin(name, read_as):
    first, swapped = (as_flown(topics(name, sound))[0][read_as][0] for sound in (0, 1))
    assert first["value"].tolist() == swapped["value"].tolist() == instance(1.0, 0)["value"].tolist()
    assert first["timestamp"].tolist() == swapped["timestamp"].tolist()


@pytest.mark.parametrize(
    ("name", "selector"),
    [
        ("sensor_accel", "sensors_status_imu"),
        ("vehicle_air_data", "sensor_selection"), ("vehicle_air_data", "sensors_status_baro"),
    ],
)  # fmt: skip
def test_the_device_that_a_topic_names_flew(name, selector):
    for sound in (0, 1):
        flown, said = as_flown(topics(name, sound, selector))
        assert flown[name][0]["value"].tolist() == instance(1.0, 0)["value"].tolist()
        assert any("instance 1 flew" in text and "Estimator" not in text for text in said) == bool(sound)


def test_a_change_of_the_estimator_is_said_with_its_time_and_read_from_then_on():
    flown = topics("vehicle_attitude", 0)
    flown["estimator_selector_status"][0]["primary_instance"][50:] = 1.0
    flown.pop("sensor_selection")
    chosen, said = as_flown(flown)
    assert said == ["Estimator: instance 0 flew", "Estimator: instance 1 flew since 0:02.0"]
    values = chosen["vehicle_attitude"][0]["value"]
    assert values[:50].max() > 1.0
    assert values[52:].max() < 1.0


def test_nothing_is_said_where_the_first_instance_flew_throughout():
    assert as_flown(topics("vehicle_attitude", 0))[1] == []
    assert as_flown({})[1] == []
