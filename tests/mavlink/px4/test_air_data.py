"""Each air speed of a PX4 log, on hand-made topics."""

import numpy as np
import pytest

from advisor.mavlink.px4.px4_outputs import air

STAMPS = np.arange(0, 1_000_000, 100_000)


def topic(rate: int = 1, **fields: float):
    t = STAMPS[::rate]
    return {"timestamp": t, **{name: np.full(len(t), value) for name, value in fields.items()}}


def speed(**topics) -> tuple[np.ndarray | None, str]:
    """The air speed of the topics, and what is said of it."""
    messages, said = air(
        {name: given if isinstance(given, list) else [given] for name, given in topics.items()}
    )
    found = [np.asarray(one.fields["airspeed"]) for one in messages if "airspeed" in one.fields]
    return (found[0] if found else None), " ".join(said)


def test_without_a_validated_air_speed_the_sensor_counts_as_it_reads() -> None:
    read, said = speed(airspeed=topic(indicated_airspeed_m_s=25.0))
    assert read == pytest.approx(25.0)
    assert said == ""


def test_without_a_validated_air_speed_the_first_sensor_counts_alone() -> None:
    two = [topic(indicated_airspeed_m_s=25.0), topic(indicated_airspeed_m_s=31.0)]
    read, _ = speed(airspeed=two)
    assert read == pytest.approx(25.0)
    assert len(read) == len(STAMPS)


def test_a_validated_air_speed_without_an_indicated_one_scales_no_sensor() -> None:
    slow = topic(5, calibrated_airspeed_m_s=27.0, airspeed_source=1)
    assert speed(airspeed=topic(indicated_airspeed_m_s=25.0), airspeed_validated=slow)[0] == pytest.approx(
        25.0
    )


def test_a_validated_air_speed_scales_the_sensor_by_the_ratio_of_both() -> None:
    slow = topic(5, calibrated_airspeed_m_s=27.0, indicated_airspeed_m_s=30.0, airspeed_source=1)
    assert speed(airspeed=topic(indicated_airspeed_m_s=20.0), airspeed_validated=slow)[0] == pytest.approx(
        18.0
    )


def test_an_estimate_of_nan_stands_in_for_nothing() -> None:
    nothing = topic(calibrated_airspeed_m_s=np.nan, airspeed_source=0)
    read, said = speed(airspeed=topic(indicated_airspeed_m_s=25.0), airspeed_validated=nothing)
    assert read == pytest.approx(25.0)
    assert "calls its sensor invalid" in said
    assert speed(airspeed_validated=nothing)[0] is None


def climb(**topics) -> np.ndarray | None:
    messages, _ = air({name: [given] for name, given in topics.items()})
    found = [np.asarray(one.fields["climb"]) for one in messages if "climb" in one.fields]
    return found[0] if found else None


def test_the_climb_rate_is_that_of_the_position_filter_where_valid() -> None:
    assert climb(vehicle_local_position=topic(z=0.0, vz=-3.0, v_z_valid=1)) == pytest.approx(3.0)
    assert climb(vehicle_local_position=topic(z=0.0, vz=-3.0)) == pytest.approx(3.0)
    assert climb(vehicle_local_position=topic(z=0.0, vz=-3.0, v_z_valid=0)) is None
    both = climb(
        vehicle_local_position=topic(z=0.0, vz=-3.0, v_z_valid=0), vehicle_global_position=topic(vel_d=-2.0)
    )
    assert both == pytest.approx(2.0)
    assert climb(vehicle_global_position=topic(vel_d=-2.0)) == pytest.approx(2.0)


@pytest.mark.parametrize("name", ["wind", "wind_estimate"])
def test_either_topic_of_the_wind_tells_it(name: str) -> None:
    messages, _ = air({name: [topic(windspeed_north=4.0, windspeed_east=-1.0)]})
    (blown,) = [one.fields for one in messages if one.name == "WIND_COV"]
    assert np.asarray(blown["wind_x"]) == pytest.approx(4.0)


@pytest.mark.parametrize(
    "given",
    [{"vehicle_thrust_setpoint": {"xyz[0]": 0.4}}, {"actuator_controls_0": {"control[3]": 0.4}}],
    ids=["thrust", "lever"],
)
def test_either_topic_tells_the_throttle(given: dict[str, dict[str, float]]) -> None:
    messages, _ = air({name: [topic(**fields)] for name, fields in given.items()})
    throttle = next(one.fields["throttle"] for one in messages if "throttle" in one.fields)
    assert np.asarray(throttle) == pytest.approx(40.0)
