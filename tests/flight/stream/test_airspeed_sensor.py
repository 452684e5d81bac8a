"""An air speed that no sensor measured is named, by parameters or by equality with the ground speed."""

import pytest

from advisor.flight.maneuvers.maneuver import Maneuver
from tests.flight.columns import Wire, fly, parameter
from tests.heard import hear


def flown(without_wind: bool = False, **parameters: float) -> Maneuver:
    """A manoeuvre of a vehicle with these parameters."""
    wire = Wire()
    for name, value in parameters.items():
        parameter(wire, 999.0, name, value)
    fly(wire, 1000.0, 50.0, [4.0], 16.0)
    columns = wire.columns()
    for c in columns:
        if c.name == "VFR_HUD":
            speed = 20.0 + 0.1 * (c.order % 7)
            c.fields["airspeed"][:] = speed  # type: ignore[index]
            c.fields["groundspeed"][:] = speed if without_wind else speed + 1.0  # type: ignore[index]
    (maneuver,) = hear([columns]).maneuvers
    return maneuver


def test_a_measured_air_speed_needs_no_note() -> None:
    assert flown(ARSPD_TYPE=1.0, ARSPD_USE=1.0).data_notes == ()


@pytest.mark.parametrize("name", ["ARSPD_TYPE", "ARSPD_USE"])
def test_a_sensor_that_the_parameters_switch_off_is_named(name: str) -> None:
    (note,) = flown(**{name: 0.0}).data_notes
    assert note.startswith(f"{name} is 0: no sensor measures the air speed.")


def test_an_air_speed_that_equals_the_ground_speed_is_named() -> None:
    (note,) = flown(without_wind=True).data_notes
    assert "equal in every sample" in note
